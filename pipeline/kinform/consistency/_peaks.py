"""Peaks of a simulated quantity beside a limit."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from kinform.consistency._requirements import Answer, met, undecided, violated
from kinform.consistency._words import number
from kinform.model.simulation import Simulation

__all__ = ["peak"]


def peak(
    simulation: Simulation,
    values: NDArray[np.float64],
    limit: float,
    what: str,
    shown: Callable[[float], str],
    remedy: str,
    place: Iterable[float] | None = None,
) -> Answer:
    """The greatest of the values (T,), which are not negative, beside the limit; unknown values are nan."""
    known = np.isfinite(values)
    intended = f"at most {shown(limit)}"
    if known.any():
        k = int(np.nanargmax(np.where(known, values, -np.inf)))
        text = f"{what} peaks at {shown(float(values[k]))} at t = {number(float(simulation.time[k]))} s"
        if values[k] > limit:
            return violated(
                f"{text}, required is {intended}", found=shown(float(values[k])), intended=intended,
                place=place, remedy=remedy,
            )  # fmt: skip
    if not known.all():
        return undecided(f"{what} is not known at all times of the simulation", "See the notes of the simulation.")
    if simulation.status != "done":
        return undecided(
            f"the simulation stopped at t = {number(float(simulation.time[-1]))} s: {simulation.reason}",
            "See KF502.", intended=intended,
        )  # fmt: skip
    return met(f"{text}, of {len(values)} output times", found=shown(float(values[k])), intended=intended)
