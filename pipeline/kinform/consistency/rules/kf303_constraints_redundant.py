"""Contacts hold some motion more than once.

The number is that of independent constraints beyond what the mobility needs. Closed loops of parallel
hinges always have some: a planar four-bar has three. So short reports leave the note out; `-v` and JSON have it.

Why it matters: redundant constraints only fit when the parts are exact. In reality they bind or share
the load in an unknown way, and reactions cannot be computed uniquely.

What to do: nothing if the parts are stiff and well aligned. Otherwise replace joints in the loop by
freer ones: a spherical or cylindrical joint in place of a hinge.

Example: a planar four-bar with four hinges has three; with two hinges, a ball joint and a cylindrical joint it
has none.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import counted


def check(context: Context) -> Findings:
    """Redundancy of the whole assembly."""
    redundant = context.kinematics.mobility.redundant
    if redundant > 0:
        yield RULE.finding(
            (context.assembly.name,),
            f"the assembly has {counted(redundant, 'redundant constraint')}: "
            f"{'it is' if redundant == 1 else 'they are'} only met by exact parts",
            found=str(redundant),
            intended="0",
            declared=context.assembly.source,
            remedy="Nothing if the parts are aligned well; otherwise use freer joints in the loops.",
        )


RULE = Rule("KF303", "constraints-redundant", "note", __doc__, check, needs=("kinematics",))
