"""Joints and mobility from contacts: screw algebra, constraint rows, decisions, loop closure."""

from kinform.kinematics.derive import derive, functional, mobility_within
from kinform.kinematics.query import QueryAnswer, QueryBlocker, query

__all__ = ["CODE_VERSION", "QueryAnswer", "QueryBlocker", "derive", "functional", "mobility_within", "query"]

CODE_VERSION = 3
"""Bumped when the results of this stage change for the same input."""
