"""Which files are designs, told from what is in them: read as the readers read it, not by what they begin with.

A manifest or a description that cannot be read is a design too, as long as it can be seen to be meant as one: then its
run says what is wrong with it.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from kinform.form.constants import MANIFEST_BYTES, TEXT_BYTES
from kinform.foundation.regular_files import not_a_file

DESCRIPTIONS = (".urdf", ".xacro", ".sdf", ".world", ".mjcf", ".xml")
"""Suffixes of robot descriptions."""

_ROOTS = {".urdf": "robot", ".xacro": "robot", ".sdf": "sdf", ".world": "sdf", ".mjcf": "mujoco"}
"""Name of the root element, by suffix; several formats share .xml."""
_ALWAYS_XML = (".urdf", ".xacro", ".mjcf")
"""Suffixes that no other program uses for something else: such a file that is no XML is a faulty description."""
_MEANT = re.compile(rb"<(?:[\w.-]+:)?(?:sdf|mujoco)[\s/>]")
"""What a text that is no XML, and meant as SDF or MJCF, has somewhere."""

_TELLING = ("assembly", "part", "subassembly")
_KEYS = (*_TELLING, "schema", "materials", "friction", "group", "assume", "tolerances", "fasteners", "function",
         "simulation", "check")  # fmt: skip
"""Top keys of a manifest; with one of the telling ones, and a second one, a TOML is meant as a manifest."""
_WORD = re.compile(rb"assembly|part|\\")
_FIRST = re.compile(rb"^[ \t]*+(?:\[{1,2}[ \t]*+)?[\"']?(" + "|".join(_KEYS).encode() + rb")[\"']?[ \t]*+[=.\]]", re.M)
_ESCAPED = re.compile(rb"\\u00([0-7][0-9A-Fa-f])|\\U000000([0-7][0-9A-Fa-f])")
_POINTER = b"version https://git-lfs"


def is_design(path: Path) -> bool:
    """Whether a file is a manifest, or a robot description that stands for itself; one that cannot be opened may be."""
    suffix = path.suffix.lower()
    if suffix not in (".toml", *DESCRIPTIONS) or not_a_file(path) is not None or path.is_dir():
        return False
    try:
        return is_manifest(path) if suffix == ".toml" else _is_description(path, suffix)
    except (OSError, ValueError):
        return True


def is_manifest(path: Path) -> bool:
    """Whether a TOML file is a manifest, or meant as one. Raises OSError where it cannot be opened."""
    from kinform.form.readers.toml_text import TomlError, read_toml
    from kinform.foundation.texts import TextError, read_text

    with open(path, "rb") as stream:
        data = stream.read(TEXT_BYTES + 1)
    if data.startswith(_POINTER) or len(data) > TEXT_BYTES:
        return True
    plain = data.replace(b"\0", b"")  # of UTF-16 and UTF-32 what is ASCII
    if _WORD.search(plain) is None:
        return False
    try:
        tables: dict[str, Any] | None = read_toml(read_text(path, MANIFEST_BYTES, "a manifest"))
    except (TextError, TomlError, ValueError, RecursionError):
        tables = None
    keys = _first_words(plain) if tables is None else set(tables)
    return len(keys.intersection(_KEYS)) >= 2 and not keys.isdisjoint(_TELLING)


def _first_words(data: bytes) -> set[str]:
    """Keys of a manifest that stand at the beginning of a line in a text that is no TOML."""
    text = data.lstrip(b"\xef\xbb\xbf\xff\xfe").replace(b"\r", b"\n")
    text = _ESCAPED.sub(lambda found: bytes([int(found[1] or found[2], 16)]), text)
    return {word.decode() for word in _FIRST.findall(text)}


def _is_description(path: Path, suffix: str) -> bool:
    from kinform.foundation.xml_root import root_of_file

    root = root_of_file(path, TEXT_BYTES + 1, inner=suffix == ".xml")
    if root is None:
        return suffix in _ALWAYS_XML or _is_meant(path, suffix)
    if suffix == ".xml":  # <robot> is the root of other programs' files too
        return root.name in ("mujoco", "sdf") or (root.name == "robot" and "link" in root.inner)
    return root.name == _ROOTS[suffix] and (suffix != ".xacro" or "name" in root.attributes or root.faulty)


def _is_meant(path: Path, suffix: str) -> bool:
    with open(path, "rb") as stream:
        data = stream.read(TEXT_BYTES + 1).replace(b"\0", b"")
    return _MEANT.search(data) is not None or (suffix != ".xml" and data.startswith(_POINTER))
