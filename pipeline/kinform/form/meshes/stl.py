"""STL files, binary and ASCII.

Binary: 80 bytes of header, a little-endian count, 50 bytes a facet. The count is compared with the size of
the file before anything is allocated, and it, not the word "solid", decides which kind a file is.
Stated normals are not used: the order of the corners decides.
"""

from __future__ import annotations

import re
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from kinform.form.meshes.digits import written_step
from kinform.form.meshes.raw import REEXPORT, Fault, Labelling, MeshError, RawMesh, soup
from kinform.foundation.words import counted

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_SOLID = re.compile(r"^[ \t]*(end)?solid\b[ \t]*([^\n]*)$", re.MULTILINE | re.IGNORECASE)
_VERTEX = re.compile(r"\bvertex[ \t]+([^\n]*)", re.IGNORECASE)
_TOKENS = 21
_WORDS = {
    0: "facet", 1: "normal", 5: "outer", 6: "loop", 7: "vertex", 11: "vertex", 15: "vertex",
    19: "endloop", 20: "endfacet",
}  # fmt: skip


def read_stl(data: bytes) -> RawMesh:
    """Facets of the bytes of an STL file; raises MeshError."""
    size, head = len(data), data[:1024]
    count = int.from_bytes(head[80:84], "little") if len(head) >= _HEADER else None
    if count is not None and size >= _HEADER + _RECORD.itemsize * count and not _is_text(head):
        return parse_binary(data)
    if count is not None and size == _HEADER + _RECORD.itemsize * count:
        return parse_binary(data)
    if _is_text(head):
        return parse_ascii(data.decode("utf-8", errors="replace"))
    raise MeshError([_wrong_size(size, count)])


def _is_text(head: bytes) -> bool:
    start = head.lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    return start.startswith(b"solid") and b"\0" not in head


def _wrong_size(size: int, count: int | None) -> Fault:
    if size == 0:
        return Fault("is empty (0 bytes)", REEXPORT)
    if count is None:
        return Fault(f"is no STL file: {size} bytes, and a binary header alone has {_HEADER}", REEXPORT)
    need = _HEADER + _RECORD.itemsize * count
    return Fault(
        f"is truncated: its header claims {count} facets, which take {need} bytes, and it has {size}",
        f"{REEXPORT}; the file holds at most {counted(max(0, size - _HEADER) // _RECORD.itemsize, 'facet')}",
    )


def parse_binary(data: bytes) -> RawMesh:
    """Facets of a whole binary STL file; raises MeshError."""
    count = int.from_bytes(data[80:84], "little")
    spare = len(data) - _HEADER - _RECORD.itemsize * count
    if spare < 0:
        raise MeshError([_wrong_size(len(data), count)])
    if spare >= _RECORD.itemsize:
        raise MeshError([Fault(f"has {spare} bytes after the {count} facets that its header claims", REEXPORT)])
    if count == 0:
        raise MeshError([Fault("is empty: its header claims 0 facets", REEXPORT)])
    corners = np.frombuffer(data, _RECORD, count, _HEADER)["corners"].astype(np.float32)
    finite = np.isfinite(corners).all(axis=(1, 2))
    if not finite.all():
        bad = np.flatnonzero(~finite)
        raise MeshError([Fault(
            f"has a vertex that is not a finite number in {counted(len(bad), 'facet')}, "
            f"the first is facet {bad[0] + 1} of {count}", REEXPORT,
        )])  # fmt: skip
    return soup(corners)


def parse_ascii(text: str) -> RawMesh:
    """Facets of an ASCII STL file, labelled by its solids; raises MeshError with lines."""
    text = text.replace("\r\n", "\n").replace("\r", "\n").lstrip("\ufeff")
    corners, labels = [], []
    names: list[str] = []
    faults: list[Fault] = []
    for name, start, stop in _solids(text, faults):
        body = _facets(text, start, stop, faults)
        corners.append(body)
        labels.append(np.full(len(body), len(names)))
        names.append(name)
    if faults:
        raise MeshError(faults)
    if not sum(map(len, corners)):
        raise MeshError([Fault("is empty: it has no facet", REEXPORT)])
    unique, where = _unique_names(names)
    label = where[np.concatenate(labels)]
    every = np.concatenate(corners)
    return soup(every, (Labelling("solid", unique, label),), _written(text, every))


