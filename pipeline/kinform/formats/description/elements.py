"""XML as descriptions use it: read safely, with the line of each element, and its numbers checked.

Entities are refused, so that nothing can be expanded and no other file be read through them; nothing is loaded from
a network. A prefix that is nowhere declared is accepted, because descriptions in the wild have such.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lxml import etree

from kinform.form.constants import LARGEST_NUMBER, TEXT_BYTES, VALUE_LENGTH
from kinform.form.problems import Problems
from kinform.formats.description.mesh_files import Found
from kinform.formats.description.robot import At
from kinform.foundation.boundary import Boundary
from kinform.foundation.colours import told
from kinform.foundation.name_hints import in_quotes
from kinform.foundation.xml_root import is_plain

XML_DEPTH = 255
"""Elements in each other that are read: the limit of libxml2 without its option for huge trees is 256. Bodies of MJCF
in a row have one each."""

ELEMENTS_MOST = 200_000
"""Elements of a description, with those of the files that it includes, counted each time that they are: forty for each
of the parts of the largest design that was measured."""
ATTRIBUTES_MOST = 255
"""Attributes of an element: five times what the richest of MJCF has. Chosen, not measured."""


FILE = "{urn:kinform}file"
"""Attribute of elements that come from another file than the root: that file."""

Element = Any
"""An lxml element."""

_BOUNDS = ("lower", "upper", "effort", "velocity", "range", "ctrlrange", "forcerange", "actuatorfrcrange")
"""Attributes in which the largest double there is says that there is no bound."""

_ENTITY = re.compile(rb"<!\s*+(?:ENTITY|DOCTYPE(?:(?!\bSYSTEM\b|\bPUBLIC\b)[^<>\[])*+(?:SYSTEM|PUBLIC)\b)")


def declares_entities(data: bytes, file: str, problems: Problems) -> bool:
    """Whether an XML text declares entities or an external document type, which is noted: they are refused."""
    refused = _ENTITY.search(data)
    if refused is None:
        return False
    line = data.count(b"\n", 0, refused.start()) + 1
    problems.add("declares an entity or an external document type, which is refused", file, line,
                 "write the text in place of the entity, and remove the declaration")  # fmt: skip
    return True


def parse_xml(data: bytes, file: str, problems: Problems) -> Element | None:
    """The root element of an XML text; None after noting what is wrong with it."""
    if declares_entities(data, file, problems):
        return None
    if len(data) > TEXT_BYTES:
        problems.add(f"has {len(data):,} bytes, and {TEXT_BYTES:,} are the most", file, None, "split the description")
        return None
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True,
                             remove_pis=True, huge_tree=False, recover=True)  # fmt: skip
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        root, message = None, str(error)
    else:
        message = "the file is empty"
    faults = [entry for entry in parser.error_log if entry.type_name != "NS_ERR_UNDEFINED_NAMESPACE"]
    if root is None or faults:
        line = max(faults[0].line, 1) if faults else 1
        words = faults[0].message.strip() if faults else message
        if words.startswith("Excessive depth"):
            problems.add(f"has elements nested more than {XML_DEPTH} deep, and no more are read", file, line,
                         "write bodies side by side, from a root in their middle, or as URDF")  # fmt: skip
        else:
            remedy = next((remedy for said, remedy in _SYNTAX if said in words), "correct the syntax there")
            problems.add(f"is not well-formed XML: {words}", file, line, remedy)
        return None
    encoding = root.getroottree().docinfo.encoding
    if not is_plain(encoding):
        problems.add(f"is in the encoding {encoding[:20]}, in which a text is not what it looks like", file, 1,
                     "save it as UTF-8")  # fmt: skip
        return None
    declared = root.getroottree().docinfo.internalDTD
    if declared is not None and any(True for _ in declared.iterentities()):
        problems.add("declares entities, which are refused", file, 1, "write the text in place of the entities")
        return None
    return root if _is_within_bounds(root, file, problems) else None


def _is_within_bounds(root: Element, file: str, problems: Problems) -> bool:
    """Whether elements and attributes are not too many, which is noted: looking at each takes time, and attributes of
    one element take time by the square of their number."""
    for element in root.iter(etree.Element):
        problems.elements += 1
        if problems.elements > ELEMENTS_MOST:
            message = f"has more than {ELEMENTS_MOST:,} elements, with those of the files that it includes"
            problems.add(message, file, None, "split the description")
            return False
        if len(element.attrib) > ATTRIBUTES_MOST:
            what, many = tag_of(element)[:VALUE_LENGTH], f"{len(element.attrib):,}"
            message = f"<{what}> has {many} attributes, and {ATTRIBUTES_MOST} are the most"
            problems.add(message, file, element.sourceline, "remove those that no format has")
            return False
    return True


_SYNTAX = (
    ("encoding", "save it as UTF-8, and let its first line say so, or nothing"),
    ("XML declaration allowed only", "remove what stands before <?xml"),
)
"""What some faults of syntax are mended by."""

_ENCODING = re.compile(r"""\s*<\?xml[^>]*encoding\s*=\s*["']([A-Za-z0-9._-]+)""")


