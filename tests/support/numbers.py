"""Numbers that a field of a finding tells with their units."""

from __future__ import annotations

import re


def numbers(field: str) -> list[float]:
    """All numbers in `found` or `intended` of a finding, in their order: "2 of 3, 1.5 mm off" → 2, 3, 1.5."""
    return [float(text) for text in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", field)]
