"""A stated mass or inertia is far from what the geometry gives at any plausible density.

The density that a stated mass takes is told: mass over the volume that closed meshes enclose (parts that share space
count twice), and over the volume of the convex hull, which nothing can exceed. An error where the hull would have to be
denser than any material (23 000 kg/m³), or the inertia is larger than if all of the mass were at the farthest point of
the shape, and 30 times that of the mass spread evenly. A warning above 12 000 kg/m³ or below 5 kg/m³ of the enclosed
volume, where the inertia is too large for the shape by less (something may not be drawn), or 30 times less than that of
the mass spread evenly. Where the stated centre of mass is the centroid of the closed geometry, the link was weighed as
a solid: a principal moment of less than half of what the solid has is a warning, and so is an inertia that is that of
the solid about the frame of the link. A cause that explains the numbers is named: terms of the parallel axis theorem
that were left out when parts were summed, or a mass that was changed alone. Impossible masses and inertias are KF121.

Why it matters: torques, natural frequencies and controllers tuned in simulation are wrong by the same factor, and a
simulator with tiny inertias needs tiny steps or explodes.

What to do: correct the number: inertias are in kg·m², not kg·mm² (a factor of 10⁶) or g·mm² (10⁹). `kinform export
F.h5 --to urdf --fix inertia` writes those of the geometry.

Example: a link of 147 g and 12 cm across with an inertia of 9.4e4 kg·m²: the number is in g·mm².
"""

from __future__ import annotations

import math

import numpy as np

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.comparisons.links import Weighed
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import counted, mass, number, volume
from kinform.mass.shapes import solid_of
from kinform.model.arrays import Array
from kinform.model.findings import Witness, computed

DENSEST = 23000.0
"""kg/m³: osmium has 22 600. Nothing has more mass over the volume of its convex hull, in which all of it is."""
HEAVY = 12000.0
"""kg/m³ above which what closed meshes enclose is doubted: lead has 11 340; a screw or a motor that is not drawn makes
a small part heavy."""
LIGHT = 5.0
"""kg/m³ below which what closed meshes enclose is doubted: the lightest foams have 10; hollow links of public robots
have 100 and more."""
INERTIA_LARGE = 1.001
"""Share of m·r² (r from the centre of mass to the farthest point of the hull) above which half the trace of an inertia
is impossible: rounding of stated numbers."""
INERTIA_FAR = 30.0
"""Factor by which an inertia may be below or above that of the same mass, spread evenly over the shape, before it is
doubted: hollow shells have up to 3, dense motors in light shells down to a tenth."""

SAME_CENTRE = 0.02
"""Share of a link's size by which the stated centre of mass may be off the centroid of its geometry, and is that. In 38
public robots the moments of such links are the geometry's within a third, but for those that are plainly wrong."""
TOO_SMALL = 0.5
"""Share of the geometry's principal moment below which the stated one is doubted there: dense cores have 0.64."""
EXPLAINED = 0.05
"""Share of its trace by which an inertia may be off one that explains it. Chosen, not measured."""


_KEYS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_SIX = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_UNITS = {1e9: "g·mm²", 1e6: "kg·mm²", 1e4: "kg·cm²", 1e3: "g·m²", 1e7: "g·cm²"}


def check(context: Context) -> Outcome:
    """Every stated mass beside its geometry."""
    ranked: list[Ranked] = []
    doubted = {name for doubt in context.doubts for name in doubt.subject}
    for body in context.weighed:
        if not body.possible or body.hull is None or doubted & {body.name, *(part.name for part in body.parts)}:
            continue
        of_solid = _of_solid(context, body)
        explained = of_solid if of_solid is not None and of_solid.kind == "explained" else None
        found = _of_mass(context, body) or explained or _of_inertia(body) or of_solid
        if found is not None:
            ranked.append(found)
    findings = gathered(ranked, "link" if context.assembly.descriptions else "part")
    return decided(findings, f"{counted(len(context.weighed), 'stated mass', 'stated masses')} compared")


def _of_mass(context: Context, body: Weighed) -> Ranked | None:
    assert body.hull is not None
    units, solid = context.units, body.solid
    if body.hull.volume > 0.0 and body.mass / body.hull.volume > DENSEST:
        density = body.mass / body.hull.volume
        text = (
            f"{body.what} states {mass(body.mass)}, and its geometry fits into {volume(body.hull.volume, units)}: "
            f"that would take more than {number(density, 3)} kg/m³, denser than any material"
        )
        names = [part.name for part in body.parts if part.mesh is not None]
        witness = computed("density of the hull", density, DENSEST, parts=names, mass=body.mass)
        return _finding("error", body, text, density, witness)
    if solid is None:
        return None
    density = body.mass / solid.volume
    if density > HEAVY and not solid.open_parts:
        why = "denser than lead"
    elif density < LIGHT:
        why = "lighter than any foam"
    else:
        return None
    text = (
        f"{body.what} states {mass(body.mass)}, and its geometry encloses {volume(solid.volume, units)}: that would "
        f"take {number(density, 3)} kg/m³, {why}"
    )
    return _finding("warning", body, text, density)


