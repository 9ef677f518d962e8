"""The size of the assembly says that the units are not what the manifest states.

An error above 100 m across, above 1000 m³ of solid material, or below 1 mm across (1 um with
`units = "um"`). A warning above 20 m, below 3 mm (3 um), or when one part is 100 times larger than all
others together. Stick models are measured by the points of their joints.

Why it matters: mesh files carry no unit. At a wrong scale clearances are read a thousand times too
wide, masses are wrong by 10⁹, and every result is a confident mistake. Unless the manifest states
`tolerances.contact`, rules about contacts, joints and motion are inconclusive after an error here.

What to do: correct `units` in `[assembly]`, or `units` of the part. If the size is right, state
`tolerances.contact` for it: the default of at most 0.5 mm was made for machines that fit in a room.

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
            remedy="Correct `units`: millimetres declared as metres are the usual cause.",
        )


RULE = Rule("KF110", "units-implausible", "error", __doc__, check, needs=("sizes",))
