"""Stated ranges of joints beside those that the parts leave."""

from __future__ import annotations

import math
from dataclasses import replace

from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.comparisons.known import bodies_of
from kinform.consistency.context import Context
from kinform.foundation.words import angle, length, quoted
from kinform.frozen import dataclass
from kinform.function import no_stop_within
from kinform.kinematics.separation.contact_rows import is_stated
from kinform.model.collisions import RangeEnd
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint

END_ROUNDING = math.radians(2e-5)
"""rad to which the end of a turn is found (`docs/conventions.md`): less is no turn."""


@dataclass(frozen=True, eq=False)
class RangeComparison:
    """One stated range: what was found to its sides in the designer's sense, or why nothing was."""

    intended: IntendedJoint
    lower: RangeEnd | None = None
    upper: RangeEnd | None = None
    sign: float = 1.0
    """−1 where the designer's values run against those of kinform."""
    left_out: tuple[tuple[str, str], ...] = ()
    """Pairs of parts of which nothing is known, as they overlap from the start."""
    reason: str = ""
    given: bool = False
    """Neither body has a mesh, and nothing in the assembly could meet: there is nothing to compare with."""

    @property
    def unknown(self) -> str:
        """Why a side is not known; empty where both are."""
        if self.reason:
            return self.reason
        sides = (("lower", self.lower), ("upper", self.upper))
        why = "; ".join(f"{side}: {end.reason}" for side, end in sides if end is not None and end.status == "unknown")
        if why or not self.left_out:
            return why
        few = ", ".join(" and ".join(pair) for pair in self.left_out[:3])
        return f"{few} overlap from the start, and may stop it: separate them first"


def range_comparisons(context: Context) -> list[RangeComparison]:
    """Every intended joint that states a range, sorted by name."""
    joints = sorted((j for j in context.function.joints if j.range is not None), key=lambda joint: joint.name)
    lacking = context.lacks("comparisons")
    by_name = {} if lacking else {item.intended.name: item for item in context.comparisons}
    other = lacking.reason if lacking else ""
    return [
        _of_sticks(context, joint)
        or (_beside_ends(context, joint, by_name[joint.name]) if by_name else RangeComparison(joint, reason=other))
        for joint in joints
    ]


def _of_sticks(context: Context, intended: IntendedJoint) -> RangeComparison | None:
    """A range of which a body has no mesh; it is given where nothing in the assembly could meet."""
    if context.lacks("kinematics"):
        return None
    bodies = sorted(set(bodies_of(context.assembly, context.kinematics, intended.between)))
    bare = [name for name in bodies if name not in context.shaped]
    if not bare:
        return None
    given = bare == bodies and len(context.shaped) < 2
    return RangeComparison(
        intended,
        reason=f"{quoted(bare)} {'has' if len(bare) == 1 else 'have'} no mesh: add one, or check the range otherwise",
        given=given,
    )


def _beside_ends(context: Context, intended: IntendedJoint, comparison: Comparison) -> RangeComparison:
    run, match = context.design.simulation, joint_as_intended(comparison)
    if match is None and comparison.right_type and comparison.through:
        loose = quoted(comparison.through)
        reason = f"{loose} may move relative to both sides: fasten it to one of them by a [[group]]"
        return RangeComparison(intended, reason=reason)
    if match is None:
        return RangeComparison(
            intended, reason=f"no {intended.type} joint was found directly between its parts: correct the joint first"
        )
    joint, sign = match
    if run is None or run.ranges is None:
        return RangeComparison(intended, reason="ranges have not been computed: run `kinform simulate --ranges`")
    reach = next((item for item in run.ranges if item.joint == joint.name), None)
    if reach is None:
        return RangeComparison(intended, reason="no range was computed for it: run `kinform simulate --ranges`")
    lower, upper = (reach.lower, reach.upper) if sign > 0.0 else (reach.upper, reach.lower)
    if joint.status == "stated" or is_stated(joint):  # what guides it is in no mesh
        lower, upper = replace(lower, leaves=None), replace(upper, leaves=None)
    # an end stop between the two bodies is where the range ends, though it is there as it is drawn
    taken = comparison.state == "taken" and all(reading.cause != "end" for reading in joint.readings)
    return RangeComparison(
        intended,
        _clear(intended, lower) if taken else lower,
        _clear(intended, upper) if taken else upper,
        sign=sign,
        left_out=reach.left_out,
    )


def _clear(intended: IntendedJoint, end: RangeEnd) -> RangeEnd | None:
    """The end of a joint that contact does not hold; None where it is at the drawn pose: what meets there touches as it
    is drawn, as teeth and bars of loops do, and a drive of this joint alone does not part it."""
    if end.value is None:
        return end
    lower, upper = intended.range or (-math.inf, math.inf)
    near = no_stop_within(intended.type, upper - lower)
    return None if abs(end.value) <= near else end


def free_reversed(item: RangeComparison) -> bool:
    """Whether nothing known stops the joint within its stated range with both signs turned round: the joint was driven
    to either side until something stopped it."""
    lower, upper = item.intended.range or (-math.inf, math.inf)
    if item.left_out or not math.isfinite(upper - lower) or lower == -upper:
        return False
    sides = ((item.lower, -upper, -1.0), (item.upper, -lower, 1.0))
    return all(_reaches(end, item.sign, value, toward) for end, value, toward in sides)


def _reaches(end: RangeEnd | None, sign: float, value: float, toward: float) -> bool:
    if end is None or end.status == "unknown":
        return False
    ends = [toward * sign * v for v in (end.value, end.leaves) if v is not None]
    return toward * value <= min(ends, default=math.inf)


def _doubted(joint: Joint | None) -> bool:
    """Whether contact leaves undecided what the joint is."""
    return joint is not None and bool(joint.readings) and joint.readings[0].cause == "doubt"


def joint_as_intended(comparison: Comparison) -> tuple[Joint, float] | None:
    """The joint that is as intended, directly between its bodies or taken from the function, and −1 where the
    designer's values run against those of kinform, else 1; None where there is none."""
    intended, joint = comparison.intended, comparison.joint
    taken = comparison.state == "stated" or (comparison.state == "taken" and not _doubted(joint))
    if not (comparison.right_type or taken) or joint is None or joint.type != intended.type:
        return None
    if joint.axis is None or intended.axis is None:
        return None
    sign = 1.0 if float(joint.axis @ intended.axis) >= 0.0 else -1.0
    return joint, sign if comparison.bodies[0].name == joint.bodies[0] else -sign


def shown(value: float, joint: IntendedJoint, units: str, digits: int | None = None) -> str:
    """A value of a range in words; digits: significant ones."""
    if math.isinf(value):
        return "free"
    if joint.type == "prismatic":
        return length(value, units, digits or 4)
    return angle(value if abs(value) > END_ROUNDING else 0.0, digits or 3)
