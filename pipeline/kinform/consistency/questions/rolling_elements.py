"""What is known over a distance of a motion that goes through rolling elements: balls, rollers and needles between two
races.

Points and lines of contact hold along normals that turn as bodies move, so that a closure of them tells the motions of
this instant. Three things are asked of it:

- What is there for certain: slides along lines of contact, which keep them, and all motions on planes. What else is
  free may end at once, as where a ball in a bowl is pressed from the other side.
- Whether anything is wedged: a roller between two races that lean against each other by little lets them come nearer
  by going out fast. Below the angle of friction it does not, and where races were meant to be parallel, or lines of
  action to be one, it is an error of their place that frees them (Amontons; any text on clamping rollers). What
  turns or slides on its own joint is not: the gears of a train are fast.
- Whether a roller that turns about the normal of the line in which it lies in a ring, which it does at the first
  instant alone (`pair.touches`), has a part in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span, twist_at_origin
from kinform.foundation.algebra.vectors import cross, sine
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.joints.pair.touches import TOUCHING, held_by_bends
from kinform.mechanism.first_order import body_twists, close
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint

WEDGED = 8.0
"""Times as fast as a body moves what touches it, above which that is wedged: lines that lean against each other by
0.12 rad, the angle of friction of steel that is hardly oiled."""


@dataclass(frozen=True, eq=False)
class Rolling:
    """What is known of a motion through bodies that touch by points and lines."""

    sure: Array
    """(m, 6) twists (ω; v at the world's origin) that are there over a distance for certain."""
    doubt: str
    """Why the motion of this instant is not known; else empty."""
    bent: frozenset[str]
    """Names of joints whose only doubt is a turn that has no part in the motion."""


def rolling(
    joints: Sequence[Joint],
    edges: Sequence[tuple[int, int]],
    nodes: Sequence[str],
    patches: Sequence[Patch],
    motions: Array,
    frame: Frame,
) -> Rolling | None:
    """What is known of the `motions` (k, nodes, 6) of bodies (`nodes`), the second relative to the first, that joints
    (`edges` in their order) leave at this instant, as twists in `frame`; None where no joint is of points and lines."""
    touching = [[patches[k] for k in joint.patches if patches[k].kind in TOUCHING] for joint in joints]
    if not any(touching):
        return None
    fast = _wedged(motions, edges, touching, _guided(joints, edges, touching, len(nodes)), frame)
    doubt = ""
    if fast is not None:
        node, ratio = fast
        doubt = (
            f"at this instant {quoted([nodes[node]])} would move {ratio:.2g} times as fast as {quoted([nodes[1]])}: it "
            "is wedged between contacts that lean against each other by little"
        )
    bent = frozenset(str(j.name) for j in joints if j.readings and j.readings[0].cause == "bend")
    least = [_over_a_distance(joint, found) for joint, found in zip(joints, touching, strict=True)]
    if bent and _between(least, edges, nodes, frame).shape[1] < span(second_moves(motions, frame)).shape[1]:
        bent = frozenset()
    sure = [_certain(joint, found, frame) for joint, found in zip(joints, touching, strict=True)]
    return Rolling(twist_at_origin(_between(sure, edges, nodes, frame), frame).T, doubt, bent)


def _between(spaces: Sequence[Array], edges: Sequence[tuple[int, int]], nodes: Sequence[str], frame: Frame) -> Array:
    """(6, k) orthonormal: motions of the second node relative to the first that joints of these spaces leave."""
    return span(second_moves(body_twists(close(len(nodes), edges, spaces, 0, frame.length), edges, spaces), frame))


def second_moves(motions: Array, frame: Frame) -> Array:
    """(6, k) scaled twists in `frame` of the second body in motions (k, nodes, 6), zero where it stands still beside
    others and only rounding moves it."""
    twists = scaled(motions.reshape(-1, 6).T, frame)
    sizes = np.linalg.norm(twists, axis=0).reshape(motions.shape[:2])
    still = sizes[:, 1] <= SINGLE * sizes.max(axis=1)
    own = twists.reshape(6, *motions.shape[:2])[:, :, 1]
    return np.asarray(np.where(still, 0.0, own))


def _over_a_distance(joint: Joint, touching: Sequence[Patch]) -> Array:
    """(m, 6) freedoms of the joint without the turns of rollers about the normals of their lines in rings."""
    return np.asarray(held_by_bends(touching, joint.twists.T).T)


def _certain(joint: Joint, touching: Sequence[Patch], frame: Frame) -> Array:
    """(m, 6) freedoms of the joint that keep its contact over a distance for certain."""
    if joint.status == "ambiguous" and not touching:
        return joint.twists[:0]
    if not touching or all(patch.flat and not patch.one_sided for patch in touching):
        return joint.twists
    lines = [patch.axis for patch in touching if patch.kind == "line" and not patch.one_sided]
    if len(lines) < len(touching) or any(sine(lines[0], other) > SAME_DIRECTION for other in lines):
        return joint.twists[:0]
    slide = np.concatenate([np.zeros(3), lines[0]])
    space = span(scaled(joint.twists.T, frame))
    missed = slide - space @ (space.T @ slide)
    if float(np.linalg.norm(missed)) > SAME_DIRECTION:
        return joint.twists[:0]
    return np.asarray(twist_at_origin((space @ (space.T @ slide))[:, None], frame).T)


def _guided(
    joints: Sequence[Joint], edges: Sequence[tuple[int, int]], touching: Sequence[Sequence[Patch]], count: int
) -> Flags:
    """(nodes,) which bodies turn or slide on the two, or on bodies that do: gears are fast, and not wedged."""
    every = zip(joints, edges, touching, strict=True)
    alone = [edge for joint, edge, found in every if not found and len(joint.twists) == 1]
    first, second = np.array([(0, 1), *alone]).T
    group = components(first, second, count)
    return np.asarray(group == group[0])


def _wedged(
    motions: Array,
    edges: Sequence[tuple[int, int]],
    touching: Sequence[Sequence[Patch]],
    guided: Flags,
    frame: Frame,
) -> tuple[int, float] | None:
    """The body (its number) that moves the fastest beside the second one, and how many times as fast, in the motion in
    which it does so the most; None where that is not much. None that are `guided` (nodes,) count."""
    places: dict[int, list[Array]] = {}
    for edge, found in zip(edges, touching, strict=True):
        for patch, node in product(found, edge):
            if not guided[node]:
                places.setdefault(node, []).append(patch.points.mean(axis=0))
    if not places:
        return None
    # where they touch, so that what spins there counts as what goes
    of = np.array([node for node, at in places.items() for _ in at])
    at = np.concatenate(list(places.values())).reshape(-1, 3)
    moved = motions[:, of, 3:] + cross(motions[:, of, :3], at)
    own = second_moves(motions, frame).T
    left, values, _ = np.linalg.svd(own, full_matrices=True)
    rank = int(np.count_nonzero(values > SINGLE * values.max(initial=0.0)))
    if not rank:
        return None
    flat = moved.reshape(len(motions), -1)
    idle, driven = left[:, rank:].T @ flat, (left[:, :rank] / values[:rank]).T @ flat
    _, sizes, ways = np.linalg.svd(idle, full_matrices=False)
    ways = ways[sizes > SINGLE * sizes.max(initial=0.0)]
    driven = driven - (driven @ ways.T) @ ways
    each = np.linalg.norm(driven.reshape(rank, len(of), 3).transpose(1, 0, 2), ord=2, axis=(1, 2))
    fastest = int(np.argmax(each))
    return (int(of[fastest]), float(each[fastest])) if each[fastest] > WEDGED else None
