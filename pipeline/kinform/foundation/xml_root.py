"""The root element of an XML file, found by parsing no more of it than that takes."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from kinform.frozen import dataclass

HEAD_BYTES = 64 << 10
"""Bytes that are tried first: licences before a root have a few thousand. Chosen, not measured."""
ELEMENTS_MOST = 1000
"""Elements among which those directly in the root are looked for. Chosen, not measured."""


@dataclass(frozen=True)
class Root:
    """The root element, names without prefix and name space."""

    name: str
    attributes: frozenset[str]
    inner: frozenset[str]
    """Names of the elements directly in it, as far as they were looked for."""
    faulty: bool
    """Whether the text is not well-formed as far as it was parsed, so that attributes may be missing."""


class _Enough(Exception):
    """No more has to be parsed."""


class _Target:
    """Takes the elements as the parser meets them; nothing is built."""

    def __init__(self, most: int):
        self.most, self.count, self.depth = most, 0, 0
        self.root: tuple[str, frozenset[str]] | None = None
        self.inner: set[str] = set()

    def start(self, tag: str, attributes: Mapping[str, str]) -> None:
        """An element begins."""
        if self.root is None:
            self.root = _local(tag), frozenset(map(_local, attributes))
        elif self.depth == 1:
            self.inner.add(_local(tag))
        self.depth += 1
        self.count += 1
        if self.count >= self.most:
            raise _Enough

    def end(self, tag: str) -> None:
        """An element ends."""
        self.depth -= 1

    def close(self) -> None:
        """The text ends."""


_PLAIN = re.compile(
    r"utf-?(8|16|32)(le|be)?|(iso-10646-)?ucs-?[24]|(us-)?ascii|iso-?8859-?\d+|latin-?\d+|(windows-|cp)125\d|koi8-[ru]|"
    r"gb(2312|k|18030)|big5|euc-(jp|kr|cn|tw)|shift-?jis|macintosh"
)
"""Encodings in which what stands for a character of ASCII is that character, but within another one. In others (UTF-7,
ISO-2022) what a person takes for a comment may be elements."""


def is_plain(encoding: str | None) -> bool:
    """Whether an XML text in this encoding, as its first line names it, is what it looks like."""
    return encoding is None or _PLAIN.fullmatch(encoding.lower().replace("_", "-")) is not None


def root_of(data: bytes, *, inner: bool = False) -> Root | None:
    """The root of an XML text in any encoding that libxml2 reads, with the elements in it where they are asked for;
    None where there is no element. Entities of elements are not expanded, nothing else is read."""
    return _parsed(data, ELEMENTS_MOST if inner else 2)[0]


def root_of_file(path: Path, most: int, *, inner: bool = False) -> Root | None:
    """As `root_of`, of the first `most` bytes of a file. Raises OSError."""
    with open(path, "rb") as stream:
        head = stream.read(min(HEAD_BYTES, most))
        root, count = _parsed(head, ELEMENTS_MOST if inner else 2)
        if count >= 2 and (not inner or count >= ELEMENTS_MOST):
            return root
        rest = stream.read(most - len(head))
    return root_of(head + rest, inner=inner) if rest else root


def _parsed(data: bytes, most: int) -> tuple[Root | None, int]:
    """The root, and how many elements were met: with more than one that of a cut text is whole."""
    from lxml import etree

    target = _Target(most)
    settings: dict[str, Any] = {"resolve_entities": False, "no_network": True, "load_dtd": False, "huge_tree": False}
    parser = etree.XMLParser(target=target, recover=True, remove_comments=True, remove_pis=True, **settings)
    with contextlib.suppress(_Enough, etree.XMLSyntaxError, ValueError, LookupError):
        etree.fromstring(data, parser)
    faulty = any(entry.type_name != "NS_ERR_UNDEFINED_NAMESPACE" for entry in parser.error_log)
    root = None if target.root is None else Root(*target.root, frozenset(target.inner), faulty)
    return root, target.count


def _local(tag: str) -> str:
    return re.split("[}:]", tag)[-1]