def xml_text(data: bytes) -> str:
    """An XML text as people read it, by the encoding that it declares."""
    declared = _ENCODING.match(data[:256].decode("latin-1"))
    try:
        return data.decode(declared[1] if declared else "utf-8").replace("\0", "")
    except (LookupError, UnicodeDecodeError):
        return data.decode("utf-8", "replace").replace("\0", "")


def xml_bytes(text: str) -> bytes:
    """The bytes of a text that `xml_text` gave."""
    declared = _ENCODING.match(text)
    try:
        return text.encode(declared[1] if declared else "utf-8")
    except (LookupError, UnicodeEncodeError):
        return text.encode("utf-8")


def colour_of(text: str | None) -> str | None:
    """ "#rrggbb" of three or four numbers of sRGB, 0 … 1; None where the text is none: a colour decides nothing."""
    try:
        return told([float(word) for word in (text or "").split()])
    except ValueError:
        return None


def tag_of(element: Element) -> str:
    """The local name of an element."""
    tag = element.tag
    if not isinstance(tag, str):
        return ""
    return re.split("[}:]", tag)[-1] if "}" in tag or ":" in tag else tag


class Xml:
    """Asks elements for their values; what is wrong with them is noted at their line."""

    def __init__(self, file: str, problems: Problems, written: str | None = None):
        self.file, self.problems, self._written = file, problems, written

    def at(self, element: Element) -> At:
        """Where an element stands."""
        if self._written is not None:
            return At(self.file, _line_of(element, self._written))
        above = element
        while above is not None and above.get(FILE) is None:
            above = above.getparent()
        return At(self.file if above is None else above.get(FILE), element.sourceline or 1)

    def complain(self, element: Element, message: str, remedy: str) -> None:
        """Note a problem at an element."""
        at = self.at(element)
        self.problems.add(message, at.file, at.line, remedy)

    def not_found(self, element: Element, what: str, found: Found) -> None:
        """Note why there is no file of the name that an element states: once for all of the file with that cause."""
        at = self.at(element)
        self.problems.add_alike(f"{what} {found.stated}", found.fault, at.file, at.line, found.remedy)

    def content(self, element: Element, path: Path, boundary: Boundary) -> bytes | None:
        """The content of a file that an element names; None after noting why it cannot be read."""
        try:
            return boundary.read(path)
        except OSError as error:
            self.complain(element, f"{path.name} cannot be read: {error.strerror}", "check its permissions")
            return None

    def children(self, element: Element | None, *tags: str) -> Iterator[Element]:
        """The children with one of these local names; of all names where none is given."""
        for child in () if element is None else element:
            if isinstance(child.tag, str) and (not tags or tag_of(child) in tags):
                yield child

    def child(self, element: Element | None, *tags: str) -> Element | None:
        """The first of the children with one of these names."""
        return next(self.children(element, *tags), None)

    def name(self, element: Element, key: str = "name") -> str | None:
        """A name that must be there; "/" becomes "_"."""
        value = str(element.get(key) or "").strip()
        if not value:
            self.complain(element, f"<{tag_of(element)}> has no {key}", f'add {key}="…"')
            return None
        return value.replace("/", "_")

    def numbers(self, element: Element, text: str | None, what: str, count: int | None) -> tuple[float, ...] | None:
        """Finite numbers in a text; None after noting that there are none, or not `count`."""
        words = (text or "").split()
        values: list[float] = []
        for word in words:
            try:
                value = math.nan if "_" in word else float(word)
            except ValueError:
                value = math.nan
            most = math.inf if what in _BOUNDS else LARGEST_NUMBER
            if not (math.isfinite(value) and abs(value) <= most):
                shown = word if len(word) <= VALUE_LENGTH else word[:VALUE_LENGTH] + "…"
                up_to = "" if what in _BOUNDS else f" up to {LARGEST_NUMBER:g}"
                wrong = f"<{tag_of(element)}>: {what} has {in_quotes(shown)}, which is no finite number{up_to}"
                remedy = "it is xacro: name it so (.xacro)" if "${" in shown else "give finite numbers"
                self.complain(element, wrong, remedy)
                return None
            values.append(value)
        if count is not None and len(values) != count:
            self.complain(
                element, f"<{tag_of(element)}>: {what} has {len(values)} numbers and needs {count}",
                f"give {count} numbers with blanks between",
            )  # fmt: skip
            return None
        return tuple(values)

    def vector(
        self, element: Element | None, key: str, default: tuple[float, ...], count: int | None = None
    ) -> tuple[float, ...]:
        """The numbers of an attribute; the default where it is absent or wrong."""
        if element is None or element.get(key) is None:
            return default
        values = self.numbers(element, element.get(key), key, len(default) if count is None else count)
        return default if values is None else values

    def number(self, element: Element | None, key: str, default: float | None = None) -> float | None:
        """One number of an attribute; the default where it is absent or wrong."""
        if element is None or element.get(key) is None:
            return default
        values = self.numbers(element, element.get(key), key, 1)
        return default if values is None else values[0]


def _line_of(element: Element, written: str) -> int:
    """The line on which an element, or the closest around it that has a name there, is written; else the first."""
    here = element
    while here is not None:
        name = here.get("name")
        match = name and re.search(rf"<[^<>]*\bname\s*=\s*[\"']{re.escape(name)}[\"']", written)
        if match:
            return written.count("\n", 0, match.start()) + 1
        here = here.getparent()
    return 1
