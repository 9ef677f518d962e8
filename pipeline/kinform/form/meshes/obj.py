"""Wavefront OBJ: vertices, polygons, and the objects and groups that divide them.

Read line by line here rather than with trimesh, whose reader (5.2) counts negative indices from the end of
the file instead of from the face, cuts concave polygons as fans, and passes over index 0, faces of two
corners and tabs without a word. Free-form geometry is refused, never skipped.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from kinform.form.constants import FAULTS_SHOWN
from kinform.form.meshes.digits import written_step
from kinform.form.meshes.polygons import triangulate
from kinform.form.meshes.raw import REEXPORT, Fault, Labelling, MeshError, RawMesh
from kinform.foundation.words import counted

_SKIPPED = frozenset(
    "vt vn vp s l p usemtl mtllib usemap maplib lod mg bevel c_interp d_interp shadow_obj trace_obj".split()
)
_FREEFORM = frozenset(
    "cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con ctech stech bzp cdc cdp res".split()
)
_AFTER_SLASH = re.compile(r"/\S*")


class _Lines:
    """What the lines of a file hold, by keyword; each list runs in the order of the file."""

    def __init__(self) -> None:
        self.vertices: list[str] = []
        self.vertex_lines: list[int] = []
        self.faces: list[str] = []
        self.face_lines: list[int] = []
        self.face_object: list[int] = []
        self.face_group: list[int] = []
        self.objects: dict[str, int] = {"": 0}
        self.groups: dict[str, int] = {"": 0}
        self.faults: list[Fault] = []


def read_obj(data: bytes) -> RawMesh:
    """Facets of the bytes of an OBJ file; raises MeshError with lines."""
    if b"\0" in data[:4096]:
        raise MeshError([Fault("is no OBJ file: it holds binary data", REEXPORT)])
    return parse_obj(data.decode("utf-8", errors="replace"))


def parse_obj(text: str) -> RawMesh:
    """Triangles of an OBJ file, labelled by its objects and groups; raises MeshError with lines."""
    lines = _sorted_lines(text)
    vertices = _vertices(lines)
    corners, sizes = _corners(lines, len(vertices))
    if lines.faults:
        hidden = len(lines.faults) - FAULTS_SHOWN
        faults = sorted(lines.faults, key=lambda f: f.line or 0)[:FAULTS_SHOWN]
        if hidden > 0:
            faults.append(Fault(f"has {counted(hidden, 'more fault')} of this sort", REEXPORT))
        raise MeshError(faults)
    if not len(sizes):
        raise MeshError([Fault("is empty: it has no face", REEXPORT)])
    faces, owner, crossed = triangulate(vertices, corners, sizes)
    if len(crossed):
        raise MeshError([
            Fault(
                f"has a polygon of {counted(int(sizes[p]), 'corner')} that crosses itself, at line "
                f"{lines.face_lines[p]}", "export triangles", lines.face_lines[p],
            )
            for p in crossed[:FAULTS_SHOWN]
        ])  # fmt: skip
    labellings = (
        _labelling("object", lines.objects, np.array(lines.face_object)[owner]),
        _labelling("group", lines.groups, np.array(lines.face_group)[owner]),
    )
    return RawMesh(vertices, faces, tuple(x for x in labellings if x is not None), _written(lines, vertices))


def _written(lines: _Lines, vertices: NDArray[np.float64]) -> float:
    """Unit of the last digit of the largest coordinates, as the text writes them."""
    return written_step([token for rest in lines.vertices for token in rest.split()[:3]], vertices.ravel())


def _labelling(kind: str, names: dict[str, int], labels: NDArray[np.int64]) -> Labelling | None:
    used, compact = np.unique(labels, return_inverse=True)
    every = list(names)
    kept = tuple(every[i] for i in used)
    return Labelling(kind, kept, compact.astype(np.int64)) if kept != ("",) else None


def _logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Number and text of each line, lines that end in a backslash joined with the next."""
    number, held = 0, ""
    for i, line in enumerate(text.replace("\r\n", "\n").replace("\r", "\n").split("\n"), 1):
        number = number or i
        if line.endswith("\\"):
            held += line[:-1] + " "
            continue
        yield number, held + line
        number, held = 0, ""
    if held:
        yield number, held


