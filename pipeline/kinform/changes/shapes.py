"""What was done to a part, from its meshes and poses before and after: where it went, and whether its shape is another.

A mesh is known again whatever frame it is written in, in whatever order and with whatever facets.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from kinform.foundation.algebra.displacements import inverse, twist_of
from kinform.foundation.meshes.closest_facets import closest_facets
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.foundation.words import angle, direction, length, listed
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh, Part


def displacement(was: Part, part: Part) -> tuple[Array | None, bool]:
    """The displacement of a part in the world (4, 4), and whether its facets are the same. None: it is another shape in
    a frame of another description, and nothing says that it moved."""
    X = part.X_WP @ inverse(was.X_WP)
    if was.mesh is None or part.mesh is None:
        return X, was.mesh is part.mesh
    if was.mesh.digest == part.mesh.digest:
        return X, True
    within = _rigid(was.mesh, part.mesh, _near(was, part))
    if within is not None:
        return part.X_WP @ within @ inverse(was.X_WP), True
    shift = _shift(was, part)
    if shift is not None:
        return shift, True
    stays, goes, now = _box(_placed(was)), _box(_placed(was) @ X[:3, :3].T + X[:3, 3]), _box(_placed(part))
    return (None if np.abs(stays - now).max() < np.abs(goes - now).max() else X), False


def _near(was: Part, part: Part) -> float:
    """m: by how much the same place may differ, as files and poses round it."""
    return max(SINGLE * _size(part), was.step, part.step)


def _box(points: Array) -> Array:
    """(6,) least and greatest coordinates of points (n, 3)."""
    return np.concatenate([points.min(axis=0), points.max(axis=0)])


def _shift(was: Part, part: Part) -> Array | None:
    """The displacement of a part that was not turned in the world, whatever frame its mesh is written in, and in
    whatever order; None where the facets are not the same."""
    from scipy.spatial import cKDTree

    assert was.mesh is not None
    assert part.mesh is not None
    one, two = _placed(was), _placed(part)
    if one.shape != two.shape or was.mesh.faces.shape != part.mesh.faces.shape:
        return None
    X = np.eye(4)
    X[:3, 3] = _middle(two) - _middle(one)
    apart, partner = cKDTree(two).query(one + X[:3, 3])
    if apart.max() > _near(was, part) or len(np.unique(partner)) < len(partner):
        return None
    same = np.array_equal(_in_order(partner[was.mesh.faces]), _in_order(part.mesh.faces))
    return X if same else None


def _placed(part: Part) -> Array:
    """(n, 3) m: the vertices in the world."""
    assert part.mesh is not None
    return np.asarray(part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3])


def _in_order(faces: Ints) -> Ints:
    """Facets (m, 3) begun at their least vertex, in the order of their vertices."""
    begun = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return begun[np.lexsort(begun.T[::-1])]


def _rigid(was: Mesh, now: Mesh, near: float) -> Array | None:
    """The displacement that takes a mesh to another of the same facets, in the part frame; None where none does."""
    if was.faces.shape != now.faces.shape or was.vertices.shape != now.vertices.shape:
        return None
    if not np.array_equal(was.faces, now.faces):
        return None
    one, two = was.vertices.mean(axis=0), now.vertices.mean(axis=0)
    left, _, right = np.linalg.svd((was.vertices - one).T @ (now.vertices - two))
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    X = np.eye(4)
    X[:3, :3] = (left @ flip @ right).T
    X[:3, 3] = two - X[:3, :3] @ one
    missed = np.abs(was.vertices @ X[:3, :3].T + X[:3, 3] - now.vertices).max()
    return X if missed <= near else None


def moved(X: Array, was: Part, part: Part, units: str) -> str:
    """ "moved 1 mm along x", "turned 2° about z"; empty where the displacement is rounding."""
    size = _size(part)
    same = was.mesh is None or part.mesh is None or was.mesh.digest == part.mesh.digest
    least = SINGLE * size if same else max(SINGLE * size, was.step, part.step)
    twist = twist_of(X)
    turn = float(np.linalg.norm(twist[:3]))
    place = part.X_WP[:3, 3] if part.mesh is None else _middle_of(part)
    shift = place - (inverse(X)[:3, :3] @ place + inverse(X)[:3, 3])
    far = float(np.linalg.norm(shift))
    if turn * size > least:
        told = f"turned {angle(turn)} about {_along(twist[:3] / turn)}"
        return told + (f", its middle moved {length(far, units)}" if far > least else "")
    return f"moved {length(far, units)} along {_along(shift / far)}" if far > least else ""


def _middle(points: Array) -> Array:
    """(3,) middle of the box of points (n, 3)."""
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _middle_of(part: Part) -> Array:
    assert part.mesh is not None
    low, high = part.mesh.box
    return np.asarray(part.X_WP[:3, :3] @ (0.5 * (low + high)) + part.X_WP[:3, 3])


def _size(part: Part) -> float:
    """m: diagonal of its box, at least so much that a share of it is a length."""
    if part.mesh is None:
        return 1.0
    low, high = part.mesh.box
    return max(float(np.linalg.norm(high - low)), SOLVED)


def _along(unit: Array) -> str:
    """x, -z, or the components."""
    k = int(np.argmax(np.abs(unit)))
    if abs(abs(float(unit[k])) - 1.0) < SINGLE:
        return ("" if unit[k] > 0.0 else "-") + "xyz"[k]
    return direction(np.round(unit, 3))


def reshaped(was: Part, part: Part, X: Array | None, units: str) -> tuple[Literal["part-shape", "part-facets"], str]:
    """The kind of a cause, and its words, of a part with other facets that was displaced by X: by how much its volume,
    its box and its surface differ, along the axes of its frame, or of the world where that is another frame."""
    if was.mesh is None or part.mesh is None:
        return "part-shape", "has a mesh now" if was.mesh is None else "has no mesh any more"
    old, new = was.mesh, part.mesh
    one = _placed(was) if X is None else _placed(was) @ X[:3, :3].T + X[:3, 3]
    apart = _apart(one, old.faces, _placed(part), new.faces)
    if apart is not None and apart <= _near(was, part):
        return "part-facets", "has other facets of the same shape"
    told = []
    if old.health.watertight and new.health.watertight and old.health.volume > 0.0:
        share = 100.0 * (new.health.volume - old.health.volume) / old.health.volume
        # %: smaller differences of volume are told as none, as they would be told as 0.00 %.
        told.append("the same volume" if abs(share) < 0.005 else f"volume {share:+.2g} %")
    before, after = (one, _placed(part)) if X is None else (old.vertices, new.vertices)
    for k, name in enumerate("xyz"):
        grown = float(np.ptp(after[:, k]) - np.ptp(before[:, k]))
        if abs(grown) > _near(was, part):
            told.append(f"{length(abs(grown), units)} {'longer' if grown > 0 else 'shorter'} along {name}")
    if X is not None and old.vertices.shape == new.vertices.shape and np.array_equal(old.faces, new.faces):
        told.append(f"vertices moved by up to {length(float(np.abs(new.vertices - old.vertices).max()), units)}")
    elif apart is not None:
        told.append(f"its surface up to {length(apart, units)} from where it was")
    return "part-shape", "has another shape" + (f": {listed(told)}" if told else "")


def _apart(one: Array, faces_one: Ints, two: Array, faces_two: Ints) -> float | None:
    """m: how far corners and middles of the facets of either of two meshes (n, 3), (m, 3) lie from the other; None
    where there are too many to be measured."""
    low, high = one.min(axis=0), one.max(axis=0)
    unit, worst = max(float(np.linalg.norm(high - low)), TINY), 0.0
    meshes = [((points - low) / unit, faces) for points, faces in ((one, faces_one), (two, faces_two))]
    for (points, faces), (others, of_others) in (meshes, meshes[::-1]):
        found = closest_facets(np.concatenate([points, points[faces].mean(axis=1)]), others[of_others])
        if found is None:
            return None
        worst = max(worst, float(found[0].max(initial=0.0)))
    return unit * worst
