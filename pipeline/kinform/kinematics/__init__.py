"""Joints and mobility from contacts: screw algebra, constraint rows, decisions, loop closure."""

from kinform.kinematics.derivation import derive, functional, mobility_within
from kinform.kinematics.mobility.named_freedoms import Motions
from kinform.kinematics.questions.intended_freedoms import IntendedAnswer, IntendedMotion, intended_answers
from kinform.kinematics.questions.joint_insight import Insight, insight
from kinform.kinematics.questions.motion_query import QueryAnswer, QueryBlocker, query

__all__ = [
    "CODE_VERSION",
    "Insight",
    "IntendedAnswer",
    "IntendedMotion",
    "Motions",
    "QueryAnswer",
    "QueryBlocker",
    "derive",
    "functional",
    "insight",
    "intended_answers",
    "mobility_within",
    "query",
]

CODE_VERSION = 12
"""Bumped when the results of this stage change for the same input."""
