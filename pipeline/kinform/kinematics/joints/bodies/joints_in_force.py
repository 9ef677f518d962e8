"""`[function] complete = true`: whether contact or the function decides each joint.

The pins and bearings of most assemblies are in no mesh: parts end at a flush plane, or with a gap. Where the function
states all joints:

- A joint that contact determines as stated is kept as derived.
- One that contact leaves free, with more freedoms beside, is taken as stated (`stated`), and so is one whose bodies do
  not touch; what contact says is kept as a reading.
- One that points and lines hold, as the balls of a bearing do, is `inferred`.
- One that contact certainly forbids, in both senses, is kept as derived: the function never overrides contact. A face
  that the motion only leaves (a closed lid, a retracted cylinder) forbids nothing.
- Where contact is ambiguous or blocked the joint is taken as stated, and the doubt is kept.

Contact between bodies that stated joints move relative to each other, without a joint of their own, constrains nothing
(`ignored_contacts`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.kinematics.constants import INTENDED_AXIS
from kinform.kinematics.joints.bodies.admitted import admits
from kinform.kinematics.joints.bodies.complete_function import complete_joints, without_effect
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.stated_joints import Pair, joint_form, pair_between
from kinform.kinematics.joints.pair.joint import reading_of, stated_joint
from kinform.kinematics.joints.pair.touches import ends_at_line
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint, ReadingCause, body_of_part
from kinform.model.names import PartName


@dataclass(frozen=True, eq=False)
class JointsInForce:
    """The joints in force, and what contact would hold that constrains nothing."""

    joints: tuple[Joint, ...]
    ignored: tuple[Joint, ...]


def joints_in_force(
    assembly: Assembly,
    merger: Merger,
    joints: Sequence[Joint],
    beside: Sequence[Joint],
    patches: Sequence[Patch],
    *,
    whole: bool,
) -> JointsInForce:
    """Joints by contact, sorted by their bodies, in the light of a function that states all joints.

    `beside`: of bodies that it moves by other joints. `whole`: it states those of all parts; else contact of bodies
    that none of its joints reaches stays.
    """
    of_part = body_of_part(merger.bodies())
    meshed = {of_part[part.name] for part in assembly.parts if part.mesh is not None}
    wanted: dict[Pair, list[IntendedJoint]] = {}
    for intended in sorted(complete_joints(assembly), key=lambda joint: joint.name):
        pair = pair_between(assembly, of_part, intended.between)
        if pair is not None and intended.type != "fixed" and meshed.issuperset(pair):
            wanted.setdefault(pair, []).append(intended)
    derived = {joint.bodies: joint for joint in joints}
    assumed = {pair for a in assembly.assumptions if (pair := pair_between(assembly, of_part, a.between)) is not None}
    sticks = {joint.bodies for joint in joints if not joint.patches}
    idle = without_effect(assembly, merger)
    some_part = {body: part for part, body in of_part.items()}
    out = []
    aside = [joint for joint in beside if joint.bodies not in assumed]
    for pair in sorted({*derived, *wanted}):
        joint = derived.get(pair)
        if pair in wanted and pair not in assumed:
            forms = [joint_form(assembly, of_part, one, pair) for one in wanted[pair]]
            stated = [stated_joint(pair, form, "function", "") for form in forms]
            first = {part for part, body in of_part.items() if body == pair[0]}
            out.append(_in_force(wanted[pair], stated, joint, patches, first))
        elif joint is not None and (
            pair in assumed or pair in sticks or not (whole or idle(*(some_part[name] for name in pair)))
        ):
            out.append(joint)
        elif joint is not None:
            aside.append(joint)
    return JointsInForce(tuple(out), tuple(joint for joint in aside if not _unknown(joint, patches)))


def leaves_free(twists: Array, motions: Array, place: Array, length: float, missing: float = INTENDED_AXIS) -> bool:
    """Whether a joint that allows `twists` (n, 6) lets a body do all of these motions (k, 6), but for a share `missing`
    of each; twists as (ω; v at the world's origin).

    Speeds are compared at `place` (3,) m; `length` (m), of the contact or the bodies, makes turns and slides alike.
    """
    if not len(motions):
        return True
    if not len(twists):
        return False
    scale = np.r_[np.ones(3), np.full(3, 1.0 / length)]
    own, asked = _at(twists, place) * scale, _at(motions, place) * scale
    basis, _ = np.linalg.qr(own.T)
    left = asked - asked @ basis @ basis.T
    return bool((np.linalg.norm(left, axis=1) <= missing * np.linalg.norm(asked, axis=1)).all())


def _at(twists: Array, place: Array) -> Array:
    """Twists (k, 6) with their velocities at a place instead of the origin."""
    return np.concatenate([twists[:, :3], twists[:, 3:] + cross(twists[:, :3], place)], axis=1)


def opens(patches: Sequence[Patch], motions: Array, first: Collection[PartName]) -> bool:
    """Whether these motions (k, 6) of the second body, in one sense, leave all contact that they do not slide along:
    one motion, or several of which the contact opposes one combination, as a point does; `first` are the parts of the
    first body."""
    rows = []
    for patch in patches:
        side = 1.0 if patch.parts[0] in first else -1.0
        speeds = motions[:, None, 3:] + cross(motions[:, None, :3], patch.points[None])
        across = side * np.einsum("kni,ni->nk", speeds, patch.normals)
        pace = np.linalg.norm(speeds, axis=2).max(axis=1, initial=0.0)
        rows.append(across[np.any(np.abs(across) > INTENDED_AXIS * pace, axis=1)])
    found = np.concatenate(rows)
    return len(found) == 0 or len(set(np.sign(found @ found[0]))) == 1


def may_end(
    patches: Sequence[Patch],
    twists: Array,
    motions: Array,
    place: Array,
    length: float,
    first: Collection[PartName],
) -> bool:
    """Whether a body that allows `twists` (n, 6) by these patches may as well do all of these motions (k, 6), and only
    ends one of them at a line, in one sense; `place`, `length` and `first` as above."""
    return ends_at_line(patches) and leaves_free(motions, twists, place, length) and opens(patches, motions, first)


def _in_force(
    wanted: Sequence[IntendedJoint],
    stated: Sequence[Joint],
    joint: Joint | None,
    patches: Sequence[Patch],
    first: Collection[PartName],
) -> Joint:
    """The joint between two bodies that the function joins, by one or more joints; `joint` is that of contact, `first`
    the parts of the first body."""
    types = [one.type for one in wanted]
    if joint is not None and joint.type in types and joint.status != "ambiguous":
        return joint
    chosen = types.index(joint.type) if joint is not None and joint.type in types else 0
    name, taken = wanted[chosen].name, stated[chosen]
    if joint is None or not joint.patches or _unknown(joint, patches):
        what = "do not touch" if joint is None or not joint.patches else "touch in no known way"
        return replace(taken, status="stated", reason=f"the bodies {what}: '{name}' is taken as stated", motion="")
    corners = np.concatenate([patches[k].points for k in joint.patches])
    place = corners.mean(axis=0) if taken.point is None else taken.point
    reach = _reach(corners, place)
    if _is_just(joint, taken, place, reach):
        return _held_otherwise(taken, joint, name)
    cause: ReadingCause
    if joint.status in ("ambiguous", "blocked"):
        cause, why = "doubt", "contact leaves it undecided"
    elif "screw" in (joint.type, taken.type) and joint.freedoms == len(taken.twists):
        return joint  # as many freedoms, and others, however little a fine thread advances
    elif leaves_free(joint.twists, taken.twists, place, reach) and _in_bowls(joint, patches):
        cause, why = (
            "doubt",
            "points in bowls hold more over a distance than at this instant, and how much is not known",
        )
    elif leaves_free(joint.twists, taken.twists, place, reach):
        cause, why = "contact", "contact leaves it free and does not hold it"
    elif may_end([patches[k] for k in joint.patches], joint.twists, taken.twists, place, reach, first):
        cause, why = "doubt", "a line of contact holds it in one sense alone, and may be a stop"
    elif admits([patches[k] for k in joint.touching], taken.twists, first):
        cause, why = "end", "contact leaves it free in one sense, as an end stop does, and does not hold it"
    else:
        return joint
    return replace(
        taken,
        status="stated",
        reason=f"'{name}' is taken as stated: {why}; by contact {joint.status} {joint.type}: {joint.reason}",
        motion=joint.motion or counted(joint.freedoms, "freedom"),
        evidence=(*joint.evidence, "function"),
        patches=joint.patches,
        singular_values=joint.singular_values,
        readings=(replace(reading_of(replace(joint, blockers=()), ""), cause=cause),),
    )


def _is_just(joint: Joint, taken: Joint, place: Array, reach: float) -> bool:
    """Whether contact is no lower pair, as of the balls of a bearing, and surely leaves what is stated and no more."""
    known = (joint.type, joint.status, joint.freedoms) == ("general", "determined", len(taken.twists))
    return known and leaves_free(joint.twists, taken.twists, place, reach, SINGLE)


def _held_otherwise(taken: Joint, joint: Joint, name: str) -> Joint:
    """The stated joint, which contact at points or along lines holds."""
    return replace(
        taken,
        status="inferred",
        reason=f"contact leaves what '{name}' lets move, and no more, though it is no {taken.type} pair: "
        f"{joint.reason}",
        motion="",
        evidence=(*joint.evidence, "function"),
        patches=joint.patches,
        singular_values=joint.singular_values,
    )


def _in_bowls(joint: Joint, patches: Sequence[Patch]) -> bool:
    """Whether it is held by several balls in bowls, as those of a self-aligning bearing are in its ring."""
    return sum(patches[k].kind == "point" and patches[k].bends for k in joint.patches) > 1


def _reach(corners: Array, place: Array) -> float:
    """m: how far a contact reaches, with corners (n, 3) and asked about at a place (3,). One at a point has no size,
    and its distance counts."""
    # Of its distance from a stated joint, a contact at a point has at least this size: what blocks a turn there must
    # not seem small beside what a metre would. Chosen, not measured.
    return max(norm(np.ptp(corners, axis=0)), 1e-3 * norm(corners.mean(axis=0) - place)) or 1.0


def _unknown(joint: Joint, patches: Sequence[Patch]) -> bool:
    """Whether all that touches does so in no known way."""
    return bool(joint.patches) and all(patches[k].unknown for k in joint.patches)
