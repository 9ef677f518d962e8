"""A series of numbers as one line of text.

Blocks of eight heights, or where the output cannot show these, characters of growing weight. Each column
stands for a stretch of the series and shows its value that is farthest from the median, so that no peak is lost.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["BLOCKS", "PLAIN", "levels", "spark"]

BLOCKS = "▁▂▃▄▅▆▇█"
PLAIN = "_.:-=+*#"


def levels() -> str:
    """The characters that stdout can show, from low to high."""
    try:
        BLOCKS.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except (UnicodeError, LookupError):
        return PLAIN
    return BLOCKS


def spark(values: NDArray[np.float64], width: int, characters: str = BLOCKS) -> str:
    """The series (T,) in at most `width` characters; a blank where nothing is known, the lowest where it is constant."""
    import numpy as np

    known = values[np.isfinite(values)]
    if not len(known) or width < 1:
        return ""
    low, high = float(known.min()), float(known.max())
    middle = float(np.median(known))
    line = ""
    for stretch in np.array_split(values, min(width, len(values))):
        inside = stretch[np.isfinite(stretch)]
        if not len(inside):
            line += " "
            continue
        value = float(inside[np.argmax(np.abs(inside - middle))])
        share = (value - low) / (high - low) if high > low else 0.0
        line += characters[min(int(share * len(characters)), len(characters) - 1)]
    return line
