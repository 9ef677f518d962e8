"""Numbers that decide in the kinematics: of each what it is, and the reason or the measurement that chose it.

Grouped by the module that uses them. What a user may set is in `model.tolerances`, above all from which singular value
on a motion counts as free or held: `Tolerances.free` and `held`. Where no reason is given the number is a choice that
was not measured. "Relative" is to what the sentence names, else to 1.
"""

from __future__ import annotations

SIGMAS = 3.0
"""Standard uncertainties by which fitted axes, centres and normals may be off: beyond it chance is below 1 %."""
RCOND = 1e-9
"""Relative singular value below which least squares ignore a direction: rounding, amplified a thousand times."""
LEAST_FRAME = 0.05
"""Share of the assembly's size that the scaling length of a block is at least: axes that meet have no size of their
own."""
CLOSED = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops; the axes have been made exactly
parallel and coaxial before, so true zeros are rounding."""
FAR_AXIS = 1e-9
"""A twist whose axis is farther away than the size of the assembly over this is a slide."""
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
