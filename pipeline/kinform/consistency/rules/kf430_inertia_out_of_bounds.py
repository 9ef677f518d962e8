"""The moment of inertia about an axis lies outside of the required bounds.

About the axis through the point, or through the centre of mass where no point is given, at the pose of the meshes.
Where the error that coarse facets leave could decide, the requirement is inconclusive (KF902).

Why it matters: acceleration and natural frequency follow from it.

What to do: move material, or change the bound. `kinform show F.h5 mass` lists all inertias.

Example: `kind = "inertia"`, `of = "rotor"`, `axis = [0, 0, 1]`, `maximum = 2e-5`.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF430", "inertia-out-of-bounds", "inertia", __doc__)
