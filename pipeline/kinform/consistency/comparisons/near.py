"""What joints are out of place, where loops do not move and nearly would."""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.gathering import NAMED_MOST
from kinform.consistency.context import Context
from kinform.consistency.questions.near_motion import Correction, NearMotion, near_motions
from kinform.foundation.words import angle, length, listed, number
from kinform.function.joint_names import stated_as


def nearly_moves(context: Context) -> str:
    """Sentences on the joints, any one of which only has to be corrected a little for loops to move; "" without."""
    return "; ".join(_sentence(context, near) for near in near_motions(context.kinematics))


def out_of_place(context: Context) -> str:
    """Joints that a little correction of one of which makes loops move, in words; "" without."""
    found = [_name(context, one.joint) for near in near_motions(context.kinematics) for one in near.corrections]
    names = sorted(set(found), key=found.index)
    more = len(names) - NAMED_MOST
    return " or ".join(f"'{name}'" for name in names[:NAMED_MOST]) + (f" or one of {more} more" if more > 0 else "")


def _sentence(context: Context, near: NearMotion) -> str:
    names = [_name(context, name) for name in near.moves]
    shown = near.corrections[:NAMED_MOST]
    ways = [f"'{_name(context, one.joint)}' were {_way(context, one)}" for one in shown]
    more = len(near.corrections) - len(shown)
    rest = f" (or one of {more} more)" if more else ""
    others = len(names) - NAMED_MOST
    few = names if others <= 1 else [*names[:NAMED_MOST], f"{others} more"]
    return f"the loops of {listed(few)} would move if {' or '.join(ways)}{rest}"


def _name(context: Context, joint: str) -> str:
    return stated_as(context.assembly, context.kinematics, joint)[0]


def _way(context: Context, one: Correction) -> str:
    if one.tilt:
        return f"tilted by {angle(one.tilt)}"
    size = float(np.linalg.norm(one.shift))
    along = ", ".join(number(x, 2) for x in np.round(one.shift / size, 3) + 0.0)
    return f"{length(size, context.assembly.units, 2)} elsewhere, towards ({along})"
