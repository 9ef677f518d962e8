"""What contact decides of one pair of bodies, from all that it depends on.

A `Question` does not hold which surfaces of a mesh touch, nor the names of the bodies: a change of those changes no
`Answer`, so that one of an earlier run may stand for it (`kinematics.step_cache`).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice

from kinform.foundation.algebra.screws import twist_at_origin
from kinform.foundation.records import altered
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.kinematics.joints.pair.extremes import extreme_samples
from kinform.kinematics.joints.pair.joint import joint_from_decision, misalignment
from kinform.model.arrays import Array, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, JointName
from kinform.model.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class Question:
    """What two bodies may do relative to each other, by the contact between them."""

    members: tuple[tuple[Patch, bool], ...]
    """Bare patches; turned where part a belongs to the second body."""
    tolerances: Tolerances
    contact: float
    """m: the contact tolerance of the pair."""
    size: float
    """m: diagonal of the smaller body."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What the contact of two bodies says on its own."""

    extremes: tuple[Ints, ...]
    """Samples that bound each patch, ascending."""
    joint: Joint | None
    """Of bodies without names, and with patches by their place in the question; None where no patch has an area."""
    strict: Array | None = None
    """(k, 6) freedoms when every patch counts, of a blocked joint."""
    angle: float = 0.0
    """rad: misalignment beyond clearance and uncertainty."""
    offset: float = 0.0
    """m."""
    other: Joint | None = None
    """The other reading of an ambiguous joint (`Joint.readings`), as a joint."""


def bare_patches(patches: Sequence[Patch]) -> tuple[Patch, ...]:
    """The patches without the numbers of their surfaces, which stand for nothing but themselves."""
    return tuple(altered(patch, surfaces=(-1, -1)) for patch in patches)


def answer_each(questions: Sequence[Question]) -> list[Answer]:
    """The joints that the contacts leave, each with the samples that bound its patches."""
    bounds = iter(extreme_samples([patch for question in questions for patch, _ in question.members]))
    return [_answer(question, tuple(islice(bounds, len(question.members)))) for question in questions]


def _answer(question: Question, extremes: tuple[Ints, ...]) -> Answer:
    members = [(k, patch, turned) for k, (patch, turned) in enumerate(question.members)]
    evidence = gather(members, question.tolerances, question.contact, question.size)
    if evidence is None:
        return Answer(extremes, None)
    decision = decide(evidence, question.tolerances, [extremes[item.index] for item in evidence.items])
    joint = joint_from_decision((BodyName(""), BodyName("")), evidence, decision)
    blocked = decision.status == "blocked"
    strict = twist_at_origin(decision.strict, evidence.frame).T if blocked else None
    other = None if decision.other is None else joint_from_decision(joint.bodies, evidence, decision.other)
    return Answer(extremes, joint, strict, *misalignment(evidence, decision), other)


def joint_between(joint: Joint, pair: tuple[BodyName, BodyName], indices: Sequence[int]) -> Joint:
    """The joint of an answer as that of these two bodies, whose patches have these indices into Contacts.patches."""
    return altered(
        joint,
        name=JointName(f"{pair[0]}~{pair[1]}"),
        bodies=pair,
        patches=tuple(indices[k] for k in joint.patches),
        blockers=tuple(altered(blocker, patch=indices[blocker.patch]) for blocker in joint.blockers),
        at_stop=tuple(altered(stop, patch=indices[stop.patch]) for stop in joint.at_stop),
    )
