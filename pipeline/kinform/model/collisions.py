"""What stops a motion: ranges of joints, and collisions along a run. World frame, SI and radians."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from kinform.frozen import dataclass
from kinform.model.names import JointName, PartName
from kinform.model.quantities import JointValue, Metres, PartPair, Place

RangeStatus = Literal["found", "unbounded", "unknown"]
"""found: it stops there; unbounded: nothing stops it; unknown: the reason says why."""
RANGE_STATUSES: tuple[RangeStatus, ...] = get_args(RangeStatus)


@dataclass(frozen=True, eq=False)
class RangeEnd:
    """How far a joint goes to one side from the pose of the meshes."""

    status: RangeStatus
    value: JointValue | None = None
    """rad or m, of the joint."""
    parts: tuple[PartName, ...] = ()
    """The two parts that meet there; none where the linkage itself turns back."""
    place: Place | None = None
    """(3,) m: where they meet, at the pose in which they do, with the ground at rest."""
    reason: str = ""
    """Why it is not known, or what else is to be known of this side."""
    leaves: JointValue | None = None
    """rad or m: where a slide or screw that nothing stops has left its guide."""


@dataclass(frozen=True, eq=False)
class JointRange:
    """Range of a joint that is driven alone, or with the loops that it is in."""

    joint: JointName
    lower: RangeEnd
    upper: RangeEnd
    left_out: tuple[PartPair, ...] = ()
    """Pairs of parts that overlap from the start, of which nothing is known."""
    slides: bool = False
    """Whether its values are lengths."""

    @property
    def status(self) -> RangeStatus:
        """found where a side stops and the other is known, unbounded where neither stops, else unknown."""
        ends = (self.lower.status, self.upper.status)
        if "unknown" in ends:
            return "unknown"
        return "found" if "found" in ends else "unbounded"


@dataclass(frozen=True, eq=False)
class Collision:
    """Two parts of different bodies that meet in a run, outside of the surfaces that mate."""

    parts: PartPair
    time: Annotated[float, "s"]
    """s: of the first contact."""
    place: Place
    """(3,) m: of the first contact."""
    depth: Metres
    """m: how deep they go into each other at the worst output time; nan where it could not be measured."""
