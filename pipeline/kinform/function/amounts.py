"""Mass, centre of mass and inertia of a selection of parts, with the bound that tessellation leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.mass import weighed_together
from kinform.model.assembly import Assembly
from kinform.model.mass import MassReport
from kinform.requirements.evidence import Amount


def amount_of(assembly: Assembly, report: MassReport, parts: Sequence[str]) -> Amount | str:
    """The parts together by the parallel axis theorem, groups with a stated mass as that; a sentence where one is not
    known."""
    chosen = weighed_together(assembly, report, sorted(parts))
    for part in chosen:
        if part.mass is None:
            return f"the mass of '{part.name}' is not known: {part.reason}"
    masses = [part.mass or 0.0 for part in chosen]
    whole = math.fsum(masses)
    if not whole > 0.0:
        return "the mass is zero"
    centre = np.sum([m * p.centre_of_mass for m, p in zip(masses, chosen, strict=True)], axis=0) / whole
    inertia = np.zeros((3, 3))
    for m, part in zip(masses, chosen, strict=True):
        d = part.centre_of_mass - centre
        inertia += part.inertia + m * (d @ d * np.eye(3) - np.outer(d, d))
    bound = math.fsum(m * p.mass_bound for m, p in zip(masses, chosen, strict=True)) / whole
    by_name = {str(part.name): part for part in assembly.parts}
    shapes = (by_name.get(p.name) for p in chosen)
    numbers = {
        "densities": np.array([s.density or 0.0 if s is not None and s.override is None else 0.0 for s in shapes]),
        "masses": np.array(masses),
        "centres": np.array([p.centre_of_mass for p in chosen]),
        "inertias": np.array([p.inertia for p in chosen]),
    }
    return Amount(whole, centre, inertia, bound, tuple(p.name for p in chosen), numbers)