def _finding(severity: str, body: Weighed, text: str, density: float, witness: Witness | None = None) -> Ranked:
    finding = RULE.at(severity).finding(
        [body.name], text,
        found=f"{number(density, 3)} kg/m³",
        intended=f"a density between {number(LIGHT)} and {number(HEAVY)} kg/m³",
        place=body.centre,
        declared=body.source,
        remedy="Correct the mass (kg), or the scale of the mesh; or draw what is heavy.",
        witness=witness,
    )  # fmt: skip
    return Ranked("heavy" if density > HEAVY else "light", max(density / HEAVY, LIGHT / density), finding)


def _of_inertia(body: Weighed) -> Ranked | None:
    assert body.hull is not None
    reach = float(np.linalg.norm(body.hull.corners - body.centre, axis=1).max())
    half_trace = 0.5 * float(np.trace(body.inertia))
    most = body.mass * reach * reach
    even, witness = _even(body), None
    ratio = half_trace / even if even > 0.0 else 1.0
    if half_trace > INERTIA_LARGE * most:
        severity = "error" if ratio > INERTIA_FAR else "warning"
        witness = computed(
            "inertia beyond reach", half_trace / most if most > 0.0 else math.inf, INERTIA_LARGE,
            parts=[part.name for part in body.parts if part.mesh is not None], mass=body.mass, centre=body.centre,
            trace=2.0 * half_trace,
        )  # fmt: skip
        why = "of the mass spread evenly, and more than if all of it were at the farthest point of its geometry"
    elif half_trace <= 0.0 or not 1.0 / INERTIA_FAR < ratio < INERTIA_FAR:
        severity, why = "warning", "of the same mass spread evenly over its geometry"
    else:
        return None
    solid = body.solid
    needed = half_trace / (0.5 * float(np.trace(solid.inertia))) if solid is not None else math.nan
    takes = f"; that would take {number(needed, 3)} kg/m³" if math.isfinite(needed) and needed > 0.0 else ""
    shown, usual = number(2.0 * half_trace, 3), number(2.0 * even, 3)
    factor = f"{number(ratio, 2)} times" if ratio >= 1.0 else f"1/{number(1.0 / ratio, 2) if ratio > 0.0 else '∞'} of"
    text = (
        f"{body.what} of {mass(body.mass)} states moments of inertia of {shown} kg·m² in all, {factor} the {usual} "
        f"{why}{takes}"
    )
    finding = RULE.at(severity).finding(
        [body.name], text,
        found=f"{shown} kg·m²",
        intended=f"about {usual} kg·m²",
        place=body.centre,
        declared=body.source,
        remedy=f"Correct the inertia (kg·m²){_unit(ratio)}; `kinform export --to urdf --fix inertia` writes "
        "that of the geometry.",
        witness=witness,
    )  # fmt: skip
    return Ranked("inertia", max(ratio, 1.0 / ratio) if ratio > 0.0 else math.inf, finding)


def _of_solid(context: Context, body: Weighed) -> Ranked | None:
    """Principal moments beside those of the solid whose centroid the stated centre of mass is."""
    solid = body.solid
    if solid is None or solid.open_parts or np.linalg.norm(solid.centroid - body.centre) > SAME_CENTRE * body.size:
        return None
    density = body.mass / solid.volume
    moments, axes = np.linalg.eigh(density * solid.inertia)
    ratios = np.einsum("ij,ik,kj->j", axes, body.inertia, axes) / moments
    of_frame = _about_frame(body, density * solid.inertia)
    worst = int(np.argmax(ratios) if of_frame else np.argmin(ratios))
    if not of_frame and ratios[worst] >= TOO_SMALL:
        return None
    ratio = float(ratios[worst])
    stated, usual = number(float(ratio * moments[worst]), 3), number(float(moments[worst]), 3)
    off = f", {number(max(ratio, 1.0 / ratio), 2)} times too {'small' if ratio < 1.0 else 'large'}" if ratio else ""
    text = (
        f"{body.what} of {mass(body.mass)} states a principal moment of inertia of {stated} kg·m²{off}: its closed "
        f"geometry with the same centre of mass has {usual} kg·m² at that mass"
    )
    cause = of_frame or _summed(body, density, ratios)
    finding = RULE.finding(
        [body.name], text + (f"; likely cause: {cause}" if cause else ""),
        found=f"{stated} kg·m²{off}",
        intended=f"about {usual} kg·m²",
        place=body.centre,
        declared=body.source,
        remedy=_written(context, body, density * solid.inertia),
    )  # fmt: skip
    return Ranked("explained" if cause else "solid", max(ratio, 1.0 / ratio) if ratio > 0.0 else math.inf, finding)


