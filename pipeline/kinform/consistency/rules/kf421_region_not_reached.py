"""A point of a body, or a direction in which it points, does not cover the region that it is required to reach.

Places spread over the region (a cone: 240 directions inside and 48 on its rim; a box: 7 along each edge; poses: all of
them) are approached from sampled configurations within the ranges of the joints, those of the function and those that
were found. A place that is reached is proved by its configuration; a hole between two places can be missed, and the
report says how large. One that is not reached was not found from any start, and its distance is given. Near enough is
the tolerance, by default a thousandth of the assembly's size, or 0.1°. Collisions are another requirement: `clear`.
Joints whose range is not known may turn freely for a "no"; for a "yes" they make the requirement inconclusive (KF902),
as closed loops with more than two freedoms do for a "no"; and so do joints that a stated coupling ties, for a "yes".

Why it matters: the tool, the beam or the camera does not get where the task is.

What to do: widen a range, lengthen a link, or move the base.

Example: a camera that must point within 40° of +x, on a yaw of ±45° and a pitch of ±30°.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinform.consistency.comparisons.plausibility import extent
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, met, undecided, violated
from kinform.consistency.requirements import JOINTS, requirement_rule, stated_as
from kinform.foundation.words import angle, counted, direction, length, place, quoted
from kinform.function import resolve_joint
from kinform.function.configurations import Chain, chain_between
from kinform.function.coverage import Coverage, cover
from kinform.function.regions import Targets, targets_of
from kinform.function.requirement_kinds import Reach

REACHED_SHARE = 1e-3
"""Share of the assembly's size within which a place is reached, where no tolerance is stated; a choice."""
REACHED_ANGLE = math.radians(0.1)
"""rad within which a direction is reached, where no tolerance is stated; a choice."""
SAMPLED_FREEDOMS = 2
"""Freedoms of closed loops up to which sampling is dense enough for a "no"."""


OTHERWISE = "Check it by other means, or require `follow` of a simulated motion."
REMEDY = "Widen a range, lengthen a link, or move the base."


def judge(context: Context, requirement: Reach) -> Answer:
    """The targets of the region that are not reached."""
    pointing = requirement.direction is not None
    carried = requirement.direction if pointing else requirement.point
    if carried is None or (pointing and requirement.point is not None):
        return undecided("it needs either a point or a direction", "State one of them.")
    targets = targets_of(requirement.region, direction=pointing)
    if isinstance(targets, str):
        return undecided(targets, "Correct the requirement.")
    chain = _chain(context, requirement.part)
    if isinstance(chain, Answer):
        return chain
    body = context.body(requirement.part) or ""
    endless = next((c.joint for c in chain.coordinates if not c.turns and not math.isfinite(c.upper - c.lower)), None)
    if not chain.looped and endless is not None:
        slides = f"joint '{stated_as(context, endless)[0]}' slides, and its range is not known"
        return undecided(slides, "State the `range` of its [[function.joint]].")
    near = requirement.angle_tolerance if pointing else requirement.tolerance
    if near is None:
        near = REACHED_ANGLE if pointing else REACHED_SHARE * (extent(context.assembly) or 1.0)
    coverage = cover(chain, body, carried, targets.values, directions=pointing, near=near)
    missed = np.flatnonzero(~(coverage.distance <= near))
    if len(missed) and chain.looped and chain.freedoms > SAMPLED_FREEDOMS:
        return undecided(
            f"{len(missed)} of {len(targets.values)} places were not reached, but {chain.freedoms} freedoms in closed "
            "loops are too many to be sampled densely",
            OTHERWISE,
        )
    if len(missed):
        return _not_reached(context, targets, coverage, missed, near)
    text = f"all {counted(len(targets.values), 'place')} of the region reached{_bound(context, targets)}"
    unknown = [stated_as(context, name)[0] for name in chain.undetermined(body)]
    if unknown:
        return undecided(
            f"{text}, but only if {quoted(unknown)} may turn freely: no range is known",
            "State the `range` of the [[function.joint]].",
        )
    tied = _tied(context, chain)
    if tied:
        return undecided(
            f"{text}, but only if {quoted(tied)} move without each other: their coupling is stated and no geometry "
            "shows it",
            OTHERWISE,
        )
    return met(text)


def _tied(context: Context, chain: Chain) -> tuple[str, ...]:
    """Names of stated joints of the chain that a stated coupling ties, where no contact of the chain does."""
    moving = {coordinate.joint for coordinate in chain.coordinates}
    for coupling in context.function.couplings:
        ends = [resolve_joint(context.assembly, context.kinematics, name).joint for name in coupling.joints]
        if any(joint is not None and joint.name in moving for joint in ends):
            return coupling.joints
    return ()


def _chain(context: Context, part: str) -> Chain | Answer:
    """The joints between the ground and the part."""
    kinematics = context.kinematics
    body = kinematics.body_of(context.assembly.parts_of(part)[0])
    ground = next((b.name for b in kinematics.bodies if b.ground), None)
    if ground is None or body.ground:
        return undecided(f"'{part}' does not move: it is the ground", "Require it of a part that moves.")
    chain = chain_between(context.assembly, kinematics, ground, body.name)
    return undecided(chain, "See KF401 and KF901.") if isinstance(chain, str) else chain


def _bound(context: Context, targets: Targets) -> str:
    if targets.gap == 0.0:
        return ""
    size = angle(targets.gap) if targets.directions else length(targets.gap, context.units)
    return f"; between them holes of up to {size} in radius can be missed"


def _not_reached(
    context: Context, targets: Targets, coverage: Coverage, missed: NDArray[np.intp], near: float
) -> Answer:
    """The requirement is violated; `missed` are the targets that are farther than `near` (m or rad) from all poses."""
    units, distance = context.units, coverage.distance
    worst = int(missed[np.argmax(distance[missed])])
    aim = targets.values[worst]
    shown = direction(np.round(aim, 4)) if targets.directions else place(aim, units)
    size = angle if targets.directions else (lambda v: length(v, units))
    share = f"{len(missed)} of {len(targets.values)}"
    return violated(
        f"{share} places of the region are not reached; the nearest to {shown} is {size(float(distance[worst]))} off, "
        f"found from {coverage.samples} sampled configurations",
        found=f"{share} not reached, {size(float(distance[worst]))} off at most",
        intended=f"all, within {size(near)}",
        place=None if targets.directions else aim,
        remedy=REMEDY,
    )


RULE = requirement_rule("KF421", "region-not-reached", Reach, __doc__, judge, JOINTS)
