"""STL files, binary and ASCII.

Binary: 80 bytes of header, a little-endian count, 50 bytes a facet. The count is compared with the size of
the file before anything is allocated, and it, not the word "solid", decides which kind a file is.
Stated normals are not used: the order of the corners decides.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import chain
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from kinform.form.constants import FAULTS_SHOWN, LARGEST_NUMBER
from kinform.form.meshes.blocks import SPACE, blocks, coordinate, with_newlines
from kinform.form.meshes.digits import written_step
from kinform.form.meshes.raw import REEXPORT, Fault, Labelling, MeshError, RawMesh, is_coordinate, soup
from kinform.foundation.words import counted

_HEADER = 84
"""Bytes before the records of a binary STL: 80 of text, 4 for the number of facets."""
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""One facet of a binary STL, 50 bytes."""
_SOLID = re.compile(rb"^[ \t]*(end)?solid\b[ \t]*([^\n]*)$", re.MULTILINE | re.IGNORECASE)
_UNPRINTABLE = re.compile(rb"[\x00-\x08\x0e-\x1f\x7f]")
_OTHERS = (
    (re.compile(rb"ply\s"), "a PLY file", ".ply"),
    (re.compile(rb"(ST|C|N|4|n)*OFF\s"), "an OFF file", ".off"),
    (re.compile(rb"ISO-10303-21"), "a STEP file", ".step"),
    (re.compile(rb"glTF"), "a GLB file", ".glb"),
    (re.compile(rb"PK\x03\x04"), "a 3MF file (or another ZIP archive)", ".3mf"),
    (re.compile(rb"(#[^\n]*\n\s*)*(v|vn|vt|f|o|g|s|mtllib|usemtl)[ \t]+\S"), "an OBJ file", ".obj"),
)
"""How files of other formats begin, that are found under the name of an STL file."""
_TOKENS = 21
"""Words of a facet in a text STL, from `facet` to `endfacet`; `_WORDS` are those that are no numbers."""
_WORDS = {
    0: b"facet", 1: b"normal", 5: b"outer", 6: b"loop", 7: b"vertex", 11: b"vertex", 15: b"vertex",
    19: b"endloop", 20: b"endfacet",
}  # fmt: skip
_COORDINATES = (8, 9, 10, 12, 13, 14, 16, 17, 18)
"""Of the words of a facet in a text STL, those that are coordinates of its corners."""
_written = itemgetter(*_COORDINATES)


def read_stl(data: bytes) -> RawMesh:
    """Facets of the bytes of an STL file; raises MeshError."""
    size, head = len(data), data[:1024]
    count = int.from_bytes(head[80:84], "little") if len(head) >= _HEADER else None
    if count is not None and size >= _HEADER + _RECORD.itemsize * count and not _is_text(head):
        return parse_binary(data)
    if count is not None and size == _HEADER + _RECORD.itemsize * count:
        return parse_binary(data)
    if _is_text(head):
        return parse_ascii(data)
    raise MeshError([_of_another_kind(head) or _wrong_size(size, count)])


def _of_another_kind(head: bytes) -> Fault | None:
    """What is wrong where the file begins as those of another format do, or is text; None where it may be binary."""
    start = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    for begins, kind, ending in _OTHERS:
        if begins.match(start):
            return Fault(f"is no STL file: it begins as {kind} does", f"name it {ending}, or export it as STL")
    if start and not _UNPRINTABLE.search(start):
        return Fault('is no STL file: it is text that does not begin with "solid"', REEXPORT)
    return None


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
    if not is_coordinate(corners.max()) or not is_coordinate(corners.min()):
        bad = np.flatnonzero(~is_coordinate(corners).all(axis=(1, 2)))
        raise MeshError([Fault(
            f"has a vertex that is not a finite number up to {LARGEST_NUMBER:g} in {counted(len(bad), 'facet')}, "
            f"the first is facet {bad[0] + 1} of {count}", REEXPORT,
        )])  # fmt: skip
    return soup(corners)


def parse_ascii(data: bytes) -> RawMesh:
    """Facets of the bytes of an ASCII STL file, labelled by its solids; raises MeshError with lines.

    Tokens take twenty times the memory of what they say, so that the text is read block by block.
    """
    text = with_newlines(data).removeprefix(b"\xef\xbb\xbf")
    corners, labels = [], []
    names: list[str] = []
    faults: list[Fault] = []
    solids = _solids(text, faults)
    for name, start, stop in solids:
        body = _facets(text, start, stop, faults)
        corners.append(body)
        labels.append(np.full(len(body), len(names), dtype=np.int32))
        names.append(name)
        if len(faults) >= FAULTS_SHOWN:
            break
    if faults:
        raise MeshError(faults)
    if not sum(map(len, corners)):
        raise MeshError([Fault("is empty: it has no facet", REEXPORT)])
    unique, where = _unique_names(names)
    label = where[np.concatenate(labels)]
    every = np.concatenate(corners)
    written = written_step(_coordinates(text, solids), every.reshape(-1))
    return soup(every, (Labelling("solid", unique, label),), written)


def _coordinates(text: bytes, solids: list[tuple[str, int, int]]) -> Iterator[list[bytes]]:
    """The coordinates of all facets as they are written, block by block."""
    for _, start, stop in solids:
        for _, tokens in _facet_tokens(text, start, stop):
            facets = (tokens[k : k + _TOKENS] for k in range(0, len(tokens), _TOKENS))
            yield [token for facet in facets for token in _written(facet)]


