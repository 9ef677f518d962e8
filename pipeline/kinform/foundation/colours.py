"""Colours as people write them, "#rrggbb" in sRGB, and as files have them."""

from __future__ import annotations

from collections.abc import Sequence

_DARK = 0.0031308
"""Linear value up to which sRGB is a straight line (IEC 61966-2-1)."""


def hexed(rgb: Sequence[float]) -> str:
    """ "#rrggbb" of three values of sRGB, 0 … 1; what is beyond is cut off."""
    return "#" + "".join(f"{round(255.0 * min(max(float(v), 0.0), 1.0)):02x}" for v in rgb[:3])


def of_light(rgb: Sequence[float]) -> str:
    """ "#rrggbb" of three linear values, as glTF has them."""
    light = [min(max(float(v), 0.0), 1.0) for v in rgb[:3]]
    return hexed([12.92 * v if v <= _DARK else float(1.055 * v ** (1.0 / 2.4) - 0.055) for v in light])


def light(rgb: Sequence[float]) -> tuple[float, float, float]:
    """Three linear values of three of sRGB."""
    low = 12.92 * _DARK
    x, y, z = (v / 12.92 if v <= low else float(((v + 0.055) / 1.055) ** 2.4) for v in rgb[:3])
    return x, y, z


def shares(colour: str) -> tuple[float, float, float]:
    """Red, green and blue of "#rrggbb", 0 … 1."""
    x, y, z = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return x, y, z


def told(rgb: Sequence[float] | None) -> str | None:
    """`hexed` of three or four values that a file states; None where it states none, or what is no colour."""
    if rgb is None or len(rgb) < 3 or not all(0.0 <= v <= 1.0 for v in rgb[:3]):
        return None
    return hexed(rgb)