def _written(text: str, corners: NDArray[np.float64]) -> float:
    """Unit of the last digit of the largest coordinates, as the text writes them."""
    tokens = [token for line in _VERTEX.findall(text) for token in line.split()]
    return written_step(tokens, corners.ravel()) if len(tokens) == corners.size else 0.0


def _solids(text: str, faults: list[Fault]) -> list[tuple[str, int, int]]:
    """Name, first and last position of the facets of each solid."""
    solids: list[tuple[str, int, int]] = []
    opened: re.Match[str] | None = None
    end = 0
    for found in _SOLID.finditer(text):
        if found[1] is None and opened is None:
            _only_space(text, end, found.start(), faults)
            opened = found
        elif found[1] is not None and opened is not None:
            solids.append((opened[2].strip(), opened.end(), found.start()))
            opened, end = None, found.end()
        else:
            what = "solid" if found[1] is None else "endsolid"
            line = _line(text, found.start())
            faults.append(Fault(f"has an unexpected {what} at line {line}", REEXPORT, line))
            return solids
    if opened is not None:
        line = _line(text, len(text.rstrip()))
        faults.append(Fault(f"is truncated: solid {opened[2].strip()!r} has no endsolid", REEXPORT, line))
    else:
        _only_space(text, end, len(text), faults)
    return solids


def _only_space(text: str, start: int, stop: int, faults: list[Fault]) -> None:
    rest = text[start:stop].strip()
    if rest:
        line = _line(text, start + len(text[start:stop]) - len(text[start:stop].lstrip()))
        faults.append(Fault(f"has {rest.split()[0][:40]!r} outside a solid at line {line}", REEXPORT, line))


def _facets(text: str, start: int, stop: int, faults: list[Fault]) -> NDArray[np.float64]:
    """(F, 3, 3) corners of one solid."""
    tokens = text[start:stop].split()
    count = len(tokens) // _TOKENS
    regular = len(tokens) % _TOKENS == 0 and all(
        set(map(str.lower, tokens[i::_TOKENS])) <= {word} for i, word in _WORDS.items()
    )
    if regular:
        columns = [tokens[i::_TOKENS] for i in (8, 9, 10, 12, 13, 14, 16, 17, 18)]
        try:
            values = np.array(list(map(float, chain.from_iterable(columns)))).reshape(9, count).T
        except ValueError:
            regular = False
        else:
            if np.isfinite(values).all():
                return values.reshape(-1, 3, 3)
            regular = False
    faults.append(_first_fault(text, start, stop))
    return np.zeros((0, 3, 3))


def _first_fault(text: str, start: int, stop: int) -> Fault:
    position, place = start, 0
    for place, token in enumerate(re.finditer(r"\S+", text[start:stop])):
        position = start + token.start()
        line = _line(text, position)
        word = _WORDS.get(place % _TOKENS)
        if word is not None and token[0].lower() != word:
            return Fault(f"has {token[0][:40]!r} where {word!r} is due, at line {line}", REEXPORT, line)
        if word is None and place % _TOKENS > 6:
            facet = place // _TOKENS + 1
            try:
                finite = bool(np.isfinite(float(token[0])))
            except ValueError:
                finite = False
            if not finite:
                message = f"has the coordinate {token[0][:40]!r} in facet {facet}, at line {line}"
                return Fault(message, "give finite numbers: " + REEXPORT, line)
    line = _line(text, position)
    return Fault(f"breaks off in facet {place // _TOKENS + 1}, at line {line}", REEXPORT, line)


def _unique_names(names: list[str]) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Solids are bodies even if their names repeat: repeated and empty names get a number."""
    taken: dict[str, None] = {}
    for i, name in enumerate(names):
        wanted = name or f"solid {i + 1}"
        unique, number = wanted, 2
        while unique in taken:
            unique, number = f"{wanted} {number}", number + 1
        taken[unique] = None
    return tuple(taken), np.arange(len(names))


def _line(text: str, position: int) -> int:
    return text.count("\n", 0, position) + 1
