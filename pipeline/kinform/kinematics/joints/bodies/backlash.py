"""Backlash: the turn of a body whose flank rests on another's, and that a second flank ends a little farther on.

A key that is drawn on one side of a wide keyway lets its shaft turn until it meets the other side. Nobody means that
turn as a motion, any more than end play (`end_play`): the joint is what it is at rest. Flanks are facets that look
along the turn. Points of either body's flanks are followed along their circles, and where they go through facets of the
other's that look at them the bodies have met: what is found bounds the turn from above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.foundation.algebra.vectors import cross, normalised, perpendicular
from kinform.foundation.rounding import TINY
from kinform.foundation.words import angle
from kinform.kinematics.joints.bodies.end_faces import LEANS
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.joints.pair.lower_pairs import name_space
from kinform.kinematics.screws.wording import motions_in_words
from kinform.model.arrays import Array
from kinform.model.assembly import Part
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint

MOST_BACKLASH = 0.05
"""rad, 2.9°: a turn up to which opposite flanks are backlash: those of keys, splines and couplings have some tenths of
a degree, worn ones two; a key of a piano, which is meant to turn, 4°. Chosen, not measured."""
MOST_OVERLAP = 0.2 * MOST_BACKLASH
"""rad by which flanks may be drawn into each other. Chosen, not measured."""
MOST_LOOKED_AT = 20_000_000
"""Points times facets up to which flanks are compared: about a second."""
INSIDE = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4], [2, 2, 2]]) / 6.0
"""Points of a facet that are followed, as shares of its corners."""


def without_backlash(joint: Joint, patches: Sequence[Patch], first: Sequence[Part], second: Sequence[Part]) -> Joint:
    """A joint that is drawn at the end of its turn: what it is at rest, where the turn is backlash between the parts
    of its bodies; else as it is."""
    if joint.type not in ("revolute", "cylindrical") or not joint.at_stop or joint.axis is None or joint.point is None:
        return joint
    one, other = (_triangles(parts, joint.axis, joint.point) for parts in (first, second))
    turn = _free_turn(one, other, 1) + _free_turn(one, other, -1)
    if turn > MOST_BACKLASH:
        return joint
    frame = Frame.of(np.concatenate([patches[k].points for k in joint.touching]))
    form = name_space(span(scaled(joint.at_rest.T, frame)) if len(joint.at_rest) else np.zeros((6, 0)), frame)
    twists = twists_of(form.type, form.axis, form.point, form.pitch) if form.type != "general" else joint.at_rest
    return replace(
        joint,
        type=form.type,
        axis=form.axis,
        point=form.point,
        freedoms=len(joint.at_rest),
        twists=twists,
        closed=joint.at_rest,
        patches=joint.touching,
        at_stop=(),
        reason=f"{joint.reason}; it turns by {angle(turn, 2)} at most between flanks: backlash",
        motion=motions_in_words(scaled(twists.T, frame), frame) if len(twists) else "",
    )


def _triangles(parts: Sequence[Part], axis: Array, point: Array) -> Array:
    """(n, 3, 3) m: corners of the facets of some parts, in a frame whose z axis is the line."""
    u, v = perpendicular(axis)
    to_line = np.array([u, v, axis])
    out = [np.zeros((0, 3, 3))]
    for part in parts:
        if part.mesh is not None:
            places = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3] - point
            out.append((places @ to_line.T)[part.mesh.faces])
    return np.concatenate(out)


def _free_turn(first: Array, second: Array, sense: int) -> float:
    """rad: by how much the second body turns about z in this sense at most; inf where nothing meets within what may be
    backlash."""
    fixed, turning = _flanks(first, -sense), _flanks(second, sense)
    return max(0.0, min(_met(turning, fixed, sense), _met(fixed, turning, -sense)))


def _flanks(triangles: Array, sense: int) -> Array:
    """Those that look along a turn about z in this sense."""
    normals = normalised(cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    middles = triangles.mean(axis=1)
    along = middles[:, 0] * normals[:, 1] - middles[:, 1] * normals[:, 0]
    leans = sense * along > LEANS * np.hypot(middles[:, 0], middles[:, 1])
    return np.asarray(triangles[leans])


def _met(moving: Array, still: Array, sense: int) -> float:
    """rad: the least turn about z in this sense that takes a point of the one flanks through the others; inf where
    none of up to `MOST_BACKLASH` does."""
    points = (INSIDE @ moving).reshape(-1, 3)
    if not len(points) or not len(still):
        return math.inf
    heights, radii = still[..., 2], np.hypot(still[..., 0], still[..., 1])
    near = (points[:, 2] >= heights.min()) & (points[:, 2] <= heights.max())
    points = points[near & (np.hypot(points[:, 0], points[:, 1]) <= radii.max())]
    if len(points) * len(still) > MOST_LOOKED_AT:
        return math.inf
    least = math.inf
    for corners in still:
        normal = cross(corners[1] - corners[0], corners[2] - corners[0])
        x, y, z = points.T
        # normal · (point turned by φ) − level = a cos φ + b sin φ + c
        a, b = normal[0] * x + normal[1] * y, sense * (normal[1] * x - normal[0] * y)
        c = normal[2] * z - normal @ corners[0]
        size = np.maximum(np.hypot(a, b), TINY)
        middle, half = np.arctan2(b, a), np.arccos(np.clip(-c / size, -1.0, 1.0))
        for turn in (middle - half, middle + half):
            turn = (turn + math.pi) % math.tau - math.pi
            some = (np.abs(c) <= size) & (turn >= -MOST_OVERLAP) & (turn <= min(MOST_BACKLASH, least))
            if some.any():
                least = min([least, *turn[some][_inside(points[some], turn[some], sense, corners)].tolist()])
    return least


def _inside(points: Array, turns: Array, sense: int, corners: Array) -> Array:
    """(n,) which points, turned about z, are within a triangle in whose plane they are then."""
    cos, sin = np.cos(turns), sense * np.sin(turns)
    places = np.stack([points[:, 0] * cos - points[:, 1] * sin, points[:, 0] * sin + points[:, 1] * cos, points[:, 2]])
    sides, arms = np.roll(corners, -1, axis=0) - corners, places.T[:, None] - corners
    normal = cross(corners[1] - corners[0], corners[2] - corners[0])
    return np.asarray((cross(sides, arms) @ normal >= 0.0).all(axis=1))
