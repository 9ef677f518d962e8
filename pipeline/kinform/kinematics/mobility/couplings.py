"""Couplings: where one contact, or one screw, ties two joints to each other, and in which ratio.

Two bodies that touch along teeth, and that both have a joint of one freedom with a third body, move in a fixed
ratio. It is read out of the motions that all joints together leave: value(a) = ratio · value(b) in every one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.edges import shared_edges
from kinform.kinematics.bodies.higher_pairs import is_higher
from kinform.kinematics.mobility.closure import Closure
from kinform.kinematics.mobility.teeth import Side, meshing
from kinform.kinematics.pair.certainty import TOUCHING
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Mesh
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Coupling, Joint, Meshing

__all__ = ["convex_turns", "couplings"]


SINGLE = ("revolute", "prismatic", "screw")
"""Joints of one freedom, whose values a ratio compares."""
FIXED = 1e-6
"""Relative: rates that keep their ratio to this are coupled."""
TOOTHED = 1.75
"""Full turns of the convex edges of an outline from which on it has teeth."""


def couplings(
    assembly: Assembly,
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    patches: Sequence[Patch],
    closure: Closure,
) -> tuple[Coupling, ...]:
    """All couplings of two joints through a higher pair or a screw, in the order of those; `closure` of all joints."""
    ties = [k for k, joint in enumerate(joints) if joint.type == "screw" or is_higher(joint, patches)]
    if not ties:
        return ()
    rates = closure.sparse_rates
    around: dict[str, list[int]] = {body.name: [] for body in bodies}
    for k, joint in enumerate(joints):
        for name in joint.bodies:
            around[name].append(k)
    out = []
    for k in ties:
        through = joints[k]
        for a, b in _sides(through, joints, around, k):
            columns = rates[:, [closure.offset[a], closure.offset[b]]].tocoo()
            moving = np.unique(columns.row)
            found = _ratio(*rates[moving][:, [closure.offset[a], closure.offset[b]]].toarray().T)
            if found is not None:
                pair = (joints[a], joints[b])
                unsure = any(j.status in ("ambiguous", "blocked") for j in (through, *pair))
                teeth = "" if through.type == "screw" else _meshing(assembly, bodies, through, pair, patches, found)
                # teeth whose ratio is shown not to be constant are cams
                uneven = isinstance(teeth, str) and bool(teeth)
                out.append(
                    Coupling(
                        joints=(pair[0].name, pair[1].name),
                        ratio=found,
                        kind="cam" if uneven else _kind(assembly, through, pair, patches),
                        through=through.name,
                        status="ambiguous" if unsure else "determined",
                        uncertainty=_uncertainty(found, through, pair, patches),
                        reason=teeth if isinstance(teeth, str) else "",
                        meshing=None if isinstance(teeth, str) else teeth,
                    )
                )
    return tuple(out)


def _sides(through: Joint, joints: Sequence[Joint], around: Mapping[str, list[int]], own: int) -> list[tuple[int, int]]:
    """Joints of one freedom that join the two bodies of `through` to a common third one, in the order of their names."""
    found = []
    first, second = through.bodies
    for a in around[first]:
        for b in around[second]:
            thirds = {n for n in joints[a].bodies if n != first} & {n for n in joints[b].bodies if n != second}
            if own not in (a, b) and thirds and all(joints[k].type in SINGLE for k in (a, b)):
                found.append((a, b) if joints[a].name < joints[b].name else (b, a))
    return sorted(found)


def _ratio(a: Array, b: Array) -> float | None:
    """a over b where all motions have one ratio, and both move at all."""
    if not len(a):
        return None
    size = np.array([np.abs(a).max(), np.abs(b).max()])
    if (size <= FIXED * max(np.abs(a).max(initial=0.0), np.abs(b).max(initial=0.0), 1e-300)).any():
        return None
    _, values, right = np.linalg.svd(np.stack([a / size[0], b / size[1]], axis=1))
    if len(values) > 1 and values[1] > FIXED * values[0]:
        return None
    return float(right[0, 0] * size[0] / (right[0, 1] * size[1])) if abs(right[0, 1]) > FIXED else None


def _meshing(
    assembly: Assembly,
    bodies: Sequence[Body],
    through: Joint,
    pair: tuple[Joint, Joint],
    patches: Sequence[Patch],
    ratio: float,
) -> Meshing | str:
    """What the teeth do beyond this pose; "" where they cannot be looked at."""
    touch = next(patches[k] for k in through.patches if patches[k].kind in TOUCHING)
    if not np.any(touch.axis):
        return ""
    sides = []
    for joint in pair:
        (body,) = (b for b in bodies if b.name in joint.bodies and b.name in through.bodies)
        (part,) = (assembly.part(name) for name in touch.parts if name in body.parts)
        if part.mesh is None or joint.type == "screw":
            return ""
        # values are of the joint's second body relative to its first
        sides.append(Side(part.mesh, part.X_WP, joint.twists[0] if joint.bodies[1] == body.name else -joint.twists[0]))
    into = touch.normals[0]
    if touch.parts[0] not in next(b for b in bodies if b.name in pair[0].bodies and b.name in through.bodies).parts:
        into = -into
    middle = 0.5 * (touch.points.min(axis=0) + touch.points.max(axis=0))
    return meshing((sides[0], sides[1]), touch.axis, middle, into, ratio)


def _uncertainty(ratio: float, through: Joint, pair: tuple[Joint, Joint], patches: Sequence[Patch]) -> float:
    """Of the ratio, from that of the normals and places of the best known contact; nan for screws."""
    best = np.nan
    for patch in (patches[k] for k in through.patches if patches[k].kind in TOUCHING):
        point, normal = patch.points.mean(axis=0), patch.normals[0]
        total = 0.0
        for joint in pair:
            twist = joint.twists[0]
            velocity = twist[3:] + cross(twist[:3], point)
            along = abs(float(velocity @ normal))
            aside = float(np.linalg.norm(velocity - normal * float(velocity @ normal)))
            off = patch.uncertainty[0] * aside + patch.uncertainty[1] * float(np.linalg.norm(twist[:3]))
            total += off / max(along, 1e-300)
        best = np.nanmin([best, abs(ratio) * total])
    return float(best)


def _kind(
    assembly: Assembly,
    through: Joint,
    pair: tuple[Joint, Joint],
    patches: Sequence[Patch],
) -> str:
    """gear, rack, screw or cam: what the designer would call it."""
    if through.type == "screw":
        return "screw"
    touch = next(patches[k] for k in through.patches if patches[k].kind in TOUCHING)
    toothed = np.any(touch.axis) and all(
        convex_turns(mesh, part.X_WP, touch.axis, touch.point) >= TOOTHED
        for part in (assembly.part(name) for name in touch.parts)
        if (mesh := part.mesh) is not None
    )
    if not toothed:
        return "cam"
    return "rack" if any(joint.type == "prismatic" for joint in pair) else "gear"


def convex_turns(mesh: Mesh, X_WP: Array, axis: Array, point: Array) -> float:
    """How many full turns the convex edges of a mesh make, where it is cut by the plane across `axis` (world) at
    `point`: one for a convex outline, a third or more for each tooth."""
    direction = X_WP[:3, :3].T @ axis
    height = (mesh.vertices @ direction) - float((X_WP[:3, :3].T @ (point - X_WP[:3, 3])) @ direction)
    faces = mesh.faces
    side = height[faces] > 0.0
    faces = faces[side.any(axis=1) & ~side.all(axis=1)]
    corners = mesh.vertices[faces]
    normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    edges = shared_edges(faces, len(height), by_corner=True)
    above = height[edges.ends] > 0.0
    edges = edges.where(edges.opposed & (above[:, 0] != above[:, 1]))
    one, two = normals[edges.facets].transpose(1, 0, 2)
    angle = np.arccos(np.clip(np.einsum("ij,ij->i", one, two), -1.0, 1.0))
    return float(angle[edges.convexity(mesh.vertices, one, two) > 0.0].sum()) / (2.0 * np.pi)
