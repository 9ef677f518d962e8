"""What witnesses are made of: contact that pushes or opens, parts in each other at a pose, guides, freedoms."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np

from kinform.consistency.context import Context
from kinform.foundation.algebra.displacements import twist_of
from kinform.foundation.algebra.vectors import cross, dot
from kinform.function.configurations import Chain, chain_between
from kinform.function.holding import configuration_at
from kinform.kinematics.mobility.guides import joint_twist, preserved, span_along
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.findings import PUSHES_MOST, Witness, between, computed
from kinform.model.kinematics import Body, Joint
from kinform.model.names import PartName

SAMPLES_MOST = 300
"""Samples of contact that a witness holds: those of a few patches; of more, every second, third, …"""
CLOSES = 1e-2
"""Share of the fastest speed at which contact may close and counts as kept: normals of surfaces that were recovered
from meshes are off by as much."""
BEYOND = (0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Shares of the way from a stop to where it should be at which an overlap is looked for."""
BEYOND_FREE = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
"""rad, or shares of the assembly's size, beyond a stop of a side that should be free."""


def pushing(patches: Sequence[Patch], free: Collection[str]) -> Witness | None:
    """Pushes at contacts on the `free` side that balance each other, so that no motion opens all."""
    from scipy.optimize import nnls

    points, normals = _samples(patches, free)
    if not len(points):
        return None
    middle = points.mean(axis=0)
    reach = float(np.linalg.norm(points - middle, axis=1).max()) or 1.0
    rows = np.concatenate([cross((points - middle) / reach, normals), normals], axis=1)
    pushes, _ = nnls(np.concatenate([rows.T, np.ones((1, len(rows)))]), np.array([0.0] * 6 + [1.0]))
    used = pushes > 0.0
    left = float(np.abs(pushes @ rows).sum())
    share = min(float(pushes.sum()) / left if left > 0.0 else math.inf, PUSHES_MOST)
    return computed(
        "balanced pushes", share, PUSHED, points=points[used], normals=normals[used], pushes=pushes[used],
        middle=middle, reach=reach,
    )  # fmt: skip


PUSHED = 1e3
"""Pushes over the wrench that they leave, from which on no motion opens them all (`free_links.OPENS`)."""


