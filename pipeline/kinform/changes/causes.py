"""What was done to the parts between two designs, and which changes of behaviour follow from it.

A part is moved by its pose, or by the same mesh written elsewhere: both are one displacement in the world. What
was not turned in the world is known again though its frame is another, as after a way through another format. Where the
mesh is another, its volume and its box say how much. A change follows from the parts that it is about; what is about
no changed part, as the mobility, follows from all of them together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinform.changes import constants
from kinform.changes.behaviours import Snapshot
from kinform.changes.change import Change
from kinform.changes.matching import new_names
from kinform.design import Design
from kinform.foundation.algebra.displacements import inverse, twist_of
from kinform.foundation.words import angle, direction, length, listed, number
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Assembly, Mesh, Part


@dataclass(frozen=True, eq=False)
class Cause:
    """What was done to one part."""

    kind: str
    """part-moved, part-shape, part-material, part-new or part-gone."""
    part: str
    """By its name now, or as it was where it is gone."""
    message: str
    """Without the part: "moved 1 mm along x"."""
    X: Array | None = None
    """(4, 4) displacement in the world from before to after; None where it did not move."""


@dataclass(frozen=True, eq=False)
class Consequences:
    """What follows from the same causes."""

    causes: tuple[Cause, ...]
    """Empty: no part that was changed is concerned."""
    changes: tuple[Change, ...]


def causes_of(before: Design, after: Design, old: Snapshot, new: Snapshot) -> tuple[Cause, ...]:
    """What was done to each part, in the order of the parts after, then those that are gone; `old` and `new` are the
    behaviours of the two designs."""
    renamed = {name: was for was, name in new_names(old, new).items()}
    known = {str(part.name): part for part in before.assembly.parts}
    out, seen = [], set()
    for part in after.assembly.parts:
        was = known.get(renamed.get(str(part.name), str(part.name)))
        if was is None:
            out.append(Cause("part-new", str(part.name), "is new"))
        else:
            seen.add(str(was.name))
            out += _of_part(was, part, after.assembly)
    return (*out, *(Cause("part-gone", name, "is gone") for name in known if name not in seen))


def grouped(
    changes: Sequence[Change], causes: Sequence[Cause], before: Snapshot, after: Snapshot
) -> list[Consequences]:
    """Changes by the causes that they follow from, in the order of the causes; those of the whole, then those of no
    cause, are last. Without causes all are in one group."""
    groups: dict[tuple[str, ...], list[Change]] = {}
    changed = list(dict.fromkeys(cause.part for cause in causes))
    for cause in changed:
        groups[cause,] = []
    of_name = {**_parts_of_names(before), **_parts_of_names(after)}
    for change in changes:
        concerned = {part for name in change.subject for part in of_name.get(name, (name,))}
        of_whole = change.kind in constants.OF_THE_WHOLE
        key = tuple(changed) if of_whole else tuple(part for part in changed if part in concerned)
        groups.setdefault(key, []).append(change)
    order = sorted(groups, key=lambda key: (not key, len(key) > 1, len(key), [changed.index(part) for part in key]))
    return [Consequences(tuple(c for c in causes if c.part in key), tuple(groups[key])) for key in order]


def _parts_of_names(side: Snapshot) -> dict[str, tuple[str, ...]]:
    """The parts that bodies and joints are of."""
    bodies = dict(side.bodies or ())
    joints = {joint.name: tuple(p for b in joint.bodies for p in bodies.get(b, ())) for joint in side.joints or ()}
    return {**joints, **bodies}


def _of_part(was: Part, part: Part, assembly: Assembly) -> list[Cause]:
    """What was done to a part that is in both."""
    name, units, out = str(part.name), assembly.units, []
    X, same = _displacement(was, part)
    if X is not None:
        told = _moved(X, part, units)
        if told:
            out.append(Cause("part-moved", name, told, X))
    if not same:
        out.append(Cause("part-shape", name, _shape(was.mesh, part.mesh, units)))
    if (was.material, was.density) != (part.material, part.density):
        one, two = (_material(item) for item in (was, part))
        out.append(Cause("part-material", name, f"material {one} → {two}"))
    return out


def _displacement(was: Part, part: Part) -> tuple[Array | None, bool]:
    """The displacement of a part in the world, and whether its shape is the same."""
    X = part.X_WP @ inverse(was.X_WP)
    if was.mesh is None or part.mesh is None:
        return X, was.mesh is part.mesh
    if was.mesh.digest == part.mesh.digest:
        return X, True
    within = _rigid(was.mesh, part.mesh)
    if within is not None:
        return part.X_WP @ within @ inverse(was.X_WP), True
    shift = _shift(was, part)
    return (X, False) if shift is None else (shift, True)


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
    if apart.max() > constants.SAME_SHAPE * _size(part) or len(np.unique(partner)) < len(partner):
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


def _rigid(was: Mesh, now: Mesh) -> Array | None:
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
    return X if missed <= constants.SAME_SHAPE * float(np.ptp(now.vertices, axis=0).max()) else None


def _moved(X: Array, part: Part, units: str) -> str:
    """ "moved 1 mm along x", "turned 2° about z"; empty where the displacement is rounding."""
    size = _size(part)
    twist = twist_of(X)
    turn = float(np.linalg.norm(twist[:3]))
    if turn * size > constants.SAME_PLACE * size:
        told = f"turned {angle(turn)} about {_along(twist[:3] / turn)}"
        place = part.X_WP[:3, 3] if part.mesh is None else _middle_of(part)
        shift = place - (inverse(X)[:3, :3] @ place + inverse(X)[:3, 3])
        far = float(np.linalg.norm(shift))
        return told + (f", its middle moved {length(far, units)}" if far > constants.SAME_PLACE * size else "")
    shift = X[:3, 3]
    far = float(np.linalg.norm(shift))
    return f"moved {length(far, units)} along {_along(shift / far)}" if far > constants.SAME_PLACE * size else ""


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
    return max(float(np.linalg.norm(high - low)), 1e-9)


def _along(unit: Array) -> str:
    """x, -z, or the components."""
    k = int(np.argmax(np.abs(unit)))
    if abs(abs(float(unit[k])) - 1.0) < constants.ALONG:
        return ("" if unit[k] > 0.0 else "-") + "xyz"[k]
    return direction(np.round(unit, 3))


def _shape(was: Mesh | None, now: Mesh | None, units: str) -> str:
    """Another mesh: by how much its volume and its box differ."""
    if was is None or now is None:
        return "has a mesh now" if was is None else "has no mesh any more"
    told = []
    one, two = was.health.volume, now.health.volume
    if was.health.watertight and now.health.watertight and one > 0.0:
        share = 100.0 * (two - one) / one
        told.append("the same volume" if abs(share) < constants.SAME_VOLUME else f"volume {share:+.2g} %")
    for k, name in enumerate("xyz"):
        grown = float(np.subtract(*now.box[::-1])[k] - np.subtract(*was.box[::-1])[k])
        if abs(grown) > constants.SAME_SHAPE * float(np.ptp(now.vertices, axis=0).max()):
            told.append(f"{length(abs(grown), units)} {'longer' if grown > 0 else 'shorter'} along {name}")
    if was.vertices.shape == now.vertices.shape and np.array_equal(was.faces, now.faces):
        told.append(f"vertices moved by up to {length(float(np.abs(now.vertices - was.vertices).max()), units)}")
    return "has another shape" + (f": {listed(told)}" if told else "")


def _material(part: Part) -> str:
    if part.material is not None:
        return part.material
    return "none" if part.density is None else f"{number(part.density)} kg/m³"
