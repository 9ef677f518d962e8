"""Tolerance classes of ISO 286: limits of a size such as 20 H7, and of the clearance of a fit such as 20 H7/g6.

The values are those of the tables of ISO 286-1, up to 500 mm: grades IT5 to IT11, shafts d to p, holes D to H and JS,
whose fundamental deviations have no corrections. Tests compare them with the formulas that the standard gives. What is
not among them is refused.
"""

from __future__ import annotations

import re
from bisect import bisect_left

STEPS = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
"""mm: upper ends of the steps of nominal sizes; each belongs to its step."""

GRADES = {
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
}
"""µm: standard tolerances by grade and step."""

UPPER = {
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
}
"""µm: how far the upper limit of a shaft is below the nominal size, and the lower limit of a hole above it."""

LOWER = {
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
}
"""µm: how far the lower limit of a shaft is above the nominal size; k in the grades to IT7 only."""

_CLASS = re.compile(r"([A-Za-z]{1,2})(\d{1,2})")


def limits(text: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation (mm) of a class such as "H7" at a nominal size (mm), or of the clearance of a fit such
    as "H7/g6": the hole's size less the shaft's. Raises ValueError that says what is wrong."""
    hole, slash, shaft = text.partition("/")
    if not slash:
        return _of_class(text, size)
    if not (hole[:1].isupper() and shaft[:1].islower()):
        raise ValueError(f"{text!r} is no fit: a hole, then a shaft, as in H7/g6")
    (hole_low, hole_high), (shaft_low, shaft_high) = _of_class(hole, size), _of_class(shaft, size)
    return hole_low - shaft_high, hole_high - shaft_low


def _of_class(text: str, size: float) -> tuple[float, float]:
    match = _CLASS.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is no tolerance class, such as H7 or g6")
    if not 0.0 < size <= STEPS[-1]:
        raise ValueError(f"{text} is known for sizes up to {STEPS[-1]} mm, and this is {size:g} mm")
    step, letter, grade = bisect_left(STEPS, size), match[1], int(match[2])
    if grade not in GRADES:
        raise ValueError(f"{text}: the grades IT{min(GRADES)} to IT{max(GRADES)} are known")
    width = GRADES[grade][step]
    low = _lowest(letter, grade, step, width)
    if low is None:
        raise ValueError(f"{text}: known are shafts d, e, f, g, h, js, k (to grade 7), m, n, p and holes D to H, JS")
    return low / 1000.0, (low + width) / 1000.0


def _lowest(letter: str, grade: int, step: int, width: int) -> float | None:
    """The lower deviation (µm); None where the letter is not known."""
    if letter.lower() == "js":
        return -width / 2.0
    if letter in UPPER:
        return float(-UPPER[letter][step] - width)
    if letter.lower() in UPPER:
        return float(UPPER[letter.lower()][step])
    if letter in LOWER and (letter != "k" or grade <= 7):
        return float(LOWER[letter][step])
    return None
