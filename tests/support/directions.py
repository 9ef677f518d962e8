"""Directions in which bodies leave each other."""

from __future__ import annotations

import numpy as np


def slides(releases):
    return [way.direction for way in releases if way.kind == "slide"]


def same_directions(found, expected, tolerance=1e-3):
    found, expected = np.array(found).reshape(-1, 3), np.array(expected).reshape(-1, 3)
    if len(found) != len(expected) or not len(found):
        return len(found) == len(expected)
    apart = np.linalg.norm(found[:, None] - expected[None], axis=2)
    return bool((apart.min(axis=0) < tolerance).all())
