"""The centre of mass of a part, a group or the whole is too far from where it is required, at the pose of the meshes.

Why it matters: what is to stand, hang or turn in balance does not.

What to do: move material, or the point. `kinform show F.h5 mass` lists all centres.

Example: `kind = "centre_of_mass"`, `point = [0, 0, 0]`, `tolerance = 0.5` for a gimbal that is 2 mm off.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF429", "centre-of-mass-off", "centre_of_mass", __doc__)
