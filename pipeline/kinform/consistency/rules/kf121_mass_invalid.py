"""Mass properties that no rigid body can have.

A mass must be positive; the principal moments of inertia positive, and none larger than the sum of the
other two. Parts whose mass is unknown because of their mesh (KF101 to KF103) or density (KF120) are
not repeated here.

Why it matters: a simulation with such a body gains energy from nothing, or ends at once.

What to do: check the stated `mass` and `inertia`: kg·m² about the centre of mass, in the axes of the
part; a factor of 10⁶ is kg·mm². If the mass comes from geometry, the mesh crosses itself.

Example: an inertia of diag(1, 1, 3) kg·m²: 3 is more than 1 + 1.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.constants import TRIANGLE_ROUNDING
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import mass, number, quoted
from kinform.model.assembly import Part
from kinform.model.mass import MassProperties


def check(context: Context) -> Outcome:
    """Known masses that are impossible, and problems of the mass stage that no other rule explains."""
    lacking = context.lacks("mass")
    if lacking is not None:
        stated = any(part.density is not None or part.override is not None for part in context.assembly.parts)
        return lacking if stated else skipped("no part has a density or a stated mass")
    report = context.mass
    weighed = [properties for properties in report.parts if properties.mass is not None]
    if not weighed and not report.problems:
        return skipped("no part has a mass")
    wrong = {p.name: text for p in weighed if (text := _impossible(p))}
    for name, text in report.problems:
        if name not in wrong and not _explained(context.assembly.part(name)):
            wrong[name] = text
    return decided(
        RULE.finding(
            [part.name],
            f"the mass properties of {quoted([part.name])} are impossible: {wrong[part.name]}",
            found=wrong[part.name],
            intended="a mass and an inertia that a rigid body can have",
            place=part.X_WP[:3, 3],
            declared=part.source,
            remedy="Check the stated mass and inertia (kg, kg·m² about the centre of mass)."
            if part.override is not None
            else "Check the mesh for facets that cross each other, and the density.",
        )
        for part in (context.assembly.part(name) for name in sorted(wrong))
    )


def _impossible(properties: MassProperties) -> str:
    """What is wrong with the properties, "" when a rigid body can have them."""
    value, moments = properties.mass, properties.principal_moments
    if value is None:
        return ""
    if not (np.isfinite(value) and value > 0.0):
        return f"mass {mass(value)}"
    if not (np.isfinite(moments).all() and np.isfinite(properties.inertia).all()):
        return "the inertia is not a number"
    low, middle, high = sorted(float(m) for m in moments)
    shown = f"principal moments {number(low)}, {number(middle)} and {number(high)} kg·m²"
    if low < -TRIANGLE_ROUNDING * high or high <= 0.0:
        return f"{shown}: none may be negative"
    return (
        f"{shown}: the largest exceeds the sum of the others"
        if high > (low + middle) * (1.0 + TRIANGLE_ROUNDING)
        else ""
    )


def _explained(part: Part) -> bool:
    """Whether another rule says already why the part has no mass."""
    if part.override is not None:
        return False
    if part.mesh is None or not part.solid or part.density is None:
        return True
    health = part.mesh.health
    return not health.watertight or not health.consistent_winding or health.volume < 0.0


RULE = Rule("KF121", "mass-invalid", "error", __doc__, check)