def _sorted_lines(text: str) -> _Lines:
    """The lines by keyword; what cannot be read is among their faults."""
    lines = _Lines()
    current_object = current_group = 0
    for number, line in _logical_lines(text.lstrip("\ufeff")):
        if "#" in line:
            line = line.partition("#")[0]
        word, _, rest = line.strip().replace("\t", " ").partition(" ")
        if word == "v":
            lines.vertices.append(rest)
            lines.vertex_lines.append(number)
        elif word in ("f", "fo"):
            lines.faces.append(rest)
            lines.face_lines.append(number)
            lines.face_object.append(current_object)
            lines.face_group.append(current_group)
        elif not word or word in _SKIPPED:
            continue
        elif word == "o":
            current_object = lines.objects.setdefault(rest.strip(), len(lines.objects))
        elif word == "g":
            current_group = lines.groups.setdefault(" ".join(rest.split()), len(lines.groups))
        elif word in _FREEFORM:
            message = f"has free-form geometry ({word!r} at line {number}), which is not read"
            lines.faults.append(Fault(message, "export triangles or polygons", number))
        else:
            message = f"has {word[:40]!r} at line {number}, which OBJ does not know"
            lines.faults.append(Fault(message, f"remove the line, or {REEXPORT}", number))
    return lines


def _vertices(lines: _Lines) -> NDArray[np.float64]:
    """(n, 3) coordinates, all at once where nothing is wrong; else line by line, and faults are noted."""
    rows = [rest.split() for rest in lines.vertices]
    widths = set(map(len, rows))
    if len(widths) == 1 and widths <= {3, 4, 6, 7}:
        try:
            values = np.array(list(map(float, chain.from_iterable(rows)))).reshape(len(rows), -1)[:, :3]
        except ValueError:
            pass
        else:
            if np.isfinite(values).all():
                return np.ascontiguousarray(values)
    values = np.zeros((len(rows), 3))
    for i, (row, number) in enumerate(zip(rows, lines.vertex_lines, strict=True)):
        try:
            numbers = [float(token) for token in row]
        except ValueError:
            numbers = []
        if len(row) not in (3, 4, 6, 7):
            message = f"has a vertex of {counted(len(row), 'value')} at line {number}; it needs 3"
            lines.faults.append(Fault(message, f"write v x y z, or {REEXPORT}", number))
        elif not numbers or not all(map(math.isfinite, numbers[:3])):
            message = f"has a vertex that is not three finite numbers at line {number}"
            lines.faults.append(Fault(message, f"give finite numbers, or {REEXPORT}", number))
        else:
            values[i] = numbers[:3]
    return values


def _corners(lines: _Lines, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Vertex index of each corner of each face, and the number of corners of each face."""
    tokens = [_AFTER_SLASH.sub("", rest).split() if "/" in rest else rest.split() for rest in lines.faces]
    sizes = np.array(list(map(len, tokens)), dtype=np.int64)
    for short in np.flatnonzero(sizes < 3):
        face = int(short)
        number = lines.face_lines[face]
        message = f"has a face of {counted(int(sizes[face]), 'corner')} at line {number}; it needs 3"
        lines.faults.append(Fault(message, REEXPORT, number))
    try:
        stated = np.array(list(map(int, chain.from_iterable(tokens))), dtype=np.int64)
    except (ValueError, OverflowError):
        for face, row in enumerate(tokens):
            for token in row:
                if not re.fullmatch(r"[+-]?\d{1,18}", token):
                    number = lines.face_lines[face]
                    message = f"has the vertex index {token[:40]!r} at line {number}"
                    lines.faults.append(Fault(message, f"give whole numbers, or {REEXPORT}", number))
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    before = np.searchsorted(np.array(lines.vertex_lines), np.array(lines.face_lines))
    owner = np.repeat(np.arange(len(sizes)), sizes)
    index = np.where(stated > 0, stated - 1, stated + before[owner] if len(owner) else stated)
    for corner in np.flatnonzero((index < 0) | (index >= count) | (stated == 0)):
        face = owner[corner]
        lines.faults.append(_index_fault(int(stated[corner]), lines.face_lines[face], int(before[face]), count))
    return index, sizes


def _index_fault(stated: int, line: int, before: int, count: int) -> Fault:
    if stated == 0:
        return Fault(f"has index 0 at line {line}: OBJ counts vertices from 1", REEXPORT, line)
    vertices = counted(before if stated < 0 else count, "vertex", "vertices")
    there = f"{vertices} precede it" if stated < 0 else f"the file has {vertices}"
    return Fault(f"has index {stated} out of range at line {line}: {there}", f"correct it, or {REEXPORT}", line)
