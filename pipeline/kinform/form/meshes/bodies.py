"""The bodies that one mesh file holds: what the file names, else its separate shells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.form.meshes.raw import Fault, MeshError, RawMesh
from kinform.form.meshes.weld import merge_close, merge_exact, used_only
from kinform.foundation.meshes.edges import edge_table
from kinform.foundation.meshes.shells import shells_of
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SINGLE
from kinform.model.arrays import Array, Ints

INSIDE = 0.5
"""Winding number above which a point lies in a shell: halfway between 0 outside and 1 inside."""


def named_bodies(raw: RawMesh) -> dict[str, RawMesh]:
    """Bodies that the file names, by name: objects, else groups, else solids; {} when it names fewer than two."""
    for labelling in raw.labellings:
        if len(labelling.names) > 1:
            return {name or "unnamed": _part(raw, labelling.labels == k) for k, name in enumerate(labelling.names)}
    return {}


def shell_bodies(raw: RawMesh) -> dict[str, RawMesh]:
    """Connected shells as "shell 1", "shell 2", …; a cavity belongs to the shell around it."""
    first, place = merge_exact(raw.vertices)
    vertices = raw.vertices[first].astype(np.float64)
    leaders, close = merge_close(vertices, SINGLE * float(np.linalg.norm(np.ptp(vertices, axis=0))))
    vertices, faces = vertices[leaders], close[place[raw.faces]]
    a, b, c = faces.T
    whole = (a != b) & (b != c) & (c != a)
    label = np.full(len(faces), -1)
    label[whole] = shells_of(vertices, faces[whole], edge_table(faces[whole], len(vertices)))
    label = _with_cavities(vertices, faces, label)
    names = [k for k in np.unique(label) if k >= 0]
    return {f"shell {n}": _part(raw, label == k) for n, k in enumerate(names, start=1)}


def select_body(raw: RawMesh, name: str) -> RawMesh:
    """The body of that name; raises MeshError with the names there are."""
    bodies = {
        n or "unnamed": (labelling.labels == k) for labelling in raw.labellings for k, n in enumerate(labelling.names)
    }
    if name in bodies:
        return _part(raw, bodies[name])
    shells = shell_bodies(raw)
    if name in shells:
        return shells[name]
    remedy = did_you_mean(name, [*bodies, *shells], "the bodies of the file")
    raise MeshError([Fault(f"has no body {in_quotes(name)}", remedy)])


def _part(raw: RawMesh, chosen: NDArray[np.bool_]) -> RawMesh:
    vertices, faces = used_only(raw.vertices, raw.faces[chosen])
    return RawMesh(vertices, faces, written=raw.written, colour=raw.colour)


def _with_cavities(vertices: Array, faces: Ints, label: Ints) -> Ints:
    """Labels in which a shell of negative volume takes the label of the smallest shell around it."""
    shells = [k for k in np.unique(label) if k >= 0]
    volume = {k: _volume(vertices, faces[label == k]) for k in shells}
    out = label.copy()
    for k in shells:
        if volume[k] >= 0.0:
            continue
        probe = vertices[faces[label == k][0]].mean(axis=0)
        around = [
            j for j in shells if volume[j] > abs(volume[k]) and _winding(vertices, faces[label == j], probe) > INSIDE
        ]
        if around:
            out[label == k] = min(around, key=lambda j: volume[j])
    return out


def _volume(vertices: Array, faces: Ints) -> float:
    p = vertices[faces] - vertices[faces].mean(axis=(0, 1))
    return float(np.einsum("ij,ij->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0)


def _winding(vertices: Array, faces: Ints, point: Array) -> float:
    """Winding number of a closed shell about a point (Van Oosterom and Strackee 1983)."""
    a, b, c = np.moveaxis(vertices[faces] - point, 1, 0)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    top = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = (np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a)))
    ab, bc, ca = dots
    solid_angle = 2.0 * np.arctan2(top, la * lb * lc + ab * lc + bc * la + ca * lb)
    return float(solid_angle.sum() / (4.0 * np.pi))
