"""Hollows: rounds that hold a pin or a ball on one side only, as the rounded end of a slot does.

A shaft whose cross pin lies in the end of a slot is held by the half cylinder of that end, in all senses but one: the
slot goes on there. So what such rounds alone hold of bodies that would be one is as doubtful as what faces hold that
may be end stops (`stops`): the joint has two readings, and the other one has those motions that all of the hollow lets
go in one sense. Of the end of a slot that is the slide along it. The corner of a slot leaves both of its arms, one at a
time: a joint with two freedoms would have both at once, and may not be chosen (`certainty`).

A hollow that leaves a freedom is a bearing: a shaft in half of one keeps its type.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.rounding import SOLVED
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.kinematics.joints.pair.freedoms import freedoms_beyond
from kinform.kinematics.joints.pair.in_step import NEW_FREEDOM, Steps
from kinform.kinematics.joints.pair.stops import OtherReading
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

HOLLOW_ARC = math.radians(15.0)
"""rad by which the end of a slot may go further round its pin than half: patches have bins of up to 15°, and facets of
the slot begin where they will."""
HOLLOW_FACET = math.radians(12.0)
"""rad: half of the angle of a facet from which on, chord errors of both sides taken together, nobody knows whether a
hollow goes half round its pin or less: of 20 facets and fewer."""


def hollow_reading(
    evidence: Evidence, twists: Array, preserved: Flags, strict: Array, tolerances: Tolerances
) -> Steps[OtherReading | None]:
    """What a pair without freedoms (`strict` (6, 0)) may do if the round that holds it is a hollow; None if none is.

    `twists` (6, n) are candidate motions, `preserved` (items, n) which patches slide on themselves under them. Of
    several hollows the one with the least area.
    """
    if strict.shape[1]:
        return None
    rounds = [
        k for k, i in enumerate(evidence.items) if i.patch.kind in ("cylinder", "sphere") and not i.patch.one_sided
    ]
    for k in sorted(rounds, key=lambda k: (evidence.items[k].area, k)) if len(evidence.items) > 1 else []:
        keep = np.ones(len(evidence.items), dtype=bool)
        keep[k] = False
        free = preserved[keep].all(axis=0) & ~preserved[k]
        if not free.any():
            continue
        _, freed = yield from freedoms_beyond(evidence, twists, preserved, keep, tolerances, strict)
        leaving = _leaving(
            evidence.rows[evidence.start[k] : evidence.start[k + 1]] @ freed,
            freed.T @ twists[:, free],
            _is_coarse(evidence.items[k].patch),
        )
        if leaving.shape[1]:
            basis = freed @ leaving
            return OtherReading(evidence.form(basis), basis, (k,), "stop")
    return None


def _is_coarse(patch: Patch) -> bool:
    """Are its facets so few that a corner may be half of a round, and half of one a corner?"""
    return patch.chord > (1.0 - math.cos(HOLLOW_FACET)) * max(patch.radii)


def _leaving(speeds: Array, candidates: Array, coarse: bool) -> Array:
    """(f, k) orthonormal: what the candidate motions (f, n) span that take all samples off the hollow in one sense,
    `speeds` (m, f) along whose normals the motions that it holds give; where none does, the one that takes them all
    off about as fast, if it does. That one is the same in whatever units turns and slides are compared; of a hollow of
    few facets (`coarse`) candidates have to be near it."""
    if not speeds.shape[1]:
        return np.zeros((0, 0))
    even = np.asarray(np.linalg.lstsq(speeds, np.ones(len(speeds)), SOLVED)[0], dtype=np.float64)
    found = [m for m in candidates.T if _leaves(speeds, m) and not (coarse and _differ(speeds @ m, speeds @ even))]
    if not found and norm(even) > 0.0 and _leaves(speeds, even):
        found = [even / norm(even)]
    if not found:
        return np.zeros((speeds.shape[1], 0))
    left, values, _ = np.linalg.svd(np.array(found).T, full_matrices=False)
    return np.asarray(left[:, values > NEW_FREEDOM * values[0]])


def _differ(along: Array, even: Array) -> bool:
    """Do two motions take the samples off at speeds (m,) that are not alike, as of directions that differ do?"""
    return abs(float(along @ even)) < math.cos(HOLLOW_ARC) * norm(along) * norm(even)


def _leaves(speeds: Array, motion: Array) -> bool:
    """Does the motion (f,) take all samples off, none of which is approached, in one sense or the other?"""
    along = speeds @ motion
    most, least = float(along.max()), float(along.min())
    return min(most, -least) <= math.sin(HOLLOW_ARC) * max(most, -least)
