"""Parts, contacts and masses as JSON has them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from kinform.design import Design
from kinform.model.assembly import Assembly, Part
from kinform.model.function import IntendedJoint
from kinform.model.mass import MassProperties
from kinform.reports.values.plain import fields


def assembly_values(design: Design) -> dict[str, Any]:
    """Parts, groups, function and tolerances."""
    assembly = design.assembly
    return {
        "ground": assembly.ground,
        "parts": [_part(part) for part in assembly.parts],
        "groups": [fields(group, "name", "parts") for group in assembly.groups],
        "subassemblies": [fields(sub, "name", "file", "mobility") for sub in assembly.subassemblies],
        "assumptions": [
            fields(assumption, "between", "type", "ignore", "axis", "point", "pitch", "reason")
            for assumption in assembly.assumptions
        ],
        "function": _function(assembly),
        "tolerances": asdict(assembly.tolerances),
        "files": assembly.files,
        "notes": assembly.notes,
    }


def _part(part: Part) -> dict[str, Any]:
    mesh = part.mesh
    return {
        "name": part.name,
        "mesh": None if mesh is None else fields(mesh, "path", "body", "digest") | asdict(mesh.health),
        "pose": part.X_WP,
        **fields(part, "solid", "material", "density"),
        "mass": None if part.override is None else part.override.mass,
        "units": part.units,
    }


def _function(assembly: Assembly) -> dict[str, Any]:
    def joint(wanted: IntendedJoint) -> dict[str, Any]:
        return fields(wanted, "name", "between", "type", "axis", "axis2", "point", "pitch", "range")

    function = assembly.function
    return {"mobility": function.mobility, "joints": [joint(wanted) for wanted in function.joints]}


def contact_values(design: Design) -> dict[str, Any]:
    """Patches, interferences and suggestions."""
    contacts = design.contacts
    assert contacts is not None
    of_patch = (
        "parts", "surfaces", "kind", "one_sided", "area", "gap", "fit", "axis", "point", "radii", "misalignment",
        "offset", "chord",
    )  # fmt: skip
    of_overlap = ("parts", "volume", "depth", "place", "mated", "method")
    return {
        "patches": [{"index": i} | fields(patch, *of_patch) for i, patch in enumerate(contacts.patches)],
        "interferences": [fields(overlap, *of_overlap) for overlap in contacts.interferences],
        "possible_overlaps": [fields(overlap, *of_overlap) for overlap in contacts.possible_overlaps],
        "suggestions": [
            fields(hint, "parts", "kind", "fastens", "confidence", "evidence", "axis", "point")
            for hint in contacts.suggestions
        ],
        "pairs": [{"parts": pair, "tolerance": contacts.tolerance.get(pair)} for pair in contacts.candidates],
    }


def mass_values(design: Design) -> dict[str, Any]:
    """Mass properties of parts and bodies."""
    report = design.mass
    assert report is not None
    return {
        "valid": report.valid,
        "parts": [_properties(part) for part in report.parts],
        "bodies": [_properties(body) for body in report.bodies],
        "problems": [{"part": part, "message": message} for part, message in report.problems],
    }


def _properties(item: MassProperties) -> dict[str, Any]:
    names = ("name", "mass", "volume", "centre_of_mass", "inertia", "principal_moments", "principal_axes")
    return fields(item, *names, "mass_bound", "origin") | {"reason": item.reason or None}
