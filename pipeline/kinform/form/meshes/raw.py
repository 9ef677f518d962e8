"""Facets as a file states them, before welding and without units, and what a reader complains about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from kinform.form.constants import LARGEST_NUMBER
from kinform.frozen import dataclass

LabellingKind = Literal["object", "group", "solid"]
REEXPORT = "export the mesh again"
"""The remedy where nothing else helps."""


def is_coordinate(values: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Which numbers can be coordinates: the finite ones that are not absurdly large."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(values) <= LARGEST_NUMBER)


@dataclass(frozen=True)
class Fault:
    """One thing wrong with a mesh file; `line` (1-based) where the format has lines."""

    message: str
    remedy: str
    line: int | None = None


class MeshError(Exception):
    """A mesh file cannot be used. Carries its faults; the caller adds file and manifest line."""

    def __init__(self, faults: Sequence[Fault]):
        self.faults = tuple(faults)
        super().__init__("; ".join(fault.message for fault in self.faults))


@dataclass(frozen=True, eq=False)
class Labelling:
    """One way in which a file divides its facets: OBJ objects, OBJ groups, or ASCII solids."""

    kind: LabellingKind
    names: tuple[str, ...]
    """Distinct, in the order of the file; "" for facets before the first name."""
    labels: NDArray[np.int64]
    """(F,) index into names."""


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Vertices (n, 3) float32 or float64 in file units, faces (F, 3), and how the file divides them."""

    vertices: NDArray[np.floating]
    faces: NDArray[np.int64]
    labellings: tuple[Labelling, ...] = ()
    written: float = 0.0
    """Unit of the last digit of the largest coordinates of a text, in file units; 0: finer than can be told."""
    colour: str | None = None
    """"#rrggbb" (sRGB) of most of its area, where the file has colours."""

    @property
    def resolution(self) -> float:
        """What one step of the last place is in the largest coordinate, in file units: of binary numbers, or as
        written."""
        largest = float(np.abs(self.vertices).max(initial=0.0))
        return max(self.written, float(np.finfo(self.vertices.dtype).eps) * largest)


def prevailing(
    vertices: NDArray[np.floating], pieces: Sequence[NDArray[np.int64]], colours: Sequence[str | None]
) -> str | None:
    """The colour of most of the area, where each piece (n, 3) of the facets has one colour or none."""
    if len(set(colours)) <= 1:
        return colours[0] if colours else None
    areas: dict[str | None, float] = {}
    for faces, colour in zip(pieces, colours, strict=True):
        a, b, c = (vertices[faces[:, k]].astype(np.float64) for k in range(3))
        with np.errstate(over="ignore", invalid="ignore"):
            area = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
        areas[colour] = areas.get(colour, 0.0) + area
    return max(areas, key=lambda colour: (areas[colour], colour or ""))


def soup(corners: NDArray[np.floating], labellings: tuple[Labelling, ...] = (), written: float = 0.0) -> RawMesh:
    """A raw mesh of (F, 3, 3) facet corners, none of them shared."""
    faces = np.arange(3 * len(corners), dtype=np.int64).reshape(-1, 3)
    return RawMesh(corners.reshape(-1, 3), faces, labellings, written)


def scaled(raw: RawMesh, factors: Sequence[float]) -> RawMesh:
    """The facets scaled along the axes of the file; turned round where that mirrors them."""
    vertices = raw.vertices.astype(np.float64) * np.asarray(factors)
    mirrors = np.prod(np.sign(factors)) < 0.0
    faces = np.ascontiguousarray(raw.faces[:, ::-1]) if mirrors else raw.faces
    written = max(raw.written, float(np.finfo(raw.vertices.dtype).eps) * float(np.abs(raw.vertices).max(initial=0.0)))
    return replace(raw, vertices=vertices, faces=faces, written=written * float(np.abs(factors).max()))
