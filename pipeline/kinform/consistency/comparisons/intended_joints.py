"""Intended joints beside the joints that geometry gives: type, direction, position, pitch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kinform.consistency.comparisons.comparison import FROM_GEOMETRY, Comparison, ComparisonState
from kinform.consistency.comparisons.known import Known
from kinform.consistency.comparisons.with_play import with_play
from kinform.consistency.questions.rolling_elements import Rolling
from kinform.consistency.questions.through_intermediates import IntermediateMotion, motion_through_intermediates
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import TINY
from kinform.foundation.words import counted, quoted
from kinform.kinematics.joints.bodies.admitted import admits
from kinform.kinematics.joints.bodies.joints_in_force import leaves_free, may_end
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Interference, Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import FREEDOMS, Body, Joint, Kinematics, UndeclaredJoint

SHARED_MOTION = 0.02
"""Share of a motion within which what contact leaves is what a loop's closure leaves, too."""
MISSED_SIGMAS = 2.0
"""Standard uncertainties of a found axis beyond which it is elsewhere than stated: 95 % of errors are smaller."""

ANOTHER_AXIS = 0.5**0.5
"""Cosine between axes below which one is not the other, tilted: nearer to square than to parallel."""


def compare_joints(
    assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics, intended: Iterable[IntendedJoint]
) -> list[Comparison]:
    """The intended joints beside what the geometry of their two bodies, and of loose parts that connect them, leaves
    free."""
    known = Known(assembly, contacts, kinematics)
    return [with_play(_compared(assembly, contacts, kinematics, one, known), known) for one in intended]


def _compared(
    assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics, intended: IntendedJoint, known: Known
) -> Comparison:
    first, second = (kinematics.body_of(assembly.parts_of(name)[0]) for name in intended.between)
    bodies = (first, second)
    if first.name == second.name:
        reason = first.why_one
        one = loose_joint(assembly, kinematics, intended)
        if one is None:
            return Comparison(intended, bodies, "one body", reason, type="fixed")
        freedoms = FREEDOMS[one.type]
        return Comparison(
            intended, bodies, "one body", reason, one.type, one.axis, one.point, freedoms=freedoms, loose=True
        )
    direct = next(iter(kinematics.joints_between(first.name, second.name)), None)
    if (direct is None or not direct.patches) and (overlap := _overlap(contacts, bodies)) is not None:
        depth = f"{quoted(overlap.parts)} overlap by {1e3 * overlap.depth:.2g} mm where nothing mates"
        return Comparison(intended, bodies, "undecided", f"{depth}: what holds there is not known", joint=direct)
    if direct is not None and direct.status == "stated":
        return Comparison(intended, bodies, "taken", direct.reason, joint=direct)
    if direct is not None and direct.evidence == ("function",):
        return Comparison(intended, bodies, "stated", "the joint is taken from the function", joint=direct)
    size = known.smaller(bodies)
    every = contacts.patches if contacts is not None else ()
    motion = motion_through_intermediates(kinematics, every, first.name, second.name, known.named, size)
    used: tuple[Joint, ...] = (direct,) if direct is not None else ()
    if motion is not None:
        used = motion.joints
    if not used:
        return Comparison(intended, bodies, "absent")
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
    if state == "found" and motion is None and direct is not None:
        state, reason = _end_certainty(intended, direct, patches, first, size)
    if state == "found" and intended.closure and found is not None and _shares(intended, form.type, found):
        state, reason = "undecided", f"it only closes a loop, and by contact that joint is {form.type}"
    admitted = False
    if state == "found" and motion is None and direct is not None and _another_motion(direct, intended):
        wanted = joint_twists(intended)
        admitted = wanted is not None and admits(
            [every[k] for k in direct.touching], wanted, _first(kinematics, direct).parts
        )
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
        through=motion.intermediates if motion is not None else (),
        angle_slack=MISSED_SIGMAS * angle_slack,
        position_slack=MISSED_SIGMAS * position_slack,
        size=size,
        angle_limit=assembly.tolerances.angle_limit(),
        position_limit=assembly.tolerances.offset_limit(size),
        admitted=admitted,
    )


def _another_motion(found: Joint, intended: IntendedJoint) -> bool:
    """Whether the joint is of another type than intended, or its axis is nearer to square than to the intended one."""
    if found.type != intended.type or found.axis is None or intended.axis is None:
        return found.type != intended.type
    return abs(float(found.axis @ intended.axis)) < ANOTHER_AXIS


def _overlap(contacts: Contacts | None, bodies: tuple[Body, Body]) -> Interference | None:
    """The deepest overlap of parts of two bodies; None where there is none."""
    sides = [set(body.parts) for body in bodies]
    among = [
        one
        for one in (() if contacts is None else contacts.interferences)
        if any(one.parts[0] in a and one.parts[1] in b for a, b in (sides, sides[::-1]))
    ]
    return max(among, key=lambda one: (one.depth, one.parts), default=None)


def _first(kinematics: Kinematics, joint: Joint) -> Body:
    """The first body of a joint."""
    return next(body for body in kinematics.bodies if body.name == joint.bodies[0])


def loose_joint(assembly: Assembly, kinematics: Kinematics, intended: IntendedJoint) -> UndeclaredJoint | None:
    """What contact alone would make of a joint that is stated as fixed, where it would part its sides."""
    if intended.type != "fixed":
        return None
    first, second = (assembly.parts_of(name)[0] for name in intended.between)
    return next((one for one in kinematics.left_out or () if one.parts(first, second)), None)


def _rolling_certainty(
    intended: IntendedJoint, motion: IntermediateMotion, through: Rolling, size: float
) -> tuple[ComparisonState, str]:
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
        f"points and lines of contact with {quoted(motion.intermediates)} leave "
        f"{counted(motion.freedoms, 'freedom')} at this instant; over a distance that may be the intended one alone"
    )


def _end_certainty(
    intended: IntendedJoint, found: Joint, patches: Sequence[Patch], first: Body, size: float
) -> tuple[ComparisonState, str]:
    """Whether it is known that a line of contact holds, which may only end what is intended, in one sense."""
    wanted, lines = joint_twists(intended), [patch for patch in patches if patch.kind == "line"]
    if found.type == intended.type or wanted is None or not lines:
        return "found", ""
    if not may_end(patches, found.twists, wanted, lines[0].point, size, first.parts):
        return "found", ""
    return (
        "undecided",
        f"the line in which {quoted(lines[0].parts)} touch holds it in one sense alone, and may be a stop",
    )


def _certainty(intended: IntendedJoint, found: str, used: Sequence[Joint]) -> tuple[ComparisonState, str]:
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
    scale = max(float(np.abs(together[:, 3:]).max()), TINY)
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
