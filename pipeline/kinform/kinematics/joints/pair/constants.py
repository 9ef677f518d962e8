"""Numbers that several modules of `kinematics.joints.pair` share."""

from __future__ import annotations

import math

SAME_PITCH = 5e-3
"""Relative difference of pitches that are one. Chosen, not measured: neighbouring standard
metric pitches differ by 6 % or more."""
VAGUE_AXIS = math.radians(0.5)
"""rad: standard uncertainty of a direction above which it is too badly known for a joint, and a surface does not decide
alone. With 0.05 rad, two of 1,000 random assemblies were wrong, both of coarse circles whose vertices scatter; of 150
random shafts in bores whose vertices scatter by 1 to 100 µm, none of which chose it, 0 were wrong, 17 in doubt, 1
blocked (without this doubt and that of `ENCLOSING_*` in `contacts`: 3, 6 and 4)."""
ALONG_AXIS = 0.01
"""Normals and axes this near (sine) to an axis are along it. Chosen, not measured."""
OPPOSING_SPEED = 0.05
"""Share of a patch's greatest normal speed that is opposition, and no rounding beside it. Chosen, not measured."""