def _facet_tokens(text: bytes, start: int, stop: int) -> Iterator[tuple[int, list[bytes]]]:
    """The words of one solid, block by block, as many as whole facets have, with the position of the first; the last
    ones may be fewer."""
    held: list[bytes] = []
    place = start
    for first, block in blocks(text, start, stop, SPACE):
        words = block.split()
        tokens = held + words
        rest = len(tokens) % _TOKENS
        if rest < len(tokens):
            yield place, tokens[: len(tokens) - rest]
            place = first + len(block) if not rest else first + len(block.rsplit(None, rest)[0])
        held = tokens[len(tokens) - rest :]
    if held:
        yield place, held


def _solids(text: bytes, faults: list[Fault]) -> list[tuple[str, int, int]]:
    """Name, first and last position of the facets of each solid."""
    solids: list[tuple[str, int, int]] = []
    opened: re.Match[bytes] | None = None
    end = 0
    for found in _SOLID.finditer(text):
        if found[1] is None and opened is None:
            _only_space(text, end, found.start(), faults)
            opened = found
        elif found[1] is not None and opened is not None:
            solids.append((_shown(opened[2].strip()), opened.end(), found.start()))
            opened, end = None, found.end()
        else:
            what = "solid" if found[1] is None else "endsolid"
            line = _line(text, found.start())
            faults.append(Fault(f"has an unexpected {what} at line {line}", REEXPORT, line))
            return solids
        if len(faults) >= FAULTS_SHOWN:
            return solids
    if opened is not None:
        line = _line(text, len(text.rstrip()))
        faults.append(Fault(f"is truncated: solid {_shown(opened[2].strip())!r} has no endsolid", REEXPORT, line))
    else:
        _only_space(text, end, len(text), faults)
    return solids


def _shown(text: bytes) -> str:
    return text.decode("utf-8", errors="replace")


def _only_space(text: bytes, start: int, stop: int, faults: list[Fault]) -> None:
    found = re.compile(rb"\S+").search(text, start, stop)
    if found:
        line = _line(text, found.start())
        faults.append(Fault(f"has {_shown(found[0][:40])!r} outside a solid at line {line}", REEXPORT, line))


def _facets(text: bytes, start: int, stop: int, faults: list[Fault]) -> NDArray[np.float64]:
    """(F, 3, 3) corners of one solid."""
    parts = [np.zeros((0, 3, 3))]
    for place, tokens in _facet_tokens(text, start, stop):
        values = _values(tokens)
        if values is None:
            faults.append(_first_fault(text, place, stop, sum(map(len, parts))))
            return parts[0]
        parts.append(values)
    return np.concatenate(parts)


def _values(tokens: list[bytes]) -> NDArray[np.float64] | None:
    """(F, 3, 3) corners of the facets that these words state; None where something is wrong."""
    count = len(tokens) // _TOKENS
    regular = len(tokens) % _TOKENS == 0 and all(
        set(map(bytes.lower, tokens[i::_TOKENS])) <= {word} for i, word in _WORDS.items()
    )
    if not regular:
        return None
    columns = [tokens[i::_TOKENS] for i in _COORDINATES]
    try:
        values = np.array(list(map(coordinate, chain.from_iterable(columns)))).reshape(9, count).T
    except ValueError:
        return None
    return values.reshape(-1, 3, 3) if is_coordinate(values).all() else None


def _first_fault(text: bytes, start: int, stop: int, facets: int) -> Fault:
    """What is wrong first from a position on, at which a facet begins that so many precede."""
    position, place = start, 0
    for place, token in enumerate(re.compile(rb"\S+").finditer(text, start, stop)):
        position = token.start()
        word = _WORDS.get(place % _TOKENS)
        if word is not None and token[0].lower() != word:
            line = _line(text, position)
            message = f"has {_shown(token[0][:40])!r} where {word.decode()!r} is due, at line {line}"
            return Fault(message, REEXPORT, line)
        if word is None and place % _TOKENS > 6 and not _is_coordinate(token[0]):
            facet, line = facets + place // _TOKENS + 1, _line(text, position)
            message = f"has the coordinate {_shown(token[0][:40])!r} in facet {facet}, at line {line}"
            return Fault(message, f"give finite numbers up to {LARGEST_NUMBER:g}: {REEXPORT}", line)
    line = _line(text, position)
    return Fault(f"breaks off in facet {facets + place // _TOKENS + 1}, at line {line}", REEXPORT, line)


def _is_coordinate(token: bytes) -> bool:
    try:
        return abs(coordinate(token)) <= LARGEST_NUMBER
    except ValueError:
        return False


def _unique_names(names: list[str]) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Solids are bodies even if their names repeat: repeated and empty names get a number."""
    taken: dict[str, None] = {}
    numbers: dict[str, int] = {}
    for i, name in enumerate(names):
        wanted = name or f"solid {i + 1}"
        unique, number = wanted, numbers.get(wanted, 2)
        while unique in taken:
            unique, number = f"{wanted} {number}", number + 1
        numbers[wanted] = number
        taken[unique] = None
    return tuple(taken), np.arange(len(names))


def _line(text: bytes, position: int) -> int:
    return text.count(b"\n", 0, position) + 1
