"""The clearance between two parts lies outside of the required bounds.

Of coaxial and concentric surfaces the clearance is the difference of radii (half of that of diameters), negative for
a press fit; of planes that face each other, as a key in its slot, the gaps of both sides together. Every fit between
the two counts. Where the uncertainty of the fitted surfaces could decide, or where no surfaces mate, the requirement
is inconclusive (KF902).

Why it matters: too tight does not assemble or seizes, too loose rattles.

What to do: change one of the two sizes. `kinform show F.h5 contacts` lists all fits.

Example: `kind = "fit"`, `between = ["shaft", "bush"]`, `minimum = 0.01`, `maximum = 0.05` for a gap of 0.15 mm.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF433", "fit-out-of-bounds", "fit", __doc__)
