"""Wavefront OBJ: vertices, polygons, and the objects and groups that divide them.

Read line by line here, some thousands of lines at a time, rather than with trimesh, whose reader (5.2) counts
negative indices from the end of the file instead of from the face, cuts concave polygons as fans, and passes over
index 0, faces of two corners and tabs without a word. Free-form geometry is refused, never skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.form.constants import FAULTS_SHOWN, LARGEST_NUMBER, PROBLEMS_MOST
from kinform.form.meshes.blocks import NEWLINE, blocks, coordinate, with_newlines
from kinform.form.meshes.digits import written_step
from kinform.form.meshes.polygons import CUT_CORNERS, triangulate
from kinform.form.meshes.raw import REEXPORT, Fault, Labelling, LabellingKind, MeshError, RawMesh, is_coordinate
from kinform.foundation.words import counted

FACE_BYTES = 4 << 20
"""Of one line of an OBJ that states a vertex or a face: a million corners. Each takes sixty bytes while it is read."""


_SKIPPED = frozenset(
    b"vt vn vp s l p usemtl mtllib usemap maplib lod mg bevel c_interp d_interp shadow_obj trace_obj".split()
)
_WORD = re.compile(rb"[A-Za-z_]{1,16}")
"""What may be the first word of a line in a mesh."""
_FREEFORM = frozenset(
    b"cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con ctech stech bzp cdc cdp res".split()
)
_MARK = b"\xef\xbb\xbf"
_AFTER_SLASH = re.compile(rb"/\S*")


class _Faults:
    """The first faults of a file by line, and how many there are."""

    def __init__(self) -> None:
        self._kept: list[Fault] = []

    @property
    def enough(self) -> bool:
        """Whether there are so many that nobody needs more of them."""
        return len(self._kept) >= PROBLEMS_MOST

    def add(self, message: str, remedy: str, line: int) -> None:
        """Note a fault."""
        if not self.enough:
            self._kept.append(Fault(message, remedy, line))

    def raise_if_any(self) -> None:
        """Raise MeshError with the first of them."""
        if self._kept:
            faults = sorted(self._kept, key=lambda f: f.line or 0)[:FAULTS_SHOWN]
            hidden = len(self._kept) - len(faults)
            said = "has very many more faults" if self.enough else f"has {counted(hidden, 'more fault')} of this sort"
            raise MeshError([*faults, *([Fault(said, REEXPORT)] if hidden else [])])


class _Contents:
    """What a file states, as arrays a block of lines; the lists hold the lines of the present block."""

    def __init__(self) -> None:
        self.objects: dict[str, int] = {"": 0}
        self.groups: dict[str, int] = {"": 0}
        self.faults = _Faults()
        self.object = self.group = self.count = 0
        """Numbers of the object and group that a face now belongs to, and of the vertices so far."""
        self._arrays: list[tuple[NDArray[Any], ...]] = []
        self._begin()

    def _begin(self) -> None:
        self._vertices: list[bytes] = []
        self._vertex_lines: list[int] = []
        self._faces: list[bytes] = []
        self._face_facts: list[tuple[int, int, int, int]] = []

    def vertex(self, line: int, rest: bytes) -> None:
        """A `v` at a line."""
        self._vertices.append(rest)
        self._vertex_lines.append(line)
        self.count += 1

    def face(self, line: int, rest: bytes) -> None:
        """An `f` at a line."""
        self._faces.append(rest)
        self._face_facts.append((line, self.object, self.group, self.count))

    def finish_block(self) -> None:
        """Make arrays of the lines of the block."""
        vertices = _vertices(self._vertices, self._vertex_lines, self.faults)
        facts = np.array(self._face_facts, dtype=np.int64).reshape(-1, 4)
        index, sizes = _corners(self._faces, facts[:, 0], facts[:, 3], self.faults)
        lines, objects, groups = (facts[:, k].astype(np.int32) for k in range(3))
        self._arrays.append((vertices, index, sizes.astype(np.int32), lines, objects, groups))
        self._begin()

    def arrays(self) -> list[NDArray[Any]]:
        """Coordinates (n, 3); index of each corner from 0; number of corners, line, object and group of each face."""
        columns = [np.concatenate(column) for column in zip(*self._arrays, strict=True)]
        self._arrays.clear()
        return columns


def read_obj(data: bytes) -> RawMesh:
    """Facets of the bytes of an OBJ file; raises MeshError with lines."""
    if b"\0" in data[:4096]:
        raise MeshError([Fault("is no OBJ file: it holds binary data", REEXPORT)])
    return parse_obj(data)


def parse_obj(data: bytes) -> RawMesh:
    """Triangles of an OBJ file, labelled by its objects and groups; raises MeshError with lines."""
    contents = _Contents()
    for lines in _blocks_of_lines(data):
        for number, line in lines:
            _sort_line(number, line, contents)
            if contents.faults.enough:
                break
        contents.finish_block()
        if contents.faults.enough:
            contents.faults.raise_if_any()
    vertices, corners, sizes, face_lines, objects, groups = contents.arrays() or [np.zeros((0, 3))] * 6
    _check_range(corners, sizes, face_lines, len(vertices), contents.faults)
    contents.faults.raise_if_any()
    if not len(sizes):
        raise MeshError([Fault("is empty: it has no face", REEXPORT)])
    faces, owner, crossed = triangulate(vertices, corners, sizes)
    if len(crossed):
        raise MeshError([_uncut(int(sizes[p]), int(face_lines[p])) for p in crossed[:FAULTS_SHOWN]])
    labellings = (
        _labelling("object", contents.objects, objects[owner]),
        _labelling("group", contents.groups, groups[owner]),
    )
    written = written_step(_coordinates(data), vertices.ravel())
    return RawMesh(vertices, faces, tuple(x for x in labellings if x is not None), written)


def _uncut(size: int, line: int) -> Fault:
    """Why a polygon is not cut into triangles."""
    why = "crosses itself" if size <= CUT_CORNERS else f"is not convex (of such {CUT_CORNERS:,} are the most)"
    return Fault(f"has a polygon of {counted(size, 'corner')} that {why}, at line {line}", "export triangles", line)


def _coordinates(data: bytes) -> Iterator[list[bytes]]:
    """The coordinates of all vertices as they are written, block by block."""
    for lines in _blocks_of_lines(data):
        words = (line.split() for _, line in lines)
        yield [token for word in words if word and word[0] == b"v" for token in word[1:4]]


def _labelling(kind: LabellingKind, names: dict[str, int], labels: NDArray[np.integer]) -> Labelling | None:
    used, compact = np.unique(labels, return_inverse=True)
    every = list(names)
    kept = tuple(every[i] for i in used)
    return Labelling(kind, kept, compact.astype(np.int64)) if kept != ("",) else None


def _blocks_of_lines(data: bytes) -> Iterator[list[tuple[int, bytes]]]:
    """Number and text of each line without its comment, block by block, lines that end in a backslash joined with the
    next."""
    number, begun = 0, 0
    held = bytearray()
    for _, block in blocks(data, len(_MARK) if data.startswith(_MARK) else 0, len(data), NEWLINE):
        lines: list[tuple[int, bytes]] = []
        # what is behind the last newline is a line only where it holds something
        for line in with_newlines(block).removesuffix(b"\n").split(b"\n"):
            number += 1
            begun = begun or number
            if line.endswith(b"\\"):
                held += line[:-1] + b" "
                continue
            whole = bytes(held) + line if held else line
            lines.append((begun, whole.partition(b"#")[0] if b"#" in whole else whole))
            begun = 0
            held.clear()
        yield lines
    if held:
        yield [(begun, bytes(held))]


def _sort_line(number: int, line: bytes, contents: _Contents) -> None:
    """Take over what a line states; what cannot be read is among the faults."""
    word, _, rest = line.strip().replace(b"\t", b" ").partition(b" ")
    if len(rest) > FACE_BYTES and word in (b"v", b"f", b"fo"):
        message = f"has {_shown(word)!r} with {len(rest):,} characters at line {number}; {FACE_BYTES:,} are the most"
        contents.faults.add(message, "export triangles", number)
    elif word == b"v":
        contents.vertex(number, rest)
    elif word in (b"f", b"fo"):
        contents.face(number, rest)
    elif not word or word in _SKIPPED:
        return
    elif word == b"o":
        contents.object = contents.objects.setdefault(_shown(rest.strip()), len(contents.objects))
    elif word == b"g":
        contents.group = contents.groups.setdefault(_shown(b" ".join(rest.split())), len(contents.groups))
    elif word in _FREEFORM:
        message = f"has free-form geometry ({_shown(word)!r} at line {number}), which is not read"
        contents.faults.add(message, "export triangles or polygons", number)
    else:
        said = repr(_shown(word)) if _WORD.fullmatch(word) else "a line"  # what a link leads to may be no mesh
        message = f"has {said} at line {number}, which OBJ does not know"
        contents.faults.add(message, f"remove the line, or {REEXPORT}", number)


def _shown(text: bytes) -> str:
    return text.decode("utf-8", errors="replace")


def _vertices(texts: list[bytes], lines: list[int], faults: _Faults) -> NDArray[np.float64]:
    """(n, 3) coordinates, all at once where nothing is wrong; else line by line, and faults are noted."""
    rows = [rest.split() for rest in texts]
    widths = set(map(len, rows))
    if len(widths) == 1 and widths <= {3, 4, 6, 7}:
        try:
            values = np.array(list(map(coordinate, chain.from_iterable(rows)))).reshape(len(rows), -1)
        except ValueError:
            pass
        else:
            if np.isfinite(values).all() and is_coordinate(values[:, :3]).all():
                return np.ascontiguousarray(values[:, :3])
    values = np.zeros((len(rows), 3))
    for i, (row, number) in enumerate(zip(rows, lines, strict=True)):
        if faults.enough:
            break
        try:
            numbers = [coordinate(token) for token in row]
        except ValueError:
            numbers = []
        if len(row) not in (3, 4, 6, 7):
            message = f"has a vertex of {counted(len(row), 'value')} at line {number}; it needs 3"
            faults.add(message, f"write v x y z, or {REEXPORT}", number)
        elif not numbers or not all(abs(x) <= LARGEST_NUMBER for x in numbers[:3]):
            message = f"has a vertex that is not three finite numbers up to {LARGEST_NUMBER:g} at line {number}"
            faults.add(message, f"give finite numbers, or {REEXPORT}", number)
        else:
            values[i] = numbers[:3]
    return values


def _corners(
    texts: list[bytes], lines: NDArray[np.int64], before: NDArray[np.int64], faults: _Faults
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Vertex index of each corner of each face, and the number of corners of each face; `before` are the vertices that
    precede each. Indices beyond the file's vertices are left to `_check_range`."""
    tokens = [_AFTER_SLASH.sub(b"", rest).split() if b"/" in rest else rest.split() for rest in texts]
    sizes = np.array(list(map(len, tokens)), dtype=np.int64)
    for face in np.flatnonzero(sizes < 3)[:PROBLEMS_MOST].tolist():
        message = f"has a face of {counted(int(sizes[face]), 'corner')} at line {lines[face]}; it needs 3"
        faults.add(message, REEXPORT, int(lines[face]))
    if any(b"_" in rest for rest in texts):
        stated = None
    else:
        try:
            stated = np.array(list(map(int, chain.from_iterable(tokens))), dtype=np.int64)
        except (ValueError, OverflowError):
            stated = None
    if stated is None:
        for row, line in zip(tokens, lines.tolist(), strict=True):
            for token in row:
                if not re.fullmatch(rb"[+-]?\d{1,18}", token):
                    message = f"has the vertex index {_shown(token[:40])!r} at line {line}"
                    faults.add(message, f"give whole numbers, or {REEXPORT}", line)
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    index = np.where(stated > 0, stated - 1, stated + before[owner])
    for corner in np.flatnonzero((stated <= 0) & ((index < 0) | (stated == 0)))[:PROBLEMS_MOST].tolist():
        line = int(lines[owner[corner]])
        if stated[corner] == 0:
            faults.add(f"has index 0 at line {line}: OBJ counts vertices from 1", REEXPORT, line)
        else:
            _index_fault(int(stated[corner]), f"{_vertex_count(int(before[owner[corner]]))} precede it", line, faults)
    index[stated == 0] = 0  # told above: it is not out of range too
    return np.maximum(index, 0), sizes


def _check_range(
    index: NDArray[np.int64], sizes: NDArray[np.integer], lines: NDArray[np.integer], count: int, faults: _Faults
) -> None:
    """Note the corners whose vertex a file of `count` does not have."""
    beyond = np.flatnonzero(index >= count)[:PROBLEMS_MOST]
    faces = np.searchsorted(np.cumsum(sizes, dtype=np.int64), beyond, side="right")
    for stated, face in zip((index[beyond] + 1).tolist(), faces.tolist(), strict=True):
        if face < len(lines):
            _index_fault(stated, f"the file has {_vertex_count(count)}", int(lines[face]), faults)


def _vertex_count(count: int) -> str:
    return counted(count, "vertex", "vertices")


def _index_fault(stated: int, there: str, line: int, faults: _Faults) -> None:
    message = f"has index {stated} out of range at line {line}: {there}"
    faults.add(message, f"correct it, or {REEXPORT}", line)
