"""Length units of manifests and meshes. There is no default: a unit that is not stated is an error."""

from __future__ import annotations

METRES_PER_UNIT: dict[str, float] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "in": 0.0254,
    "ft": 0.3048,
}
UNITS: tuple[str, ...] = tuple(METRES_PER_UNIT)


def metres_per(unit: str) -> float:
    """Metres in one of the unit; KeyError for a unit that kinform does not know."""
    return METRES_PER_UNIT[unit]
