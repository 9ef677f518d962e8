"""Masses side by side: how heavy bodies are, where their centres lie, and how they resist turning."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from kinform.changes.behaviours import BodyMass, Snapshot
from kinform.changes.change import Change, Lengths, signed
from kinform.changes.tolerance import Tolerance
from kinform.foundation.words import number


def mass_changes(
    before: Snapshot, after: Snapshot, now: Mapping[str, str], within: Tolerance, say: Lengths
) -> Iterator[Change]:
    """Bodies whose mass, centre or inertia changed."""
    new = {body.name: body for body in after.masses or ()}
    for old in before.masses or ():
        name = now.get(old.name, old.name)
        if name in new:
            yield from _mass(old, new[name], within, say)


def _mass(old: BodyMass, new: BodyMass, within: Tolerance, say: Lengths) -> Iterator[Change]:
    """Mass, centre of mass and principal moments; the axes of inertia where the moments are the same."""
    subject = (new.name,)
    if (old.mass is None) != (new.mass is None):
        message = "mass is no longer known" if new.mass is None else "mass is known now"
        yield Change("mass", subject, message, _kg(old.mass), _kg(new.mass))
    elif old.mass is not None and new.mass is not None and not within.masses_agree(old.mass, new.mass):
        message = f"mass {signed(new.mass - old.mass, _grams)}"
        yield Change("mass", subject, message, _kg(old.mass), _kg(new.mass), new.mass - old.mass, "kg")
    if old.centre_of_mass is not None and new.centre_of_mass is not None:
        away = float(np.linalg.norm(np.subtract(new.centre_of_mass, old.centre_of_mass)))
        if away > within.length:
            message = f"centre of mass moved by {say.length(away)}"
            one, two = say.place(old.centre_of_mass), say.place(new.centre_of_mass)
            yield Change("centre-of-mass", subject, message, one, two, away, "m", new.centre_of_mass)
    if old.principal_moments is not None and new.principal_moments is not None:
        largest = max(max(map(abs, old.principal_moments)), max(map(abs, new.principal_moments)))
        worst = max(abs(two - one) for one, two in zip(old.principal_moments, new.principal_moments, strict=True))
        if worst > within.share * largest:
            message = f"principal moments changed by up to {100.0 * worst / largest:.3g} %"
            yield Change(
                "inertia",
                subject,
                message,
                _moments(old.principal_moments),
                _moments(new.principal_moments),
                worst,
                "kg·m²",
            )
        elif old.inertia is not None and new.inertia is not None:
            turned = max(abs(two - one) for one, two in zip(old.inertia, new.inertia, strict=True))
            if turned > within.share * largest:
                message = (
                    f"axes of inertia turned: entries of the tensor changed by up to {100.0 * turned / largest:.3g} %"
                )
                yield Change(
                    "inertia-axes", subject, message, _moments(old.inertia), _moments(new.inertia), turned, "kg·m²"
                )


def _grams(kilograms: float) -> str:
    return f"{number(1e3 * kilograms)} g"


def _kg(kilograms: float | None) -> str | None:
    return None if kilograms is None else f"{number(kilograms, 6)} kg"


def _moments(moments: Iterable[float]) -> str:
    return "(" + ", ".join(number(x) for x in moments) + ") kg·m²"
