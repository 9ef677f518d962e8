"""Intended joints beside the joints that geometry gives: type, direction, position, pitch."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cached_property

import numpy as np

from kinform.consistency.constants import SHARED_MOTION
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.kinematics.bodies.as_stated import leaves_free
from kinform.kinematics.bodies.extents import Extents
from kinform.kinematics.partition.parting import joint_twists
from kinform.kinematics.questions.afloat import AfloatParts, may_carry
from kinform.kinematics.questions.rolling import Rolling
from kinform.kinematics.questions.through_helpers import HelperMotion, motion_through_helpers
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import FREEDOMS, Body, Joint, Kinematics, LeftOut

STATES = ("stated", "taken", "one body", "absent", "undecided", "found")

WITH_LINE = ("revolute", "cylindrical", "screw")
"""Joints whose axis is a line: direction and position count."""
FROM_GEOMETRY = ("fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar")
"""Joint types that contact alone can prove so far; of others only an assumption speaks."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """One intended joint and what was found of it. Angles in rad, lengths in m; None: not comparable.

    `state`: stated (the joint comes from the function, nothing to compare), taken (the function states all joints, and
    this one as contact leaves it free without holding it, or does not touch it), one body (both sides are
    one body), absent (no contact, direct or through loose parts), undecided (`reason` says why), found.
    Where there is no contact and a part that has play may carry the joint, `afloat` says so of a state that is taken,
    and it is the reason of one that is undecided.
    """

    intended: IntendedJoint
    bodies: tuple[Body, Body]
    state: str
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
    """Uncertainty of the found direction."""
    position_slack: float = 0.0
    """Uncertainty of the found position."""
    size: float = 1.0
    """m: diagonal of the smaller body."""
    loose: bool = False
    """The joint is stated as fixed, which makes its sides one body, and contact would part them as `type` says."""
    afloat: str = ""
    """That there is no contact, and a part with play between the sides may carry the joint: in words."""
    position_limit: float = 0.0
    """By so much the axis or centre may lie beside the intended one (m)."""

    @property
    def right_type(self) -> bool:
        """Whether the joint is there and of the intended type."""
        if self.state == "one body":
            return self.intended.type == "fixed" and not self.loose
        return self.state == "found" and self.type == self.intended.type

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


def bodies_of(assembly: Assembly, kinematics: Kinematics, between: tuple[str, str]) -> tuple[str, str]:
    """Names of the bodies that contain two parts or groups."""
    first, second = (kinematics.body_of(assembly.parts_of(name)[0]).name for name in between)
    return first, second


class _Known:
    """What is asked about each of many intended joints, and the same for all."""

    def __init__(self, assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics):
        self._assembly, self._contacts, self._kinematics = assembly, contacts, kinematics

    @cached_property
    def named(self) -> frozenset[str]:
        """Bodies that the function names."""
        pairs = (bodies_of(self._assembly, self._kinematics, one.between) for one in self._assembly.function.joints)
        return frozenset(name for pair in pairs for name in pair)

    @cached_property
    def extents(self) -> Extents:
        """Of the assembly."""
        return Extents(self._assembly)

    @cached_property
    def _parts_afloat(self) -> AfloatParts | None:
        return AfloatParts(self._assembly, self._contacts) if self._contacts is not None else None

    def afloat(self, first: str, second: str) -> str:
        """What may carry a joint of two bodies between which there is no contact, in words; "" where nothing does."""
        if self._parts_afloat is None:
            return ""
        one = may_carry(self._parts_afloat, self._kinematics, first, second, self.named)
        return one.words() if one is not None else ""


def compare_joints(
    assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics, intended: Iterable[IntendedJoint]
) -> list[Comparison]:
    """The intended joints beside what the geometry of their two bodies, and of loose parts that connect them, leaves
    free."""
    known = _Known(assembly, contacts, kinematics)
    return [_compared(assembly, contacts, kinematics, one, known) for one in intended]


def _compared(
    assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics, intended: IntendedJoint, known: _Known
) -> Comparison:
    first, second = (kinematics.body_of(assembly.parts_of(name)[0]) for name in intended.between)
    bodies = (first, second)
    if first.name == second.name:
        reason = "; ".join(first.merged)
        one = loose_joint(assembly, kinematics, intended)
        if one is None:
            return Comparison(intended, bodies, "one body", reason, type="fixed")
        freedoms = FREEDOMS[one.type]
        return Comparison(
            intended, bodies, "one body", reason, one.type, one.axis, one.point, freedoms=freedoms, loose=True
        )
    direct = next(iter(kinematics.joints_between(first.name, second.name)), None)
    if direct is not None and direct.status == "stated":
        afloat = "" if direct.patches else known.afloat(first.name, second.name)
        return Comparison(intended, bodies, "taken", afloat or direct.reason, joint=direct, afloat=afloat)
    if direct is not None and direct.evidence == ("function",):
        return Comparison(intended, bodies, "stated", "the joint is taken from the function", joint=direct)
    size = _smaller(known.extents, bodies)
    every = contacts.patches if contacts is not None else ()
    motion = motion_through_helpers(kinematics, every, first.name, second.name, known.named, size)
    used: tuple[Joint, ...] = (direct,) if direct is not None else ()
    if motion is not None:
        used = motion.joints
    if not used:
        afloat = known.afloat(first.name, second.name)
        return Comparison(intended, bodies, "undecided" if afloat else "absent", afloat, afloat=afloat)
    patches = [contacts.patches[k] for j in used for k in j.patches] if contacts is not None else []
    angle_slack, position_slack = _slack(patches)
    if motion is None and direct is not None:
        angle_slack, position_slack = direct.axis_uncertainty, direct.point_uncertainty
    form = direct if motion is None else motion.form
    assert form is not None
    through = motion.rolling if motion is not None else None
    state, reason = _certainty(intended, form.type, [j for j in used if through is None or j.name not in through.bent])
    found = direct.twists if motion is None and direct is not None else motion.twists if motion else None
    if state == "found" and through is not None and motion is not None:
        state, reason = _rolling_certainty(intended, motion, through, size)
    if state == "found" and intended.closure and found is not None and _shares(intended, form.type, found):
        state, reason = "undecided", f"it only closes a loop, and by contact that joint is {form.type}"
    return Comparison(
        intended,
        bodies,
        state,
        reason,
        type=form.type,
        axis=form.axis,
        point=form.point,
        axis2=direct.axis2 if motion is None and direct is not None else None,
        pitch=form.pitch,
        freedoms=direct.freedoms if motion is None and direct is not None else motion.freedoms if motion else 0,
        joint=direct,
        twists=found,
        through=motion.helpers if motion is not None else (),
        angle_slack=angle_slack,
        position_slack=position_slack,
        size=size,
        position_limit=assembly.tolerances.offset_limit(size),
    )


def loose_joint(assembly: Assembly, kinematics: Kinematics, intended: IntendedJoint) -> LeftOut | None:
    """What contact alone would make of a joint that is stated as fixed, where it would part its sides."""
    if intended.type != "fixed":
        return None
    first, second = (assembly.parts_of(name)[0] for name in intended.between)
    return next((one for one in kinematics.left_out or () if one.parts(first, second)), None)


def _rolling_certainty(intended: IntendedJoint, motion: HelperMotion, through: Rolling, size: float) -> tuple[str, str]:
    """Whether what rolling elements leave is known: what they leave beside the intended joint for this instant alone
    may be held by them all the same."""
    if through.doubt:
        return "undecided", through.doubt
    wanted, middle = joint_twists(intended), intended.point if intended.point is not None else motion.form.point
    if motion.form.type == intended.type or wanted is None or middle is None:
        return "found", ""
    if not leaves_free(motion.twists, wanted, middle, size) or not leaves_free(wanted, through.sure, middle, size):
        return "found", ""
    return "undecided", (
        f"points and lines of contact with {quoted(motion.helpers)} leave {counted(motion.freedoms, 'freedom')} at "
        "this instant; over a distance that may be the intended one alone"
    )


def _certainty(intended: IntendedJoint, found: str, used: Sequence[Joint]) -> tuple[str, str]:
    doubtful = [joint for joint in used if joint.status == "ambiguous"]
    if doubtful:
        return "undecided", f"joint '{doubtful[0].name}' is ambiguous: {doubtful[0].reason}"
    if intended.type not in FROM_GEOMETRY and found != intended.type:
        if intended.type == "screw":
            return "undecided", f"a {found} joint is no screw joint, but geometry shows those only by modelled threads"
        article = "an" if intended.type[0] in "aeio" else "a"
        return "undecided", f"{article} {intended.type} joint is not recognised from geometry yet"
    return "found", ""


def _shares(intended: IntendedJoint, kind: str, found: Array) -> bool:
    """Whether contact of another kind leaves free some of what the intended joint does."""
    wanted = joint_twists(intended)
    if wanted is None or kind == intended.type or not len(found) or not len(wanted):
        return False
    middle = np.zeros(3) if intended.point is None else intended.point

    def at(twists: Array) -> Array:
        return np.concatenate([twists[:, :3], twists[:, 3:] + cross(twists[:, :3], middle)], axis=1)

    together = np.concatenate([at(found), at(wanted)])
    scale = max(float(np.abs(together[:, 3:]).max()), 1e-300)
    together = together / np.r_[np.ones(3), np.full(3, scale)]
    return int(np.linalg.matrix_rank(together, tol=SHARED_MOTION)) < len(found) + len(wanted)


def _slack(patches: list[Patch]) -> tuple[float, float]:
    """Uncertainty of direction and position: of the best curved patch, else of the worst flat one."""
    curved = [p for p in patches if p.kind in ("cylinder", "cone")]
    if curved:
        return min(p.uncertainty[0] for p in curved), min(p.uncertainty[1] for p in curved)
    if not patches:
        return 0.0, 0.0
    return max(p.uncertainty[0] for p in patches), max(p.uncertainty[1] for p in patches)


def _smaller(extents: Extents, bodies: tuple[Body, Body]) -> float:
    """Diagonal (m) of the smaller of the bodies that have one; of the assembly where none has."""
    sizes = [size for body in bodies if (size := extents.diagonal(body.parts)) > 0.0]
    return min(sizes) if sizes else extents.assembly


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
