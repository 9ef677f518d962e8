"""The two halves of the kinematics, each by all that it depends on: what one pair of bodies does, and what follows of all.

A pair is decided from a `Question` alone, and everything beyond the pairs from a `Decided` alone, so that whoever knows
the answer to the same one (`Answers`) need not ask again. Neither holds which surfaces of a mesh touch, or a shape that no
contact tells of: a change of those changes nothing here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.certainty import TOUCHING
from kinform.kinematics.decide import decide
from kinform.kinematics.evidence import gather
from kinform.kinematics.joints import joint_from_decision, misalignment
from kinform.kinematics.screws import twist_at_origin
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Joint, Kinematics
from kinform.model.names import BodyName, JointName, PartName
from kinform.model.tolerances import Tolerances

__all__ = ["Answer", "Answers", "Decided", "Question", "answered", "bare_patches", "named", "touching_shapes"]

Array = NDArray[np.float64]


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
    """The joint, of bodies without names and with patches by their place in the question."""

    joint: Joint
    strict: Array | None
    """(k, 6) freedoms when every patch counts, of a blocked joint."""
    angle: float
    """rad: misalignment beyond clearance and uncertainty."""
    offset: float
    """m."""


@dataclass(frozen=True, eq=False)
class Decided:
    """All joints of an assembly before their axes are made to agree, and what else the whole follows from."""

    assembly: Assembly
    """With shapes of parts that touch along lines or at points only."""
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    patches: tuple[Patch, ...]
    """Bare."""
    strict: Mapping[JointName, Array]
    misaligned: tuple[tuple[str, float, float], ...]
    size: float
    """m: diagonal of the assembly."""
    clusters: tuple[Body, ...]
    balls: Mapping[tuple[int, PartName], Array]


class Answers(Protocol):
    """Somebody who knows, or computes, both halves."""

    def pair(self, question: Question, compute: Callable[[Question], Answer | None]) -> Answer | None:
        """What `compute` gives for the question; None where no patch has an area."""

    def whole(self, decided: Decided, compute: Callable[[Decided], Kinematics]) -> Kinematics:
        """What `compute` gives for all pairs together."""


def bare_patches(patches: Sequence[Patch]) -> tuple[Patch, ...]:
    """The patches without the numbers of their surfaces, which stand for nothing but themselves."""
    return tuple(replace(patch, surfaces=(-1, -1)) for patch in patches)


def touching_shapes(assembly: Assembly, patches: Sequence[Patch]) -> Assembly:
    """The assembly with the meshes of those parts only whose outlines say more than their patches: teeth and cams."""
    told = {name for patch in patches if patch.kind in TOUCHING for name in patch.parts}
    parts = (
        part if part.name in told else replace(part, mesh=None, density=None, override=None) for part in assembly.parts
    )
    return replace(assembly, parts=tuple(parts))


def answered(question: Question) -> Answer | None:
    """The joint that the contact leaves; None where no patch has an area."""
    members = [(k, patch, turned) for k, (patch, turned) in enumerate(question.members)]
    evidence = gather(members, question.tolerances, question.contact, question.size)
    if evidence is None:
        return None
    decision = decide(evidence, question.tolerances)
    joint = joint_from_decision((BodyName(""), BodyName("")), evidence, decision)
    strict = twist_at_origin(decision.strict, evidence.frame).T if decision.status == "blocked" else None
    return Answer(joint, strict, *misalignment(evidence, decision))


def named(answer: Answer, pair: tuple[BodyName, BodyName], indices: Sequence[int]) -> Joint:
    """The joint of these two bodies, whose patches have these indices into Contacts.patches, ascending."""
    return replace(
        answer.joint,
        name=JointName(f"{pair[0]}~{pair[1]}"),
        bodies=pair,
        patches=tuple(indices[k] for k in answer.joint.patches),
        blockers=tuple(replace(blocker, patch=indices[blocker.patch]) for blocker in answer.joint.blockers),
    )
