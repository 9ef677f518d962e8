"""Higher pairs in loops: teeth and cams whose rows are made exactly consistent with the joints around them.

Several pairs of teeth in contact say one thing only, and shafts are parallel only within the uncertainty of
their fits; taken at their word such rows would lock a gear pair. So the motions that the other joints leave
are held against the rows of all points and lines: those that the rows preserve within their uncertainty are
kept, and the spaces of the higher pairs are turned until they contain them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.touches import TOUCHING, meets
from kinform.kinematics.screws.canonical_basis import canonical_twists
from kinform.mechanism.constants import SIGMAS
from kinform.mechanism.first_order import body_twists
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Joint

MOST_TURNED = 0.1
"""Share of a motion that may lie outside the space of a pair that nearly contains it: up to the alignment the space is
turned, beyond it the pair is ambiguous. Of the fixtures and twelve robots none is turned by more than 1e-14."""


def is_higher(joint: Joint, patches: Sequence[Patch]) -> bool:
    """Whether the joint is `general` and carried by points and lines, beside planes across them."""
    return joint.type == "general" and bool(joint.patches) and meets([patches[k] for k in joint.patches])


@dataclass(frozen=True, eq=False)
class _Pair:
    """One higher pair that closes a loop of other joints."""

    index: int
    relative: Array
    """(m, 6) twist of its second body relative to its first, for each motion that the other joints leave."""
    frame: Frame
    rows: Array
    """(n, m) velocity along the normal at each sample, for each motion."""
    slip: Array
    """(n, m, 3) velocity at each sample."""
    angle: Array
    """(n,) rad, and m: uncertainty of the normal and of the place."""
    position: Array


def align_higher_pairs(graph: JointGraph, patches: Sequence[Patch], size: float, alignment: float) -> tuple[Joint, ...]:
    """The joints, with the twists of higher pairs that close loops made consistent.

    `size` of the assembly (m); `alignment` (rad): the angle up to which axes count as parallel.
    """
    joints = list(graph.joints)
    higher = [k for k, joint in enumerate(joints) if is_higher(joint, patches) and joint.status == "determined"]
    if not higher:
        return graph.joints
    others = JointGraph(graph.bodies, tuple(joint for k, joint in enumerate(joints) if k not in set(higher)))
    closure = others.close(size)
    twists = body_twists(closure, others.edges, others.spaces)
    pairs = []
    for k in higher:
        a, b = graph.edges[k]
        if closure.tree.root[a] == closure.tree.root[b] and len(twists):
            touching = [patches[p] for p in joints[k].patches if patches[p].kind in TOUCHING]
            pairs.append(_pair(k, graph.bodies[a], twists[:, b] - twists[:, a], touching, alignment))
    for group, motions in _groups(pairs, len(twists)):
        preserved, doubt = _preserved_motions([pairs[g] for g in group], motions)
        for pair in (pairs[g] for g in group):
            if doubt:
                joints[pair.index] = replace(joints[pair.index], status="ambiguous", reason=doubt)
            elif len(preserved):
                relative = preserved @ pair.relative[motions]
                joints[pair.index] = _turn_space(joints[pair.index], relative, pair.frame, alignment)
    return tuple(joints)


def _pair(index: int, first: Body, relative: Array, touching: Sequence[Patch], alignment: float) -> _Pair:
    """The joint of this index, whose first body is `first`, with its patches along points and lines."""
    points = np.concatenate([p.points for p in touching])
    normals = np.concatenate([p.normals if p.parts[0] in first.parts else -p.normals for p in touching])
    counts = [len(p.points) for p in touching]
    slip = relative[None, :, 3:] + cross(relative[None, :, :3], points[:, None])
    return _Pair(
        index=index,
        relative=relative,
        frame=Frame.of(points),
        rows=np.einsum("nmk,nk->nm", slip, normals),
        slip=slip,
        angle=np.repeat([alignment + SIGMAS * p.uncertainty[0] for p in touching], counts),
        position=np.repeat([SIGMAS * p.uncertainty[1] + p.chord for p in touching], counts),
    )


def _groups(pairs: Sequence[_Pair], count: int) -> list[tuple[list[int], list[int]]]:
    """Pairs and the motions that concern them, apart where they have nothing to do with each other."""
    sets = UnionFind(len(pairs) + count)
    for g, pair in enumerate(pairs):
        speed = np.linalg.norm(pair.slip, axis=2).max(axis=0) if len(pair.slip) else np.zeros(count)
        turn = pair.frame.length * np.linalg.norm(pair.relative[:, :3], axis=1)
        size = speed + turn
        for motion in np.flatnonzero(size > SOLVED * max(float(size.max(initial=0.0)), TINY)).tolist():
            sets.union(g, len(pairs) + motion)
    out: dict[int, tuple[list[int], list[int]]] = {}
    for g in range(len(pairs)):
        out.setdefault(sets.find(g), ([], []))[0].append(g)
    for m in range(count):
        root = sets.find(len(pairs) + m)
        if root in out:
            out[root][1].append(m)
    return list(out.values())


def _preserved_motions(pairs: Sequence[_Pair], motions: list[int]) -> tuple[Array, str]:
    """(r, motions) combinations that all rows preserve within their uncertainty, and what is doubtful about that.

    Combinations are tried in the order of their singular values, the best preserved first, up to the first that some
    row misses by more than its uncertainty allows.
    """
    rows = np.concatenate([pair.rows[:, motions] for pair in pairs])
    slip = np.concatenate([pair.slip[:, motions] for pair in pairs])
    speed = np.maximum(np.linalg.norm(slip, axis=2).max(axis=0), TINY)
    _, values, right = np.linalg.svd(rows / speed)
    misses = np.concatenate([values, np.zeros(len(motions) - len(values))])
    kept = np.zeros((0, len(motions)))
    for combination, miss in zip(right[::-1] / speed, misses[::-1], strict=True):
        share = 0.0
        for pair in pairs:
            relative = combination @ pair.relative[motions]
            velocity = np.linalg.norm(combination @ pair.slip[:, motions], axis=1)
            allowed = pair.angle * velocity + pair.position * norm(relative[:3])
            missed = np.abs(pair.rows[:, motions] @ combination)
            share = max(share, float((missed / np.maximum(allowed, TINY)).max()) if missed.max() > 0.0 else 0.0)
        if share > 1.0:
            # A motion that the rows miss by less than this many times what is allowed is doubtful.
            if share < 3.0:
                return kept, "teeth or cams hold a motion by hardly more than their uncertainty"
            nearly = f"teeth or cams leave a motion of the joints around them but for {100.0 * miss / misses[0]:.2g} %"
            # Share of what rows hold of other motions below which holding one is doubtful: chamfers and reliefs of
            # teeth lean by degrees more than their facets show. Two flanks of a pinion in a ring with chamfered tips
            # disagreed by 0.5 %.
            return kept, nearly if miss < 0.02 * misses[0] else ""
        kept = np.vstack([kept, combination])
    return kept, ""


def _turn_space(joint: Joint, motions: Array, frame: Frame, alignment: float) -> Joint:
    """The joint with its space (f, 6) turned to contain the relative motions (r, 6), where it does within the alignment
    (rad); ambiguous where it nearly does."""
    wanted = span(scaled(motions.T, frame)) if np.any(motions) else np.zeros((6, 0))
    space = span(scaled(joint.twists.T, frame))
    outside = wanted - space @ (space.T @ wanted)
    missed = float(np.abs(outside).max(initial=0.0))
    if wanted.shape[1] == 0 or wanted.shape[1] > space.shape[1] or missed > MOST_TURNED:
        return joint
    if missed > np.sin(alignment):
        reason = (
            f"teeth or cams leave the motion of the joints around them but for {np.degrees(np.arcsin(missed)):.2g}°, "
            f"which is more than the alignment of {np.degrees(alignment):.2g}°"
        )
        return replace(joint, status="ambiguous", reason=reason)
    rest = space - wanted @ (wanted.T @ space)
    left, _, _ = np.linalg.svd(rest, full_matrices=False)
    basis = np.hstack([wanted, left[:, : space.shape[1] - wanted.shape[1]]])
    return replace(joint, twists=canonical_twists(basis, frame))
