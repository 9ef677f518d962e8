"""Joints and mobility from contacts: screw algebra, constraint rows, decisions, loop closure.

`derivation` is the method of the stage, from contacts to `model.kinematics.Kinematics`; `mechanism_results` is its
second half, from decided joints to mobility and separation; `ball_and_stick` does the same for joints that the function
states, without contact. The sub-packages, in the order in which one reads them; each imports only those above it:

- `screws`: one basis for each space of screws, and words for motions and wrenches
- `joints`: joints of pairs of bodies, which parts are one body, and axes that agree across the assembly
- `partition`: which parts are one body where the function states all joints, and which joints may be meant where it
  states none
- `mobility`: degrees of freedom of the assembly, whether they are finite motions, redundancy, couplings
- `separation`: the constraint matrix J, and what comes apart
- `queries`: what users ask about the result

`step_cache` is the interface by which results of an earlier run are reused. What only rules ask is in
`consistency.questions`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.kinematics.ball_and_stick import functional
    from kinform.kinematics.derivation import derive
    from kinform.kinematics.joints.axes.higher_pairs import is_higher
    from kinform.kinematics.mobility.couplings import coupling_aside
    from kinform.kinematics.mobility.named_freedoms import Motions
    from kinform.kinematics.partition import propose, proposed_joints, stated_proposals
    from kinform.kinematics.queries.disconnected import disconnected_bodies, disconnected_in_words
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
    "coupling_aside",
    "derive",
    "disconnected_bodies",
    "disconnected_in_words",
    "functional",
    "insight",
    "intended_answers",
    "is_higher",
    "propose",
    "proposed_joints",
    "query",
    "stated_proposals",
]

CODE_VERSION = 63
"""Bumped when the results of this stage change for the same input."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "derive": "derivation",
        "functional": "ball_and_stick",
        "coupling_aside": "mobility.couplings",
        "is_higher": "joints.axes.higher_pairs",
        "Motions": "mobility.named_freedoms",
        "propose": "partition",
        "proposed_joints": "partition",
        "stated_proposals": "partition",
        "disconnected_bodies": "queries.disconnected",
        "disconnected_in_words": "queries.disconnected",
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
