"""Mass properties that no rigid body can have.

A mass must be positive; the principal moments of inertia positive, and none larger than the sum of the
other two. Parts whose mass is unknown because of their mesh (KF101 to KF103) or density (KF120) are
not repeated here. Of links of robot descriptions the numbers are those of the file.

Why it matters: a simulation with such a body gains energy from nothing, or ends at once.

What to do: check the stated `mass` and `inertia`: kg·m² about the centre of mass, in the axes of the
part; a factor of 10⁶ is kg·mm². If the mass comes from geometry, the mesh crosses itself.

Example: an inertia of diag(1, 1, 3) kg·m²: 3 is more than 1 + 1.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.consistency.comparisons.links import described_links
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.rounding import SOLVED, TINY
from kinform.foundation.words import mass, number, quoted
from kinform.mass.principal import impossible
from kinform.model.arrays import Array
from kinform.model.assembly import Part, Source
from kinform.model.findings import Finding, Witness, computed, stated
from kinform.model.mass import MassProperties


def check(context: Context) -> Outcome:
    """Known masses that are impossible, and problems of the mass stage that no other rule explains."""
    groups = [*_groups(context), *_negative(context)]
    lacking = context.lacks("mass")
    if lacking is not None and groups:
        return inconclusive(lacking.reason, groups)
    if lacking is not None:
        stated = any(part.density is not None or part.override is not None for part in context.assembly.parts)
        return lacking if stated else skipped("no part has a density or a stated mass")
    report = context.mass
    weighed = [properties for properties in report.parts if properties.mass is not None]
    if not weighed and not report.problems and not any(group.override for group in context.assembly.groups):
        return skipped("no part has a mass")
    wrong = {p.name: text for p in weighed if (text := _impossible(p))}
    for name, text in report.problems:
        if name not in wrong and not _explained(context.assembly.part(name)):
            wrong[name] = text
    by_name = {properties.name: properties for properties in weighed}
    of_parts = (
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
            witness=_of_part(part, by_name.get(part.name)),
        )
        for part in (context.assembly.part(name) for name in sorted(wrong))
    )
    return decided((*of_parts, *groups))


def _groups(context: Context) -> Iterator[Finding]:
    """Groups and links whose stated mass no body can have."""
    links = {link.name: link for link in described_links(context.assembly)}
    for group in context.assembly.groups:
        stated = group.override
        wrong = "" if stated is None else impossible(stated.mass, stated.inertia)
        if stated is None or not wrong:
            continue
        link = links.get(group.name)
        moments, written = sorted(np.linalg.eigvalsh(stated.inertia)), ""
        if link is not None and link.stated is not None and link.stated.inertia is not None:
            names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
            six = (f"{name} {number(v, 6)}" for name, v in zip(names, link.stated.inertia, strict=True) if v)
            written = f" ({', '.join(six)})"
        witness = _impossible_inertia(stated.mass, stated.inertia)
        declared = group.source if link is None or link.stated is None else Source(link.file, link.stated.line)
        yield RULE.finding(
            [group.name],
            f"no body can have the inertia of {'group' if link is None else 'link'} '{group.name}'{written}: {wrong}",
            found="principal moments " + ", ".join(number(float(m), 3) for m in moments) + " kg·m²",
            intended="positive moments, none larger than the sum of the other two",
            place=stated.centre_of_mass,
            declared=declared,
            remedy="Correct the inertia (kg·m² about the centre of mass); signs of ixy, ixz, iyz are those of the "
            "matrix. `kinform export --to urdf --fix inertia` writes that of the geometry.",
            witness=witness,
        )


def _negative(context: Context) -> Iterator[Finding]:
    """Links whose stated mass is negative: it was taken as not stated."""
    for link in described_links(context.assembly):
        if link.stated is not None and link.stated.value < 0.0:
            yield RULE.finding(
                [link.name],
                f"link '{link.name}' states the mass {number(link.stated.value)} kg",
                found=f"{number(link.stated.value)} kg",
                intended="a positive mass",
                place=link.position,
                declared=Source(link.file, link.stated.line),
                remedy="Correct the mass.",
                witness=stated(Source(link.file, link.stated.line), repr(link.stated.value)),
            )


def _of_part(part: Part, properties: MassProperties | None) -> Witness | None:
    """By what is stated of a part, else by what was computed."""
    if part.override is not None:
        return _impossible_inertia(part.override.mass, part.override.inertia)
    if properties is None or properties.mass is None:
        return None
    return _impossible_inertia(properties.mass, np.diag(properties.principal_moments))


def _impossible_inertia(mass_value: float, inertia: Array) -> Witness | None:
    if not mass_value > 0.0:
        return computed("impossible inertia", -mass_value, -TINY, mass=mass_value)
    if not np.isfinite(inertia).all():
        return None
    low, middle, high = np.linalg.eigvalsh(0.5 * (inertia + inertia.T))
    size = max(abs(low), abs(high))
    off = max(high - low - middle, -low) / size if size > 0.0 else 0.0
    return computed("impossible inertia", off, 0.0, mass=mass_value, inertia=inertia)


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
    if low < -SOLVED * high or high <= 0.0:
        return f"{shown}: none may be negative"
    return f"{shown}: the largest exceeds the sum of the others" if high > (low + middle) * (1.0 + SOLVED) else ""


def _explained(part: Part) -> bool:
    """Whether another rule says already why the part has no mass."""
    if part.override is not None:
        return False
    if part.mesh is None or not part.solid or part.density is None:
        return True
    health = part.mesh.health
    return not health.watertight or not health.consistent_winding or health.volume < 0.0


RULE = Rule("KF121", "mass-invalid", "error", __doc__, check)
