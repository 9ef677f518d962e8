"""Numbers that several packages of the kinematics share. "Relative" is to what the sentence names, else to 1."""

from __future__ import annotations

RCOND = 1e-9
"""Relative singular value below which least squares ignore a direction: rounding, amplified a thousand times."""
AT_REST = 1e-9
"""Relative speed below which a motion does not concern a pair or a joint."""
EXACT_MOTION = 1e-5
"""Of unit twists, scaled in their frame: what is zero is zero to rounding and snapping."""
SAME_DIRECTION = 1e-3
"""Two unit directions that differ by less are one; a screw with less advance a radian (over the size) is a turn."""
EXACT_PAIR = 1e-6
"""Twist spaces come out of snapped rows: what is zero is zero to rounding."""
ACROSS_LINE = 1e-3
"""Planes whose normals are this near (sine) to a line of contact lie across it."""
MOST_IN_STEP = 250
"""Pairs that are decided in step: their samples take a few MB, and more gain nothing."""
INTENDED_AXIS = 0.02
"""Sine by which the axis of an intended joint may be off that of the turn that it names, ..."""
