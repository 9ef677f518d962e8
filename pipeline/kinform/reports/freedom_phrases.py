"""Freedoms of the whole assembly in a designer's words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.kinematics.screws.wording import axis_word
from kinform.model.arrays import Array
from kinform.model.kinematics import Freedom, Joint


def metres(point: Array) -> str:
    """A place as "(0.1, 0, 0) m"."""
    return "(" + ", ".join(f"{round(float(x), 6) + 0.0:.6g}" for x in point) + ") m"


def freedom_text(
    freedom: Freedom, place: Callable[[Array], str], lead: Callable[[float], str] = "{:.4g} m".format
) -> str:
    """ "crank turns about z through (0, 0, 0) m"; `place` writes points, `lead` what a screw advances."""
    axis = axis_word(freedom.axis)
    subject = str(freedom.body)
    if freedom.driver is None:
        subject += ", which nothing connects to ground,"
    if freedom.kind == "slide":
        return f"{subject} slides along {axis}"
    through = f"about {axis} through {place(freedom.point)}"
    if freedom.idle:
        return f"{subject} only spins {through}"
    if freedom.kind == "screw":
        return f"{subject} screws {through}, {lead(freedom.pitch)} a turn"
    return f"{subject} turns {through}"


def follower_rates(freedom: Freedom, joints: dict[str, Joint], unit: str, size: float) -> list[tuple[str, str]]:
    """(joint, rate) of the joints that follow the driver: per radian or length unit of `size` (m) of the driver."""
    driver = next(
        ((j, c) for j, c, rate in freedom.drives if j == freedom.driver and abs(abs(rate) - 1.0) < SOLVED), None
    )
    per = unit if driver is not None and _slides(joints[driver[0]], driver[1]) else "rad"
    out = []
    for name, coordinate, rate in freedom.drives:
        if (name, coordinate) == driver:
            continue
        slides = _slides(joints[name], coordinate)
        value = rate * (1.0 / size if slides else 1.0) * (size if per == unit else 1.0)
        own = unit if slides else "rad"
        out.append((str(name), f"{value + 0.0:.4g}" + ("" if own == per else f" {own}/{per}")))
    return out


def _slides(joint: Joint, coordinate: int) -> bool:
    return not np.any(joint.twists[coordinate][:3])