def _about_frame(body: Weighed, inertia: Array) -> str:
    """That the stated inertia is this one (3, 3) about the frame of the link; "" where it is not, or is no other."""
    if body.described is None:
        return ""
    arm = body.centre - body.described.position
    moved = inertia + body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    off, size = float(np.linalg.norm(body.inertia - moved)), float(np.trace(moved))
    if size <= float(np.trace(inertia)) / TOO_SMALL or off > EXPLAINED * size:
        return ""
    return "the inertia is about the frame of the link, and not about the centre of mass"


def _summed(body: Weighed, density: float, ratios: Array) -> str:
    """What explains moments that are too small: "" where neither does."""
    assert body.solid is not None
    whole = density * body.solid.inertia
    if float(np.ptp(ratios)) <= EXPLAINED * float(np.max(ratios)):
        return "mass and inertia are of different densities"
    pieces = [solid_of([part]) for part in body.parts]
    own = density * sum((piece.inertia for piece in pieces if piece is not None), np.zeros((3, 3)))
    of_parts = len(pieces) > 1 and float(np.linalg.norm(body.inertia - own)) <= EXPLAINED * float(np.trace(own))
    # Σ m d dᵀ of parts at d from the common centre: of two parts it has one direction
    missing = 0.5 * float(np.trace(whole - body.inertia)) * np.eye(3) - (whole - body.inertia)
    (least, middle, most), lines = np.linalg.eigh(missing)
    about = (float(lines[:, 2] @ tensor @ lines[:, 2]) for tensor in (body.inertia, whole))
    kept = abs(next(about) / next(about) - 1.0) <= EXPLAINED
    along_one = kept and most > 0.0 and max(abs(least), abs(middle)) <= EXPLAINED * most
    if not (of_parts or along_one):
        return ""
    return "inertias of parts were summed without the terms of the parallel axis theorem"


def _written(context: Context, body: Weighed, inertia: Array) -> str:
    """The inertia of the geometry (3, 3), ready to paste where the file has it along the axes of the link."""
    link = body.described
    if link is None:
        return "Correct the inertia (kg·m² about the centre of mass), or remove it and give a density."
    export = "`kinform export --to urdf --fix inertia` writes that of the geometry"
    R = link.rotation
    along = R.T @ body.inertia @ R
    six = None if link.stated is None else link.stated.inertia
    (form,) = {str(d.format) for d in context.assembly.descriptions if link in d.links} or {""}
    if six is None or form != "urdf" or not np.allclose(six, [along[k] for k in _SIX], atol=1e-6 * np.trace(along)):
        return f"Correct the inertia (kg·m² about the centre of mass); {export}."
    least = SINGLE * float(np.trace(inertia))
    values = {key: float((R.T @ inertia @ R)[k]) for key, k in zip(_KEYS, _SIX, strict=True)}
    shown = " ".join(f'{key}="{number(value if abs(value) > least else 0.0, 5)}"' for key, value in values.items())
    return f"State <inertia {shown}/>; {export}."


def _even(body: Weighed) -> float:
    """Half the trace (kg·m²) of the inertia about its own centre that the mass has, spread evenly."""
    solid = body.solid
    if solid is not None:
        return 0.5 * body.mass * float(np.trace(solid.inertia)) / solid.volume
    assert body.hull is not None
    away = body.hull.corners - body.hull.corners.mean(axis=0)
    return 0.6 * body.mass * float((away * away).sum(axis=1).mean())  # a full ball has 3/5 of its radius squared


def _unit(ratio: float) -> str:
    """The unit in which the number would be right, where a factor of ten says one."""
    fits = [unit for factor, unit in _UNITS.items() if 1.0 / 3.0 < ratio / factor < 3.0]
    return f": the number fits {fits[0]}" if fits else ""


RULE = Rule("KF123", "mass-implausible", "warning", __doc__, check, needs=("weighed shapes",), also=("error",))
