"""In the simulated motion, parts run into each other outside of the surfaces on which they mate.

A finding for each pair of parts of different bodies, with the time and the place of the first contact. Surfaces that
slide on themselves in a joint are left out, and so is what is no deeper than the chord errors of facets.

Why it matters: the real device stops or breaks there; the rest of the simulated motion means nothing.

What to do: change the shape, the motion that drives the joint, or its start.

Example: a camera scans by ±45°, and its gimbal hits the housing at 39°.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.questions.proofs import in_each_other
from kinform.consistency.rule import Rule
from kinform.foundation.algebra.displacements import poses
from kinform.foundation.words import counted, length, number, place, quoted
from kinform.model.collisions import Collision
from kinform.model.findings import Witness

TIMES_TRIED = (0, 1, 2, 4, 8, 16, 32)
"""Output times after a collision, counted from it, at which the overlap is looked for."""


def check(context: Context) -> Outcome:
    """Every pair of parts that meets in the run."""
    run = context.simulation
    if run.collisions is None:
        return inconclusive("collisions have not been looked for: run `kinform simulate`")
    findings = [
        RULE.finding(
            item.parts,
            f"{quoted(item.parts)} collide at t = {number(item.time, 6)} s, "
            f"at {place(item.place, context.units)}, up to {length(item.depth, context.units)} deep",
            found=f"t = {number(item.time, 6)} s",
            intended="no collision",
            place=item.place,
            remedy="Change the shape, the motion, or its start.",
            witness=_witness(context, item),
        )
        for item in run.collisions
    ]
    overlaps = () if context.lacks("contacts") else context.contacts.interferences
    overlapping = {overlap.parts for overlap in overlaps}
    # what overlaps from the start is a finding of KF201 or KF202 already
    untested = [item for item in run.uncollided if item[:2] not in overlapping]
    if untested:
        first, second, why = untested[0]
        reason = f"{counted(len(untested), 'pair')} not tested: {first} and {second}: {why}"
        return inconclusive(reason, findings)
    return decided(findings)


def _witness(context: Context, item: Collision) -> Witness | None:
    """The first output time at which the two are in each other."""
    run, kinematics = context.simulation, context.kinematics
    bodies = [kinematics.body_of(name).name for name in item.parts]
    if not all(name in run.body_names for name in bodies):
        return None
    later = np.flatnonzero(run.time >= item.time)
    after = later[[k for k in TIMES_TRIED if k < len(later)]]
    first, second = (
        poses(run.p_WB[after, b], run.q_WB[after, b]) for b in (run.body_names.index(name) for name in bodies)
    )
    return in_each_other(context, item.parts, np.linalg.inv(first) @ second)


RULE = Rule("KF505", "parts-collide", "error", __doc__, check, needs=("meshes", "motion"))
