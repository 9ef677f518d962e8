"""An intended joint and what was found of it: type, direction, position, pitch."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from kinform.consistency.comparisons.couplings import ROUNDED_RATIO
from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.joints_in_force import leaves_free
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.model.arrays import Array
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body, Joint

STATES = ("stated", "taken", "one body", "absent", "undecided", "found")

WITH_LINE = ("revolute", "cylindrical", "screw")
"""Joints whose axis is a line: direction and position count."""
FROM_GEOMETRY = ("fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar")
"""Joint types that contact alone can prove so far; of others only an assumption speaks."""
ComparisonState = Literal["stated", "taken", "one body", "absent", "undecided", "found"]


@dataclass(frozen=True, eq=False)
class Comparison:
    """One intended joint and what was found of it. Angles in rad, lengths in m; None: not comparable.

    `state`: stated (the joint comes from the function, nothing to compare), taken (the function states all joints, and
    this one as contact leaves it free without holding it, or does not touch it), one body (both sides are
    one body), absent (no contact, direct or through loose parts), undecided (`reason` says why), found.
    Where contact is missing, or leaves too much, and a part with play may carry the joint, `afloat` says so of a state
    that is taken, and it is the reason of one that is undecided.
    """

    intended: IntendedJoint
    bodies: tuple[Body, Body]
    state: ComparisonState
    reason: str = ""
    type: str = ""
    axis: Array | None = None
    point: Array | None = None
    axis2: Array | None = None
    pitch: float | None = None
    freedoms: int = 0
    joint: Joint | None = None
    """The direct joint of the two bodies."""
    twists: Array | None = None
    """(k, 6) what was found leaves free (ω; v at the world's origin)."""
    through: tuple[str, ...] = ()
    """Loose bodies that take part."""
    angle_slack: float = 0.0
    """By so much the found direction may be off: two standard uncertainties."""
    position_slack: float = 0.0
    """By so much the found position may be off: two standard uncertainties."""
    size: float = 1.0
    """m: diagonal of the smaller body."""
    admitted: bool = False
    """What was found is another motion, and contact lets each motion of the intended joint go, in one sense at
    least."""
    loose: bool = False
    """The joint is stated as fixed, which makes its sides one body, and contact would part them as `type` says."""
    afloat: str = ""
    """That a part with play between the sides may carry the joint where there is no contact, or hold more of it: in
    words."""
    angle_limit: float = 0.0
    """By so much the axis may be tilted to the intended one (rad)."""
    position_limit: float = 0.0
    """By so much the axis or centre may lie beside the intended one (m)."""

    @property
    def touch(self) -> bool:
        """Whether there is contact between the sides, also through loose bodies."""
        return bool(self.type) or (self.joint is not None and bool(self.joint.patches))

    @property
    def left_free(self) -> bool:
        """Whether the function states all joints, and this one as contact leaves more free."""
        return (
            self.state == "taken"
            and self.joint is not None
            and any(reading.cause in ("contact", "end") for reading in self.joint.readings)
        )

    @property
    def right_type(self) -> bool:
        """Whether the joint is there and of the intended type."""
        if self.state == "one body":
            return self.intended.type == "fixed" and not self.loose
        return self.state == "found" and self.type == self.intended.type and not self.admitted

    @property
    def angle(self) -> float | None:
        """Angle between the intended and the found axis, sign left aside."""
        wanted, wanted2 = self.intended.axis, self.intended.axis2
        if not self.right_type or wanted is None or self.axis is None:
            return None
        if wanted2 is None or self.axis2 is None:
            return _between(wanted, self.axis)
        straight = max(_between(wanted, self.axis), _between(wanted2, self.axis2))
        crossed = max(_between(wanted, self.axis2), _between(wanted2, self.axis))
        return min(straight, crossed)

    @property
    def offset(self) -> float | None:
        """Distance of the found axis from the intended one, where the joint is; of centres for
        spherical and universal joints."""
        wanted = self.intended.point
        if not self.right_type or wanted is None or self.point is None:
            return None
        if self.type in ("spherical", "universal"):
            return float(np.linalg.norm(self.point - wanted))
        if self.type not in WITH_LINE or self.intended.axis is None or self.axis is None:
            return None
        return _apart(self.intended.axis, wanted, self.axis, self.point)

    @property
    def tilted(self) -> bool | None:
        """Whether the axis is tilted beyond its limit; None where its uncertainty decides."""
        return _beyond(self.angle, self.angle_limit, self.angle_slack)

    @property
    def displaced(self) -> bool | None:
        """Whether the axis or centre is farther off than its limit; None where its uncertainty decides."""
        return _beyond(self.offset, self.position_limit, self.position_slack)

    @property
    def other_pitch(self) -> bool | None:
        """Whether a screw advances otherwise a turn than intended; None where there is no pitch to compare."""
        wanted = self.intended.pitch
        if not self.right_type or self.type != "screw" or wanted is None or self.pitch is None:
            return None
        return abs(self.pitch - wanted) > ROUNDED_RATIO * abs(wanted)


def _beyond(off: float | None, limit: float, slack: float) -> bool | None:
    if off is None or off <= limit:
        return False
    return True if off > limit + slack else None


def leaves_more(c: Comparison) -> bool:
    """Whether the joint that was found leaves the intended motion free, and more beside, or lets it go in one sense."""
    wanted = joint_twists(c.intended)
    if c.admitted and c.state == "found":
        return True
    if c.state != "found" or c.right_type or c.twists is None or wanted is None:
        return False
    place = c.intended.point if c.intended.point is not None else c.point
    if place is None or c.freedoms <= len(wanted):
        return False
    return leaves_free(c.twists, wanted, place, c.size)


def _between(a: Array, b: Array) -> float:
    """Angle between two undirected lines (rad, 0 to π/2)."""
    return math.atan2(float(np.linalg.norm(cross(a, b))), abs(float(a @ b)))


def _apart(axis: Array, point: Array, other_axis: Array, other_point: Array) -> float:
    """Least distance (m) of the second line from the first over the stretch between the two points.

    Parallel lines: their distance. A tilt about any point of the stretch gives 0, so that a tilted
    axis is not reported as displaced as well.
    """
    end = float(axis @ (other_point - point))
    start = point - other_point
    r0 = start - other_axis * float(other_axis @ start)
    r1 = axis - other_axis * float(other_axis @ axis)
    square = float(r1 @ r1)
    at = -float(r0 @ r1) / square if square > 0.0 else 0.0
    at = min(max(at, min(0.0, end)), max(0.0, end))
    return float(np.linalg.norm(r0 + at * r1))
