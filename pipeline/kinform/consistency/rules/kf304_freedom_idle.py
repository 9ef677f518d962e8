"""A pin, a roller, a ball or a screw can spin, which nobody could see.

Its body is a bare solid of revolution about the axis, a ball, or a fastener, and no intended joint names the turn. It
is not counted in the effective mobility, and a stated mobility may count it or not (KF301). What slides, and what has a
lug, a keyway or a crank pin, is seen to move, and counts.

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
            f"{quoted([name])} rotates on itself; not counted in the effective mobility",
            found="idle freedom",
            intended="freedoms that move something else",
            declared=context.assembly.part(bodies[name].parts[0]).source,
            remedy="Nothing if the part may spin; otherwise hold it by a flat, a key or a [[group]].",
        )


RULE = Rule("KF304", "freedom-idle", "note", __doc__, check, needs=("kinematics",))
