"""Joints from decisions, from assumptions and from the stated function, in one form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross, foot, norm, perpendicular, weighted_mean, widest_gap
from kinform.kinematics.joints.pair.decision import Decision
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.hypotheses import Motion, motion_words
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.one_sided import BESIDE_AXIS
from kinform.kinematics.joints.pair.suspects import ROLES
from kinform.kinematics.joints.pair.uncertainty import disagreement, joint_uncertainty
from kinform.kinematics.screws.canonical_basis import canonical_twists
from kinform.kinematics.screws.wording import direction_words, motions_in_words
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array
from kinform.model.kinematics import FREEDOMS, Blocker, EndStop, Joint, Reading, ReadingCause
from kinform.model.names import BodyName, JointName

LEAST_MISALIGNMENT = 1e-4
"""rad, and share of the contact's size, of misalignment that is told. A hundredth of a degree, or 10 µm on 100 mm: less
is not worth a word."""


def twists_of(
    kind: str, axis: Array | None, point: Array | None, pitch: float | None = None, axis2: Array | None = None
) -> Array:
    """Basis (f, 6) of the twists (ω; v at the world's origin) that a joint of this type allows."""
    zero = np.zeros(3)

    def turn(about: Array, lead: float = 0.0) -> Array:
        assert point is not None
        return np.concatenate([about, cross(point, about) + lead * about])

    if kind == "spherical":
        return np.array([turn(e) for e in np.eye(3)])
    if kind == "fixed" or axis is None:
        return np.zeros((0, 6))
    slide = np.concatenate([zero, axis])
    if kind == "prismatic":
        return slide[None]
    if kind == "revolute":
        return turn(axis)[None]
    if kind == "screw":
        return turn(axis, (pitch or 0.0) / (2.0 * np.pi))[None]
    if kind == "cylindrical":
        return np.array([turn(axis), slide])
    if kind == "universal":
        return np.array([turn(axis), turn(axis2 if axis2 is not None else perpendicular(axis)[0])])
    u, v = perpendicular(axis)
    return np.array([turn(axis), np.concatenate([zero, u]), np.concatenate([zero, v])])


def joint_from_decision(bodies: tuple[BodyName, BodyName], evidence: Evidence, decision: Decision) -> Joint:
    """The joint between two bodies as their contact decides it."""
    form, frame = decision.form, evidence.frame
    kept = [evidence.items[k] for k in decision.kept]
    point = form.point
    if point is not None and form.axis is not None:
        weights = np.concatenate([item.weights for item in kept])
        middle = weighted_mean(np.concatenate([i.points for i in kept]), weights)
        point = middle if form.type in ("prismatic", "planar") else foot(point, form.axis, middle)
    if form.type == "general":
        twists = canonical_twists(decision.basis, frame)
    else:
        twists = twists_of(form.type, form.axis, point, form.pitch)
    blocking = [(evidence.items[k], motion) for k, motion in decision.left_out]
    total = float(evidence.areas.sum())
    blockers = tuple(
        Blocker(
            parts=item.patch.parts,
            patch=item.index,
            area=item.patch.area,
            share=item.area / total,
            place=weighted_mean(item.points, item.weights),
            gap=item.patch.gap,
            forbids=motion_words(motion),
        )
        for item, motion in blocking
    )
    direction, place = joint_uncertainty(kept, form)
    cone = decision.cone
    joint = Joint(
        name=JointName(f"{bodies[0]}~{bodies[1]}"),
        bodies=bodies,
        type=form.type,
        axis=form.axis,
        point=point,
        axis2=None,
        pitch=form.pitch,
        freedoms=decision.basis.shape[1],
        twists=twists,
        evidence=tuple(sorted({item.patch.kind for item in kept})),
        status=decision.status,
        reason=decision.reason,
        patches=tuple(sorted(item.index for item in kept)),
        blockers=blockers,
        singular_values=decision.singular_values,
        motion=motions_in_words(decision.basis, frame),
        axis_uncertainty=max(direction, disagreement(kept, form)),
        point_uncertainty=place,
    )
    if cone is not None:
        at_rest = canonical_twists(cone.rest, frame)
        joint = replace(
            joint,
            at_rest=at_rest,
            closed=canonical_twists(cone.closed, frame) if cone.extra else at_rest,
            open=cone.plainly_open or cone.withdraws,
            at_stop=tuple(_end_stop(evidence.items[k], motion, sense, form) for k, motion, sense in decision.ended),
        )
    if decision.other is None:
        return joint
    return replace(
        joint, readings=(reading_of(joint_from_decision(bodies, evidence, decision.other), decision.other.role),)
    )


def _end_stop(item: Item, motion: Motion, sense: float, form: JointForm) -> EndStop:
    """What a patch ends, of a turn in one sense; senses count about the joint's axis."""
    along = 1.0 if form.axis is None or float(form.axis @ motion.axis) >= 0.0 else -1.0
    return EndStop(
        parts=item.patch.parts,
        patch=item.index,
        area=item.patch.area,
        place=weighted_mean(item.points, item.weights),
        sense=int(sense * along),
        ends=f"the turn about {direction_words(sense * motion.axis)}",
    )


def reading_of(joint: Joint, cause: ReadingCause) -> Reading:
    """What a joint says, as one reading of the contact; `cause` names what its blockers are then."""
    area = 1e6 * sum(blocker.area for blocker in joint.blockers)
    parts = " and ".join(max(joint.blockers, key=lambda b: (b.area, b.parts)).parts) if joint.blockers else ""
    words = f"{joint.type}, if {area:.3g} mm² between {parts} are {ROLES[cause]}" if parts else joint.type
    return Reading(joint.type, joint.axis, joint.point, joint.pitch, joint.freedoms, cause, words)


def stated_joint(bodies: tuple[BodyName, BodyName], form: JointForm, evidence: str, reason: str) -> Joint:
    """A joint that somebody stated: an assumption, the function of a stick body, or a suggestion that is applied."""
    axis = None if form.axis is None else canonical(form.axis)
    point = np.zeros(3) if form.point is None and form.type in ("planar", "prismatic") else form.point
    return Joint(
        name=JointName(f"{bodies[0]}~{bodies[1]}"),
        bodies=bodies,
        type=form.type,
        axis=axis,
        point=point if form.type != "fixed" else None,
        axis2=None if form.axis2 is None else canonical(form.axis2),
        pitch=form.pitch,
        freedoms=FREEDOMS[form.type],
        twists=twists_of(form.type, axis, point, form.pitch, form.axis2),
        evidence=(evidence,),
        status="inferred",
        reason=reason,
        patches=(),
        blockers=(),
        singular_values=np.full(6, np.nan),
    )


def misalignment(evidence: Evidence, decision: Decision) -> tuple[float, float]:
    """Greatest angle (rad) and offset (m) between the two sides of the kept patches, beyond what
    their clearance, their unevenness and the uncertainty of both fits allow; 0 where there is none."""
    angle = offset = 0.0
    for k in decision.kept:
        item = evidence.items[k]
        patch = item.patch
        if patch.one_sided:
            continue
        clearance = max(patch.gap, 0.0) if patch.kind in COAXIAL else 0.0
        engaged = float(np.ptp(item.points @ patch.axis)) if clearance else 0.0
        allowed = 2.0 * clearance / engaged if engaged > 0.0 else 0.0
        allowed += _unevenness(item)
        excess = patch.misalignment - allowed - SIGMAS * max(patch.uncertainty[0], patch.mismatch[0])
        angle = max(angle, excess if excess > LEAST_MISALIGNMENT else 0.0)
        if patch.kind in (*COAXIAL, "sphere"):
            known = SIGMAS * max(patch.uncertainty[1], patch.mismatch[1])
            far = patch.offset - _apart_unseen(item) - known - patch.chord
            offset = max(offset, far if far > LEAST_MISALIGNMENT * evidence.frame.length else 0.0)
    return angle, offset


def _apart_unseen(item: Item) -> float:
    """m by which the axes of two sides may differ that lie on each other. Round the axis it is their clearance; arcs
    that lie beside it touch from within whichever of their radii is larger, their axes by the difference apart."""
    patch = item.patch
    beside = patch.kind in COAXIAL and widest_gap(item.normals, patch.axis) > BESIDE_AXIS
    return abs(patch.gap) if beside else max(patch.gap, 0.0)


def _unevenness(item: Item) -> float:
    """rad by which facets of a plane face that is not quite flat may lean, over the extent of the patch."""
    if item.patch.kind != "plane" or not item.patch.chord:
        return 0.0
    extent = norm(np.ptp(item.points, axis=0))
    return 2.0 * item.patch.chord / extent if extent > 0.0 else 0.0
