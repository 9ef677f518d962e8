"""What counts as the same: an absolute bound for lengths, angles and masses, and a relative one for masses."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import replace

from kinform.frozen import dataclass

UNITS: dict[str, tuple[str, float]] = {
    "m": ("length", 1.0), "cm": ("length", 1e-2), "mm": ("length", 1e-3), "um": ("length", 1e-6),
    "µm": ("length", 1e-6), "in": ("length", 0.0254), "rad": ("angle", 1.0),
    "deg": ("angle", math.pi / 180.0), "°": ("angle", math.pi / 180.0),
    "kg": ("mass", 1.0), "g": ("mass", 1e-3), "mg": ("mass", 1e-6), "%": ("share", 1e-2),
}  # fmt: skip
"""By unit: what it measures, and its size in SI."""


@dataclass(frozen=True)
class Tolerance:
    """Changes up to these are none. The defaults are far below what can be made, and far above rounding."""

    length: float = 1e-6
    """m."""
    angle: float = math.radians(1e-3)
    """rad."""
    mass: float = 1e-9
    """kg; a mass is also the same within `share`."""
    share: float = 1e-6
    """Of masses and moments of inertia."""

    @staticmethod
    def of(stated: Iterable[str]) -> Tolerance:
        """From texts like "0.1mm", "0.05 deg", "1g", "0.5%"; ValueError for another."""
        tolerance = Tolerance()
        for text in stated:
            match = re.fullmatch(r"\s*([0-9.eE+-]+)\s*(\D+?)\s*", text)
            unit = None if match is None else UNITS.get(match[2])
            try:
                value = float(match[1]) if match else math.nan
            except ValueError:
                value = math.nan
            if unit is None or not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{text!r} is no tolerance: expected a number and one of {', '.join(UNITS)}")
            tolerance = replace(tolerance, **{unit[0]: value * unit[1]})
        return tolerance

    def masses_agree(self, one: float, two: float) -> bool:
        """Whether two masses (kg) are the same."""
        return abs(one - two) <= max(self.mass, self.share * max(abs(one), abs(two)))

    def shares_agree(self, one: float, two: float) -> bool:
        """Whether two moments are the same."""
        return abs(one - two) <= self.share * max(abs(one), abs(two))

    def lengths_agree(self, one: float, two: float) -> bool:
        """Whether two lengths (m) are the same."""
        return one == two or abs(one - two) <= self.length

    def angles_agree(self, one: float, two: float) -> bool:
        """Whether two angles (rad) are the same."""
        return one == two or abs(one - two) <= self.angle

    def in_words(self) -> str:
        """ "0.001 mm, 0.001°, 1e-06 g, 0.0001 %"."""
        return (
            f"{self.length * 1e3:.6g} mm, {math.degrees(self.angle):.6g}°, {self.mass * 1e3:.6g} g, "
            f"{self.share * 100.0:.6g} %"
        )
