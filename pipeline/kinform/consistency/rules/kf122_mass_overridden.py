"""The mass properties of a part are stated in the manifest and replace those of its geometry.

Why it matters: they do not follow when the geometry changes.

What to do: nothing if that is meant, as for a bought part. Otherwise remove `mass` and give a material.

Example: a servo of 55 g whose mesh is only its outside.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Outcome, Rule, decided, skipped
from kinform.foundation.words import mass, quoted
from kinform.model.assembly import Part

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Meshed parts with stated mass, beside the mass of their geometry where that is known."""
    stated = [part for part in context.assembly.parts if part.override is not None and part.mesh is not None]
    if not stated:
        return skipped("no part with a mesh has a stated mass")
    findings = []
    for part in stated:
        assert part.override is not None
        derived = _derived(part)
        beside = f", its geometry {mass(derived)}" if derived is not None else ""
        findings.append(
            RULE.finding(
                [part.name],
                f"{quoted([part.name])} has a stated mass of {mass(part.override.mass)}{beside}",
                found=mass(derived) if derived is not None else None,
                intended=mass(part.override.mass),
                declared=part.source,
                remedy="Nothing if the stated mass is meant; it does not follow the geometry.",
            )
        )
    return decided(findings)


def _derived(part: Part) -> float | None:
    """Mass (kg) that the geometry would give."""
    if part.mesh is None or part.density is None or not part.solid:
        return None
    health = part.mesh.health
    return health.volume * part.density if health.watertight and health.volume > 0.0 else None


RULE = Rule("KF122", "mass-overridden", "note", __doc__, check)
