"""Joints and mobility from contacts: screw algebra, constraint rows, decisions, loop closure.

`derivation` is the method of the stage, from contacts to `model.kinematics.Kinematics`. The rooms, in the order in
which one reads them; each knows those before it and none after it (separation needs `pair` and `answers` only):

- `pair`: the joint of two bodies, from the contact between them. Its docstring tells how a joint is decided.
- `partition`: which parts are one body where the function states all joints, and which joints may be meant where it
  states none.
- `bodies`: which parts are one body, and which bodies have a joint.
- `loops`: closure of the loops that joints make. Its docstring tells how a loop is closed.
- `axes`: joint axes made exactly consistent across the assembly.
- `mobility`: freedoms of the whole, their finite counterparts, redundancy, couplings.
- `separation`: J, and what comes apart.
- `questions`: what users ask of all that.

Beside them `constants` has every number that decides, with its reason; `wording` puts spaces of motions and of forces
in words; `answers` is how steps are found that an earlier run has taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazily import first_used

if TYPE_CHECKING:
    from kinform.kinematics.axes.higher_pairs import is_higher
    from kinform.kinematics.derivation import derive, functional, idle_within, mobility_within
    from kinform.kinematics.mobility.couplings import coupling_aside
    from kinform.kinematics.mobility.named_freedoms import Motions
    from kinform.kinematics.partition import propose, proposed_joints, stated_proposals
    from kinform.kinematics.questions.adrift import adrift, adrift_in_words
    from kinform.kinematics.questions.afloat import Afloat, AfloatParts
    from kinform.kinematics.questions.intended_freedoms import IntendedAnswer, IntendedMotion, intended_answers
    from kinform.kinematics.questions.joint_insight import Insight, insight
    from kinform.kinematics.questions.motion_query import QueryAnswer, QueryBlocker, query
    from kinform.kinematics.questions.near_motion import Correction, NearMotion, near_motions

__all__ = [
    "CODE_VERSION",
    "Afloat",
    "AfloatParts",
    "Correction",
    "Insight",
    "IntendedAnswer",
    "IntendedMotion",
    "Motions",
    "NearMotion",
    "QueryAnswer",
    "QueryBlocker",
    "adrift",
    "adrift_in_words",
    "coupling_aside",
    "derive",
    "functional",
    "idle_within",
    "insight",
    "intended_answers",
    "is_higher",
    "mobility_within",
    "near_motions",
    "propose",
    "proposed_joints",
    "query",
    "stated_proposals",
]

CODE_VERSION = 54
"""Bumped when the results of this stage change for the same input."""

__getattr__ = first_used(
    __name__,
    {
        "derive": "derivation",
        "functional": "derivation",
        "idle_within": "derivation",
        "mobility_within": "derivation",
        "coupling_aside": "mobility.couplings",
        "is_higher": "axes.higher_pairs",
        "Motions": "mobility.named_freedoms",
        "propose": "partition",
        "proposed_joints": "partition",
        "stated_proposals": "partition",
        "adrift": "questions.adrift",
        "adrift_in_words": "questions.adrift",
        "Afloat": "questions.afloat",
        "AfloatParts": "questions.afloat",
        "IntendedAnswer": "questions.intended_freedoms",
        "IntendedMotion": "questions.intended_freedoms",
        "intended_answers": "questions.intended_freedoms",
        "Insight": "questions.joint_insight",
        "insight": "questions.joint_insight",
        "QueryAnswer": "questions.motion_query",
        "QueryBlocker": "questions.motion_query",
        "query": "questions.motion_query",
        "Correction": "questions.near_motion",
        "NearMotion": "questions.near_motion",
        "near_motions": "questions.near_motion",
    },
)
