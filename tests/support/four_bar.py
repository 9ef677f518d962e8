"""A four-bar of journals with collars, as contacts without meshes."""

from __future__ import annotations

import numpy as np

from support.assemblies import assembly, between, contacts, part
from support.patches import Z, cylinder, ring


def hinge(a, b, point, axis=Z, radius=0.004):
    """Journal with collars of `a` in `b` at a point."""
    point, axis = np.asarray(point, float), np.asarray(axis, float)
    return [
        between(cylinder(radius, 0.02, axis=axis, point=point), a, b),
        between(ring(point + 0.01 * axis, axis), a, b),
        between(ring(point - 0.01 * axis, -axis), a, b),
    ]


def four_bar(ground="base"):
    at = {
        "base~crank": (0, 0, 0),
        "crank~link": (0, 0.1, 0),
        "link~rocker": (0.2, 0.15, 0),
        "base~rocker": (0.25, 0, 0),
    }
    patches = [p for name, point in at.items() for p in hinge(*name.split("~"), point)]
    return assembly(*(part(n) for n in ("base", "crank", "link", "rocker")), ground=ground), contacts(*patches)
