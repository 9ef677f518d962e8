"""How parts look: the facets of each body's parts in the world's axes, and their own colour or one a material."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers
from kinform.foundation.colours import shares
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Part

Colour = tuple[float, float, float, float]

_COLOURS: dict[str, tuple[float, float, float]] = {
    "steel": (0.55, 0.57, 0.60),
    "stainless": (0.68, 0.69, 0.70),
    "aluminium": (0.77, 0.78, 0.80),
    "aluminum": (0.77, 0.78, 0.80),
    "brass": (0.80, 0.68, 0.32),
    "bronze": (0.70, 0.50, 0.28),
    "copper": (0.78, 0.46, 0.30),
    "titanium": (0.60, 0.58, 0.55),
    "rubber": (0.16, 0.16, 0.17),
    "plywood": (0.80, 0.67, 0.46),
    "cfrp": (0.22, 0.23, 0.25),
}
"""Of materials, in sRGB, as they look in daylight. Chosen by eye."""
_PALETTE = (
    (0.36, 0.54, 0.74), (0.88, 0.58, 0.30), (0.45, 0.66, 0.45), (0.75, 0.42, 0.42), (0.60, 0.50, 0.72),
    (0.58, 0.46, 0.38), (0.84, 0.56, 0.72), (0.72, 0.70, 0.36), (0.36, 0.68, 0.70), (0.62, 0.62, 0.62),
)  # fmt: skip
"""Of other materials, in turn: neighbours differ in hue. Chosen by eye."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The mesh of one part of a body."""

    part: str
    file: str
    """Name of its file without ending, unique among all parts."""
    material: str
    """What has the colour: the material of the manifest, "" where none is stated; of a part with a colour of its own
    that colour, "#rrggbb"."""
    rgba: Colour
    """sRGB."""
    digest: str
    X_WP: Array
    """(4, 4)."""
    vertices: Array
    """(V, 3) m, part frame."""
    faces: NDArray[np.int64]
    """(F, 3)."""

    @property
    def in_world(self) -> Array:
        """(V, 3) vertices in the world at the pose of the meshes."""
        return np.asarray(self.vertices @ self.X_WP[:3, :3].T + self.X_WP[:3, 3])


def shapes_of(model: ExportModel) -> dict[str, tuple[Shape, ...]]:
    """The shapes of each body, by its name; bodies without meshes have none."""
    files = identifiers((part.name for part in model.assembly.parts), FILES)
    colours = _colours(model.assembly.parts)
    out = {}
    for body in model.kinematics.bodies:
        looks = []
        for name in body.parts:
            part = model.assembly.part(name)
            if part.mesh is None or not len(part.mesh.faces):
                continue
            mesh, material = part.mesh, part.own_colour or part.material or ""
            rgba = (*shares(part.own_colour), 1.0) if part.own_colour else colours[material]
            looks.append(
                Shape(part.name, files[part.name], material, rgba, mesh.digest, part.X_WP, mesh.vertices, mesh.faces)
            )
        out[str(body.name)] = tuple(looks)
    return out


def stl(vertices: Array, faces: NDArray[np.int64]) -> bytes:
    """Binary STL of vertices (V, 3) m and faces (F, 3)."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    record = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["normal"], record["corners"] = normals, corners
    record["normal"] += 0.0
    count = len(faces).to_bytes(4, "little")
    return b"".join((b"kinform".ljust(80, b" "), count, bytes(record.tobytes())))


def _colours(parts: tuple[Part, ...]) -> dict[str, Colour]:
    """By material: its own colour where that is known, else the next of the palette, in the order of names."""
    materials = sorted({part.material or "" for part in parts})
    unknown = [name for name in materials if name not in _COLOURS]
    palette = {name: _PALETTE[k % len(_PALETTE)] for k, name in enumerate(unknown)}
    return {name: (*(_COLOURS.get(name) or palette[name]), 1.0) for name in materials}
