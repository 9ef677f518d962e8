"""Masses side by side: how heavy bodies are, where their centres lie, and how they resist turning."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from kinform.changes.behaviours import BodyMass, Snapshot
from kinform.changes.change import Change, Measure, signed
from kinform.foundation.words import mass, moment_unit, number


def mass_changes(before: Snapshot, after: Snapshot, now: Mapping[str, str], measure: Measure) -> Iterator[Change]:
    """Bodies whose mass, centre or inertia changed."""
    new = {body.name: body for body in after.masses or ()}
    for old in before.masses or ():
        name = now.get(old.name, old.name)
        if name in new:
            yield from _mass(old, new[name], measure)


def _mass(old: BodyMass, new: BodyMass, measure: Measure) -> Iterator[Change]:
    """Mass, centre of mass and principal moments; the axes of inertia where the moments are the same."""
    subject = (new.name,)
    if (old.mass is None) != (new.mass is None):
        message = "mass is no longer known" if new.mass is None else "mass is known now"
        yield Change("mass", subject, message, _kg(old.mass), _kg(new.mass))
    elif old.mass is not None and new.mass is not None and not measure.within.masses_agree(old.mass, new.mass):
        message = f"mass {signed(new.mass - old.mass, mass)}"
        yield Change("mass", subject, message, _kg(old.mass), _kg(new.mass), new.mass - old.mass, "kg")
    if old.centre_of_mass is not None and new.centre_of_mass is not None:
        away = float(np.linalg.norm(np.subtract(new.centre_of_mass, old.centre_of_mass)))
        what, places = "centre of mass", (old.centre_of_mass, new.centre_of_mass)
        yield from measure.displacement("centre-of-mass", subject, what, *places, away)
    if old.principal_moments is None or new.principal_moments is None:
        return
    largest = max(map(abs, (*old.principal_moments, *new.principal_moments)))
    for kind, what, one, two in (
        ("inertia", "principal moments", old.principal_moments, new.principal_moments),
        ("inertia-axes", "axes of inertia turned: entries of the tensor", old.inertia, new.inertia),
    ):
        if one is not None and two is not None:
            worst = max(abs(now - was) for was, now in zip(one, two, strict=True))
            if worst > measure.within.share * largest:
                message = f"{what} changed by up to {100.0 * worst / largest:.3g} %"
                yield Change(kind, subject, message, _moments(one, largest), _moments(two, largest), worst, "kg·m²")
                return


def _kg(kilograms: float | None) -> str | None:
    return None if kilograms is None else mass(kilograms, 6)


def _moments(moments: Iterable[float], largest: float) -> str:
    unit, factor = moment_unit(largest)
    return "(" + ", ".join(number(factor * x) for x in moments) + f") {unit}"
