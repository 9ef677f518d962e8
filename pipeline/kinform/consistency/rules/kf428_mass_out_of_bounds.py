"""The mass of a part, a group or the whole lies outside of the required bounds.

The mass comes from the geometry and the densities, or is stated. Where the error that coarse facets leave could
decide, the requirement is inconclusive (KF902).

Why it matters: drives and structures are sized for a mass.

What to do: change the shape or the material, or the bound. `kinform show F.h5 mass` lists all masses.

Example: `kind = "mass"`, `of = "camera"`, `maximum = 0.2` for a camera of 230 g.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF428", "mass-out-of-bounds", "mass", __doc__)
