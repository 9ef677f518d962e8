"""The size of the assembly, or of parts beside each other, says that the units are not what the manifest states.

A warning above 20 m across, above 1000 m³ of solid material, below 3 mm (3 um with `units = "um"`), or when one
part is 100 times larger than all others together. An error where sizes of parts differ by more than 1000, and are of
two sorts with a factor of 100 between: rules about contacts, joints and motion are then inconclusive, unless the
manifest states `tolerances.contact`. Likewise where the stated mass of a part or link fits its geometry only if that
were 1000 times smaller or larger. Stick models are measured by the points of their joints.

Why it matters: mesh files carry no unit. Contacts and joints are the same at any size, but masses are wrong by 10⁹ at a
wrong one, and so are forces and times. Parts in different units do not meet at all.

What to do: correct `units` in `[assembly]`, or `units` of the part.

Example: a camera gimbal drawn in millimetres and declared with `units = "m"` is 150 m across.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule


def check(context: Context) -> Findings:
    """Implausible sizes of the assembly or of one part."""
    for doubt in context.doubts:
        yield RULE.at(doubt.severity).finding(
            doubt.subject,
            doubt.message,
            found=doubt.found,
            intended=f"a plausible size in {context.units}",
            declared=doubt.source,
            remedy="Correct the `scale` of the mesh: millimetres taken for metres are the usual cause."
            if context.assembly.descriptions
            else "Correct `units`: millimetres declared as metres are the usual cause.",
        )


RULE = Rule("KF110", "units-implausible", "error", __doc__, check, needs=("sizes",), also=("warning",))
