"""Colours that the viewer, the drawings and the pictures share. None of them carries a meaning alone."""

from __future__ import annotations

__all__ = ["FITS", "OVERLAP", "SIGNAL", "body_colours", "rgb"]

GROUND = "#8b929c"
BODIES = (
    "#6b9ac4", "#d39a5b", "#79ab83", "#b08abf", "#c9807a", "#6fb0ae", "#bda956", "#8a92cf", "#c78ca9", "#94a86a",
)  # fmt: skip
FITS = {"clearance": "#3f7fbf", "touch": "#2e9e76", "transition": "#c9962b", "interference": "#c2410c"}
"""Of contact patches by their fit."""
OVERLAP = "#f0283a"
"""Solids that occupy the same space."""
SIGNAL = "#e8590c"
"""What a finding is about."""


def body_colours(ground: list[bool]) -> list[str]:
    """A colour for each body in order; grey where it is the ground."""
    colours, used = [], 0
    for held in ground:
        colours.append(GROUND if held else BODIES[used % len(BODIES)])
        used += not held
    return colours


def rgb(colour: str) -> tuple[float, float, float]:
    """ "#rrggbb" as numbers from 0 to 1."""
    return tuple(int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))  # type: ignore[return-value]
