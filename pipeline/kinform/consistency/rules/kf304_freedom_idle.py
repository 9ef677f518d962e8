"""A body can spin or slide on itself without moving anything else.

Such freedoms are not counted in the effective mobility: all contact surfaces of the body slide on
themselves, and no intended joint names it.

Why it matters: a bolt or roller that spins is harmless, a shaft that should be driven is not.

What to do: nothing if the part may spin. Otherwise give it a flat, a key or a group.

Example: a pin that turns in both of its holes.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import quoted


def check(context: Context) -> Findings:
    """Idle bodies."""
    kinematics = context.kinematics
    bodies = {body.name: body for body in kinematics.bodies}
    for name in sorted(kinematics.mobility.idle_bodies):
        yield RULE.finding(
            [name],
            f"{quoted([name])} can move on its own without moving anything else; this freedom is not counted",
            found="idle freedom",
            intended="freedoms that move something else",
            declared=context.assembly.part(bodies[name].parts[0]).source,
            remedy="Nothing if the part may spin or slide; otherwise hold it by a flat, a key or a [[group]].",
        )


RULE = Rule("KF304", "freedom-idle", "note", __doc__, check, needs=("kinematics",))