def opening(
    context: Context, first: Collection[str], second: Collection[str], found: Array, meant: Array,
    loose: Sequence[Collection[str]] = (),
) -> Witness | None:  # fmt: skip
    """A motion of the second side that is none of the meant ones (k, 6), and that no contact between the two, or with
    `loose` bodies between them, stops; else one of the meant that contact stops in one sense only."""
    sides = [frozenset(map(str, names)) for names in (first, *loose, second)]
    of = {name: k for k, names in enumerate(sides) for name in names}
    patches = [p for p in context.contacts.patches if of.get(p.parts[0], -1) != of.get(p.parts[1], -1)
               and p.parts[0] in of and p.parts[1] in of and not p.unknown]  # fmt: skip
    if not patches:
        return None
    points = np.concatenate([patch.points for patch in patches])
    normals = np.concatenate([patch.normals for patch in patches])
    bodies = np.array([[of[a] for a in patch.parts] for patch in patches for _ in patch.points])
    some = slice(None, None, -(-len(points) // SAMPLES_MOST))
    points, normals, bodies = points[some], normals[some], bodies[some]
    middle = points.mean(axis=0)
    reach = float(np.linalg.norm(points - middle, axis=1).max()) or 1.0
    more = [sense * twist for twist in _beyond(found, meant, middle, reach) for sense in (1.0, -1.0)]
    tried = [(twist, meant) for twist in more]
    tried += [(sense * twist, np.zeros((0, 6))) for twist in meant for sense in (1.0, -1.0)]
    for twist, other in tried:
        twists = _with_loose(points, normals, bodies, twist, len(sides))
        speed = np.concatenate([(twists[bodies[:, 1]] - twists[bodies[:, 0]])], axis=1)
        size = float(np.linalg.norm(np.r_[twist[:3] * reach, twist[3:] + cross(twist[:3], middle)]))
        opens = dot(normals, speed[:, 3:] + cross(speed[:, :3], points)) / size
        if size > 0.0 and float(opens.min()) > -CLOSES:
            return computed(
                "motion that opens", float(opens.min()), -CLOSES, points=points, normals=normals, bodies=bodies,
                twists=twists, meant=other, middle=middle, reach=reach,
            )  # fmt: skip
    return None


def _beyond(found: Array, meant: Array, middle: Array, reach: float) -> Iterator[Array]:
    """Found motions (k, 6) without their share in the meant ones, the largest first."""

    def scaled(twists: Array) -> Array:
        twists = twists.reshape(-1, 6)
        return np.concatenate([twists[:, :3] * reach, twists[:, 3:] + cross(twists[:, :3], middle)], axis=1)

    basis = np.linalg.svd(scaled(meant))[2][: len(meant)] if len(meant) else np.zeros((0, 6))
    rest = scaled(found) - scaled(found) @ basis.T @ basis
    sizes = np.linalg.norm(rest, axis=1)
    for k in np.argsort(-sizes, kind="stable"):
        if sizes[k] > 1e-2 * max(1.0, float(sizes.max())):
            omega = rest[k, :3] / reach
            yield np.concatenate([omega, rest[k, 3:] - cross(omega, middle)]) / sizes[k]


def _with_loose(points: Array, normals: Array, bodies: Array, twist: Array, count: int) -> Array:
    """(count, 6) twists of the first side at rest, of loose bodies as contact takes them along, and of the second."""
    twists = np.zeros((count, 6))
    twists[-1] = twist
    if count > 2:
        rows = np.concatenate([cross(points, normals), normals], axis=1)
        matrix = np.zeros((len(rows), count, 6))
        at = np.arange(len(rows))
        matrix[at, bodies[:, 1]] += rows
        matrix[at, bodies[:, 0]] -= rows
        inner = matrix[:, 1:-1].reshape(len(rows), -1)
        twists[1:-1] = np.linalg.lstsq(inner, -matrix[:, -1] @ twist, rcond=1e-9)[0].reshape(-1, 6)
    return twists


def _samples(patches: Sequence[Patch], free: Collection[str]) -> tuple[Array, Array]:
    """Points (n, 3), and normals (n, 3) in which the free side opens."""
    points = np.concatenate([patch.points for patch in patches])
    senses = [1.0 if patch.parts[1] in free else -1.0 for patch in patches]
    return points, np.concatenate([s * patch.normals for s, patch in zip(senses, patches, strict=True)])


def in_each_other(context: Context, pair: Sequence[str], displacements: Iterable[Array]) -> Witness | None:
    """The first pose at which two parts are in each other, the second displaced (4, 4) relative to the first."""
    if context.blocked_joints is None or len(pair) != 2:
        return None
    (one, other), steps = map(str, pair), context.blocked_joints.steps
    both = min(one, other), max(one, other)
    counts = steps.counts(both) if both in steps.patches or both in steps.drawn else 0.0
    for X in displacements:
        overlap = steps.overlap(one, other, X)
        if overlap is not None and overlap.depth > counts:
            return between([one], [other], -overlap.depth, moved=twist_of(X), volume=overlap.volume)
    return None


def beyond_stop(context: Context, joint: Joint, parts: Sequence[str], value: float, stated: float) -> Witness | None:
    """That two parts are in each other where a joint has gone beyond the stop at a value (rad or m, kinform's sense)
    towards one that is stated."""
    if len(parts) != 2:
        return None
    first, second = (context.kinematics.body_of(name) for name in (PartName(part) for part in parts))
    chain = chain_between(context.assembly, context.kinematics, first.name, second.name)
    if isinstance(chain, str):
        return None
    far = math.isfinite(stated)
    unit = 1.0 if joint.type != "prismatic" else chain.frame.length
    steps = [share * (stated - value) for share in BEYOND] if far else [
        math.copysign(share * unit, stated) for share in BEYOND_FREE
    ]  # fmt: skip
    return in_each_other(context, parts, _poses(chain, joint, first, second, [value + step for step in steps]))


def _poses(chain: Chain, joint: Joint, first: Body, second: Body, values: Sequence[float]) -> Iterator[Array]:
    """Displacements (4, 4) of the second body relative to the first, where a joint has these values."""
    for value in values:
        q = configuration_at(chain, {str(joint.name): value})
        if isinstance(q, str):
            continue
        poses = chain.linkage.world(chain.system.bodies(q[None])[0])
        yield np.asarray(np.linalg.inv(poses[chain.index(first.name)]) @ poses[chain.index(second.name)])


def beyond_guide(context: Context, joint: Joint, value: float) -> Witness | None:
    """That a slider at a value (m, or rad of a screw; kinform's sense) has left all the surfaces that guide it."""
    if joint.axis is None or context.lacks("contacts") is not None:
        return None
    rate = {"screw": (joint.pitch or 0.0) / (2.0 * math.pi)}.get(joint.type, 1.0)
    sliding = joint_twist(joint) if joint.type == "screw" else np.r_[np.zeros(3), joint.axis]
    second = {str(name) for name in context.kinematics.named_bodies[joint.bodies[1]].parts}
    rows, parts = [], []
    for k in joint.patches:
        patch = context.contacts.patches[k]
        if not preserved(patch, sliding[None]):
            continue
        spans = {
            name: span_along(context.assembly, context.design.surfaces, name, surface, joint.axis)
            for name, surface in zip(patch.parts, patch.surfaces, strict=True)
        }
        rests, moves = sorted(spans, key=lambda name: str(name) in second)
        a, b = spans[rests], spans[moves]
        if a is not None and b is not None:
            rows.append((*a, *b))
            parts += [str(rests), str(moves)]
    if not rows:
        return None
    slid = rate * value
    left = min(max(low + slid - b, a - high - slid) for a, b, low, high in rows)
    return computed("end of a guide", left, 0.0, parts=parts, axis=joint.axis, spans=rows, slid=slid)


def freedoms(
    bodies: Sequence[Body], joints: Sequence[Joint], effective: int, idle: int, lost: int, ends: tuple[int, int],
    meant: int,
) -> Witness | None:  # fmt: skip
    """That the joints of some bodies leave other freedoms than are meant: `effective`, without `idle` ones and those
    that are `lost` over a distance, and other than both ends."""
    graph = JointGraph(tuple(bodies), tuple(joints))
    off = min(abs(count - meant) for count in (effective, *ends))
    twists = np.concatenate([np.zeros((0, 6)), *graph.spaces])
    return computed(
        "freedoms of a graph", off, 0.0, bodies=len(bodies), ground=graph.ground, edges=graph.edges,
        counts=[len(space) for space in graph.spaces], twists=twists, idle=idle, lost=lost, ends=ends, meant=meant,
    )  # fmt: skip
