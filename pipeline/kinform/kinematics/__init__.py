"""Joints and mobility from contacts: screw algebra, constraint rows, decisions, loop closure.

`derivation` is the method of the stage, from contacts to `model.kinematics.Kinematics`. The rooms, in the order in
which one reads them; each knows those before it and none after it (separation needs `joints/pair` and `answers` only):

- `joints`: joints of pairs of bodies, which parts are one body, and axes consistent across the assembly.
- `partition`: which parts are one body where the function states all joints, and which joints may be meant where it
  states none.
- `mobility`: freedoms of the whole, their finite counterparts, redundancy, couplings.
- `separation`: J, and what comes apart.
- `queries`: what users ask of all that.

Beside them `constants` has every number that decides, with its reason; `wording` puts spaces of motions and of forces
in words; `answers` is how steps are found that an earlier run has taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.kinematics.derivation import derive, functional, idle_within, mobility_within
    from kinform.kinematics.joints.axes.higher_pairs import is_higher
    from kinform.kinematics.mobility.couplings import coupling_aside
    from kinform.kinematics.mobility.named_freedoms import Motions
    from kinform.kinematics.partition import propose, proposed_joints, stated_proposals
    from kinform.kinematics.queries.disconnected import adrift, adrift_in_words
    from kinform.kinematics.queries.intended_freedoms import IntendedAnswer, IntendedMotion, intended_answers
    from kinform.kinematics.queries.joint_insight import Insight, insight
    from kinform.kinematics.queries.motion_query import QueryAnswer, QueryBlocker, query

__all__ = [
    "CODE_VERSION",
    "Insight",
    "IntendedAnswer",
    "IntendedMotion",
    "Motions",
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
    "propose",
    "proposed_joints",
    "query",
    "stated_proposals",
]

CODE_VERSION = 54
"""Bumped when the results of this stage change for the same input."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "derive": "derivation",
        "functional": "derivation",
        "idle_within": "derivation",
        "mobility_within": "derivation",
        "coupling_aside": "mobility.couplings",
        "is_higher": "joints.axes.higher_pairs",
        "Motions": "mobility.named_freedoms",
        "propose": "partition",
        "proposed_joints": "partition",
        "stated_proposals": "partition",
        "adrift": "queries.disconnected",
        "adrift_in_words": "queries.disconnected",
        "IntendedAnswer": "queries.intended_freedoms",
        "IntendedMotion": "queries.intended_freedoms",
        "intended_answers": "queries.intended_freedoms",
        "Insight": "queries.joint_insight",
        "insight": "queries.joint_insight",
        "QueryAnswer": "queries.motion_query",
        "QueryBlocker": "queries.motion_query",
        "query": "queries.motion_query",
    },
)
