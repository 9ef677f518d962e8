"""The static imbalance about an axis, mass times distance of the centre of mass from the axis, is above its limit.

The axis is that of a joint, or is given by axis and point. At the pose of the meshes.

Why it matters: what turns shakes its bearings, and gravity turns what should stay where it is put.

What to do: move material towards the other side of the axis, or add a counterweight.

Example: `kind = "balance"`, `of = "inner"`, `joint = "pitch"`, `limit = 1e-5` for a camera that sits 2 mm forward.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF431", "unbalanced", "balance", __doc__)
