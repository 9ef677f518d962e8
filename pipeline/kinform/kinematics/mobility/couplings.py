"""Couplings: where one contact, or one screw, ties two joints to each other, and in which ratio.

Two bodies that touch along teeth, and that both have a joint of one freedom with a third body, move in a fixed
ratio. It is read out of the motions that all joints together leave: value(a) = ratio · value(b) in every one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.meshes.edges import shared_edges
from kinform.foundation.rounding import SINGLE, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.higher_pairs import is_higher
from kinform.kinematics.joints.pair.touches import TOUCHING
from kinform.kinematics.mobility.teeth import Side, meshing
from kinform.mechanism.first_order import Closure
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Mesh
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Coupling, CouplingKind, Joint, Meshing
from kinform.model.names import BodyName, JointName, PartName

TOOTHED_TURNS = 1.75
"""Full turns of the convex edges of an outline from which on it has teeth. Chosen, not measured."""


ONE_FREEDOM = ("revolute", "prismatic", "screw")
"""Joints of one freedom, whose values a ratio compares."""


def couplings_between(
    assembly: Assembly, graph: JointGraph, patches: Sequence[Patch], closure: Closure
) -> tuple[Coupling, ...]:
    """All couplings of two joints through a higher pair or a screw, in the order of those; `closure` of all joints."""
    joints = graph.joints
    ties = [k for k, joint in enumerate(joints) if joint.type == "screw" or is_higher(joint, patches)]
    if not ties:
        return ()
    rates = closure.sparse_rates
    around: dict[str, list[int]] = {body.name: [] for body in graph.bodies}
    for k, joint in enumerate(joints):
        for name in joint.bodies:
            around[name].append(k)
    out = []
    for k in ties:
        touching = [patches[p] for p in joints[k].patches if patches[p].kind in TOUCHING]
        for a, b in _sides(k, joints, around):
            columns = rates[:, [closure.offset[a], closure.offset[b]]]
            ratio = _ratio(*columns[np.unique(columns.tocoo().row)].toarray().T)
            if ratio is not None:
                out.append(_Tie(assembly, graph.bodies, joints[k], (joints[a], joints[b]), touching, ratio).coupling())
    return tuple(out)


def _sides(through: int, joints: Sequence[Joint], around: Mapping[str, list[int]]) -> list[tuple[int, int]]:
    """Joints of one freedom that join the two bodies of the joint `through` to a common third one, in the order of
    their names."""
    pairs = []
    first, second = joints[through].bodies
    for a in around[first]:
        for b in around[second]:
            thirds = {n for n in joints[a].bodies if n != first} & {n for n in joints[b].bodies if n != second}
            if through not in (a, b) and thirds and all(joints[k].type in ONE_FREEDOM for k in (a, b)):
                pairs.append((a, b) if joints[a].name < joints[b].name else (b, a))
    return sorted(pairs)


def _ratio(a: Array, b: Array) -> float | None:
    """a over b where all motions have one ratio, to the rounding of files, and both move at all."""
    if not len(a):
        return None
    size = np.array([np.abs(a).max(), np.abs(b).max()])
    if (size <= SINGLE * max(np.abs(a).max(initial=0.0), np.abs(b).max(initial=0.0), TINY)).any():
        return None
    _, values, right = np.linalg.svd(np.stack([a / size[0], b / size[1]], axis=1))
    if len(values) > 1 and values[1] > SINGLE * values[0]:
        return None
    return float(right[0, 0] * size[0] / (right[0, 1] * size[1])) if abs(right[0, 1]) > SINGLE else None


def coupling_aside(
    assembly: Assembly, bodies: Sequence[Body], patches: Sequence[Patch], pair: tuple[Joint, Joint]
) -> Coupling | None:
    """The coupling of two joints of one freedom, on one common body, by teeth that touch, where contact between what
    they move is no joint: it constrains nothing, but shows the ratio. None where no teeth touch, or they do not keep a
    ratio that can be counted."""
    common = set(pair[0].bodies) & set(pair[1].bodies)
    if len(common) != 1 or any(joint.type not in ONE_FREEDOM or not len(joint.twists) for joint in pair):
        return None
    names = [next(name for name in joint.bodies if name not in common) for joint in pair]
    sides = [next(body.parts for body in bodies if body.name == name) for name in names]
    touching = [p for p in patches if p.kind in TOUCHING and _joins(p, sides)]
    if not touching:
        return None
    points, normals = (np.concatenate([getattr(p, name) for p in touching]) for name in ("points", "normals"))
    along = []
    for joint, name in zip(pair, names, strict=True):
        twist = joint.twists[0] if joint.bodies[1] == name else -joint.twists[0]
        along.append(((twist[3:] + np.cross(twist[:3], points)) * normals).sum(axis=1))
    ratio = _least_ratio(along[1], along[0])
    if ratio is None:
        return None
    first, second = sorted(names)
    touch = _Touch(JointName(f"{first}~{second}"), (first, second))
    coupling = _Tie(assembly, bodies, touch, pair, touching, ratio).coupling()
    return coupling if coupling.meshing is not None else None


@dataclass(frozen=True)
class _Touch:
    """Contact that is no joint."""

    name: JointName
    bodies: tuple[BodyName, BodyName]
    type: str = "general"
    status: str = "determined"


def _joins(patch: Patch, sides: Sequence[Sequence[PartName]]) -> bool:
    first, second = patch.parts
    return (first in sides[0] and second in sides[1]) or (first in sides[1] and second in sides[0])


def _least_ratio(a: Array, b: Array) -> float | None:
    """a over b by least squares; None where one of them is nought."""
    size = float(b @ b)
    return float(a @ b) / size if size > 0.0 and np.any(a) else None


@dataclass(frozen=True, eq=False)
class _Tie:
    """Two joints of one freedom, and what ties them: a screw, or a contact between the two bodies that they move."""

    assembly: Assembly
    bodies: Sequence[Body]
    through: Joint | _Touch
    pair: tuple[Joint, Joint]
    touching: Sequence[Patch]
    """Points and lines of the contact."""
    ratio: float
    """value(first) / value(second), at this pose."""

    def coupling(self) -> Coupling:
        """All of it as a result."""
        teeth = "" if self.through.type == "screw" else self._meshing()
        # teeth whose ratio is shown not to be constant are cams
        uneven = isinstance(teeth, str) and bool(teeth)
        unsure = any(joint.status in ("ambiguous", "blocked") for joint in (self.through, *self.pair))
        return Coupling(
            joints=(self.pair[0].name, self.pair[1].name),
            ratio=self.ratio,
            kind="cam" if uneven else self._kind(),
            through=self.through.name,
            status="ambiguous" if unsure else "determined",
            uncertainty=self._uncertainty(),
            reason=teeth if isinstance(teeth, str) else "",
            meshing=None if isinstance(teeth, str) else teeth,
        )

    def _meshing(self) -> Meshing | str:
        """What the teeth do beyond this pose; "" where they cannot be looked at."""
        touch = self.touching[0]
        if not np.any(touch.axis):
            return ""
        sides = []
        for joint in self.pair:
            body = self._body(joint)
            (part,) = (self.assembly.part(name) for name in touch.parts if name in body.parts)
            if part.mesh is None or joint.type == "screw":
                return ""
            # values are of the joint's second body relative to its first
            twist = joint.twists[0] if joint.bodies[1] == body.name else -joint.twists[0]
            sides.append(Side(part.mesh, part.X_WP, twist))
        into = touch.normals[0] if touch.parts[0] in self._body(self.pair[0]).parts else -touch.normals[0]
        middle = 0.5 * (touch.points.min(axis=0) + touch.points.max(axis=0))
        return meshing((sides[0], sides[1]), touch.axis, middle, into, self.ratio)

    def _body(self, joint: Joint) -> Body:
        """The body that the joint moves."""
        return next(b for b in self.bodies if b.name in joint.bodies and b.name in self.through.bodies)

    def _uncertainty(self) -> float:
        """Of the ratio, from that of the normals and places of the best known contact; nan for screws."""
        best = np.nan
        for patch in self.touching:
            point, normal = patch.points.mean(axis=0), patch.normals[0]
            total = 0.0
            for joint in self.pair:
                twist = joint.twists[0]
                velocity = twist[3:] + cross(twist[:3], point)
                along = abs(float(velocity @ normal))
                aside = norm(velocity - normal * float(velocity @ normal))
                off = patch.uncertainty[0] * aside + patch.uncertainty[1] * norm(twist[:3])
                total += off / max(along, TINY)
            best = np.nanmin([best, abs(self.ratio) * total])
        return float(best)

    def _kind(self) -> CouplingKind:
        """gear, rack, screw or cam: what the designer would call it."""
        if self.through.type == "screw":
            return "screw"
        touch = self.touching[0]
        toothed = np.any(touch.axis) and all(
            convex_turns(mesh, part.X_WP, touch.axis, touch.point) >= TOOTHED_TURNS
            for part in (self.assembly.part(name) for name in touch.parts)
            if (mesh := part.mesh) is not None
        )
        if not toothed:
            return "cam"
        return "rack" if any(joint.type == "prismatic" for joint in self.pair) else "gear"


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
    normals /= np.maximum(np.linalg.norm(normals, axis=1), TINY)[:, None]
    edges = shared_edges(faces, len(height), by_corner=True)
    above = height[edges.ends] > 0.0
    edges = edges.where(edges.opposed & (above[:, 0] != above[:, 1]))
    first, second = normals[edges.facets].transpose(1, 0, 2)
    angle = np.arccos(np.clip(np.einsum("ij,ij->i", first, second), -1.0, 1.0))
    return float(angle[edges.convexity(mesh.vertices, first, second) > 0.0].sum()) / (2.0 * np.pi)
