"""Numbers that decide what a lock says and accepts."""

from __future__ import annotations

GRAIN_SHARE = 0.1
"""Values are rounded to this share of their tolerance: rounding cannot make a difference by itself."""
DIRECTION_PLACES = 6
"""Decimals of directions: 1e-6 rad is far below any tolerance of angles that a lock has."""
LENGTH_ERROR = 1e-3
"""By so much a direction in a lock may miss the length 1; more is a mistake of who wrote it."""

SAME_SHAPE = 1e-6
"""Share of a part's size by which vertices may miss a displaced mesh: what files of single precision round."""

SAME_PLACE = 1e-7
"""Share of a part's size, and rad, below which it has not moved: rounding of poses."""

SAME_VOLUME = 0.005
"""%: smaller differences of volume are told as none, as they would be told as 0.00 %."""

ALONG = 1e-6
"""By how much the component of a direction may miss 1 for the direction to be that of an axis."""

OF_THE_WHOLE = ("mobility", "simulation")
"""Kinds of changes that are about no part."""

REVISION_COLOURS = {
    "as it was": "#8b929c", "moved": "#3f7fbf", "other material": "#b08abf", "other shape, before": "#d39a5b",
    "other shape, after": "#2e9e76", "new": "#79ab83", "gone": "#c9807a",
}  # fmt: skip
"""Of parts on the page of two revisions; the legend and the text say the same in words."""

REVISION_FRAMES = 17
"""Poses from before to after: enough for a turn of half a circle to look round."""
