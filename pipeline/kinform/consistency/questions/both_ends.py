"""Loops that are shaky or singular at one end of the mobility alone (`mobility.two_ends`)."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.consistency.context import Context
from kinform.model.kinematics import FiniteCertificate

BY_PUSHING = "this depends on contact that only pushes, and may open as it moves"
"""Said of what is not so at both ends."""


def doubt_of_ends(context: Context, certificates: Iterable[FiniteCertificate]) -> str:
    """Why it is not decided whether loops are shaky or singular; "" where both ends agree, or the stated mobility is
    not between them."""
    stated = context.function.mobility
    between = stated is not None and context.kinematics.mobility.admits(stated) is None
    return BY_PUSHING if between and not all(one.at_ends for one in certificates) else ""
