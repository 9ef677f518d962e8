"""Contact that may be read in two ways: what else is known chooses, or the joint stays ambiguous.

Two things choose. The function, where it states a joint that one of the readings is: the joint is `inferred` then, and
the other reading is kept beside it; nothing but the choice is taken from the function. That a pin in a slot holds is
chosen so, and never that it does not: both sides of the slot are there. And a pin that several bodies hold about one
line is seated in the hole that it stands in, as dowels and bolts are: nothing could drive it along.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.foundation.algebra.vectors import box, cross, foot, norm
from kinform.kinematics.constants import INTENDED_AXIS, SAME_DIRECTION
from kinform.kinematics.joints.bodies.stated_joints import Pair, pair_between
from kinform.kinematics.joints.pair.joint import reading_of, twists_of
from kinform.kinematics.joints.pair.lower_pairs import name_space
from kinform.kinematics.joints.pair.question import Answer
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import EndStop, Joint
from kinform.model.names import BodyName, PartName

Decided = Mapping[Pair, tuple[Answer, Joint]]


def choose_readings(
    assembly: Assembly, of_part: Mapping[PartName, BodyName], decided: Decided, patches: Sequence[Patch], size: float
) -> dict[Pair, tuple[Answer, Joint]]:
    """The decided pairs, with those that may be read in two ways as what chooses reads them.

    `patches` are those of the joints, `size` (m) is that of the assembly.
    """
    wanted = {
        pair: intended
        for intended in assembly.function.joints
        if (pair := pair_between(assembly, of_part, intended.between)) is not None
    }
    seated = _pins(decided, size)
    out: dict[Pair, tuple[Answer, Joint]] = {}
    for pair, (answer, joint) in decided.items():
        if joint.readings and pair in wanted and answer.other is not None:
            out[pair] = _as_intended(wanted[pair], answer, joint, patches)
        elif pair in wanted and joint.status == "determined":
            out[pair] = answer, _in_one_sense_or_both(wanted[pair], joint, patches)
        elif joint.readings and seated.intersection(pair) and joint.readings[0].cause == "stop":
            reason = f"{joint.reason}; a pin that several bodies hold about one line is seated"
            out[pair] = answer, replace(joint, status="determined", reason=reason)
        else:
            out[pair] = answer, joint
    return out


def _in_one_sense_or_both(intended: IntendedJoint, joint: Joint, patches: Sequence[Patch]) -> Joint:
    """What the function states of a joint whose contact only pushes: with the motion that contact ends, or without."""
    if joint.type == intended.type:
        return joint
    both = [one for one in (_at_rest(joint, patches), _closed(joint, patches)) if one is not None]
    located = [one for one in both if one.axis is None or intended.axis is not None]
    return next((one for one in located if _is(one, intended, patches)), joint)


def _at_rest(joint: Joint, patches: Sequence[Patch]) -> Joint | None:
    """The joint of a pair that is drawn at its stop if the stop counts; None where that is no lower pair."""
    if not joint.at_stop:
        return None
    reason = f"{joint.reason}; {joint.type} away from its stop, and as stated while that holds"
    return _with_space(replace(joint, patches=joint.touching, at_stop=()), joint.at_rest, reason, patches)


def _closed(joint: Joint, patches: Sequence[Patch]) -> Joint | None:
    """The joint that contact leaves if the motion that it ends in one sense counts; None where that is no other lower
    pair, or more than one motion: those are no end stop."""
    if len(joint.closed) != len(joint.twists) + 1:
        return None
    ending = tuple(k for k in joint.patches if not _slides_on_itself(patches[k], joint.closed))
    kept = tuple(k for k in joint.patches if k not in ending)
    if not kept:
        return None
    reason = f"{joint.reason}; {joint.type} at rest, and as stated where what goes in one sense counts"
    ends = (*joint.at_stop, *(_end(patches[k], k) for k in ending))
    return _with_space(replace(joint, patches=kept, at_stop=ends), joint.closed, reason, patches, joint)


def _with_space(
    joint: Joint, space: Array, reason: str, patches: Sequence[Patch], other: Joint | None = None
) -> Joint | None:
    """The joint with the freedoms (k, 6), as inferred; None where they are no lower pair. `other` is kept as the other
    reading, or else the joint itself."""
    frame = Frame.of(np.concatenate([patches[k].points for k in joint.patches]))
    form = name_space(span(scaled(space.T, frame)) if len(space) else np.zeros((6, 0)), frame)
    if form.type == "general":
        return None
    point = form.point
    if point is not None and form.axis is not None:
        point = foot(point, form.axis, frame.centre)
    return replace(
        joint,
        type=form.type,
        axis=form.axis,
        point=point,
        pitch=form.pitch,
        freedoms=len(space),
        twists=twists_of(form.type, form.axis, point, form.pitch),
        status="inferred",
        reason=reason,
        evidence=(*joint.evidence, "function"),
        readings=(reading_of(replace(other or joint, blockers=()), "end"),),
    )


def _slides_on_itself(patch: Patch, motions: Array) -> bool:
    """Whether a patch keeps contact under each of these motions (k, 6)."""
    speeds = motions[:, None, 3:] + cross(motions[:, None, :3], patch.points[None])
    across = np.abs(np.einsum("kni,ni->kn", speeds, patch.normals)).max(axis=1)
    return bool((across <= INTENDED_AXIS * np.linalg.norm(speeds, axis=2).max(axis=1)).all())


def _end(patch: Patch, index: int) -> EndStop:
    """What a patch ends of a joint that is stated."""
    return EndStop(patch.parts, index, patch.area, patch.points.mean(axis=0), 0, "a stated motion in one sense")


def _as_intended(
    intended: IntendedJoint, answer: Answer, joint: Joint, patches: Sequence[Patch]
) -> tuple[Answer, Joint]:
    """The reading that is the intended joint, as inferred; unchanged where none is."""
    assert answer.other is not None
    first, second = joint, answer.other
    open_to = (first,) if joint.readings[0].cause == "pin" else (first, second)
    chosen = next((j for j in open_to if _is(j, intended, patches)), None)
    if chosen is None:
        return answer, joint
    left = reading_of(first, "stop" if first.blockers else "") if chosen is second else joint.readings[0]
    reason = f"{joint.reason}; the function states {chosen.type}: {intended.name}"
    strict = joint.twists if chosen is second else answer.strict
    inferred = replace(
        chosen, status="inferred", reason=reason, evidence=(*chosen.evidence, "function"), readings=(left,)
    )
    return replace(answer, strict=strict), inferred


def _is(joint: Joint, intended: IntendedJoint, patches: Sequence[Patch]) -> bool:
    """Is it the intended joint: of its type, with its axis and place as far as these are stated?

    By how much axes may differ is said by the contact; what is left over is a finding (KF403, KF404).
    """
    if joint.type != intended.type:
        return False
    if joint.axis is None or intended.axis is None:
        return True
    if norm(cross(joint.axis, intended.axis)) > INTENDED_AXIS:
        return False
    if intended.point is None or joint.point is None or joint.type in ("prismatic", "planar"):
        return True
    apart = joint.point - foot(intended.point, joint.axis, joint.point)
    low, high = box(np.concatenate([patches[k].points for k in joint.patches]))
    # Share of the size of a contact by which the place of an intended joint may be off that of the reading that it
    # chooses. Chosen, not measured.
    return norm(apart) <= 0.1 * norm(high - low)


def _pins(decided: Decided, size: float) -> set[BodyName]:
    """Bodies that at least two others hold about one line, and nothing else."""
    joints: dict[BodyName, list[Joint]] = {}
    for pair, (_, joint) in decided.items():
        for name in pair:
            joints.setdefault(name, []).append(joint)
    return {name for name, of in joints.items() if len(of) > 1 and _about_one_line(of, size)}


def _about_one_line(joints: Sequence[Joint], size: float) -> bool:
    lead = next((j for j in joints if j.type in ("revolute", "cylindrical") and j.axis is not None), None)
    if lead is None or lead.axis is None or lead.point is None:
        return False
    for joint in joints:
        if joint.type not in ("revolute", "cylindrical", "planar", "screw") or joint.axis is None:
            return False
        if norm(cross(joint.axis, lead.axis)) > SAME_DIRECTION:
            return False
        if joint.type != "planar" and joint.point is not None:
            apart = joint.point - foot(lead.point, lead.axis, joint.point)
            if norm(apart) > SAME_DIRECTION * size:
                return False
    return True
