"""The mass properties of a part are stated in the manifest and replace those of its geometry.

Why it matters: they do not follow when the geometry changes.

What to do: nothing if that is meant, as for a bought part. Otherwise remove `mass` and give a material.

Example: a servo of 55 g whose mesh is only its outside.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import mass, quoted
from kinform.model.assembly import Part


def check(context: Context) -> Findings:
    """Meshed parts with stated mass, beside the mass of their geometry where that is known."""
    for part, stated in context.overridden:
        derived = _mass_of_geometry(part)
        beside = f", its geometry {mass(derived)}" if derived is not None else ""
        yield RULE.finding(
            [part.name],
            f"{quoted([part.name])} has a stated mass of {mass(stated.mass)}{beside}",
            found=mass(derived) if derived is not None else None,
            intended=mass(stated.mass),
            declared=part.source,
            remedy="Nothing if the stated mass is meant; it does not follow the geometry.",
        )


def _mass_of_geometry(part: Part) -> float | None:
    """Mass (kg) that the geometry would give."""
    if part.mesh is None or part.density is None or not part.solid:
        return None
    health = part.mesh.health
    return health.volume * part.density if health.watertight and health.volume > 0.0 else None


RULE = Rule("KF122", "mass-overridden", "note", __doc__, check, needs=("stated masses",))
