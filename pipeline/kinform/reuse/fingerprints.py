"""From what a result was computed, as one hash a result; and in words, what changed since.

A fingerprint covers the content of a stage's inputs (`inputs`), the settings, and the version of the code
that runs: no time of a file, no path, no order of events. Equal fingerprints are the licence to reuse.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
import re
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from kinform.reuse import inputs
from kinform.reuse.digest import digest
from kinform.version import __version__

if TYPE_CHECKING:
    from kinform.design import Design
    from kinform.model.assembly import Assembly, Mesh
    from kinform.model.surfaces import MeshSurfaces
    from kinform.model.tolerances import Tolerances

__all__ = [
    "Inputs",
    "changes",
    "listed",
    "mark",
    "of_assembly",
    "of_mesh",
    "of_pair",
    "of_parts",
    "of_stage",
    "versions_of",
]

Inputs = Mapping[str, str]
"""Hash of each input, by its name in words."""

_MOTION = ("simulation", "behaviour", "function", "kinematics", "collisions", "surfaces", "contacts", "foundation")
_CODE = {
    "assembly": ("form", "foundation"),
    "surfaces": ("surfaces", "foundation"),
    "contacts": ("contacts", "foundation"),
    "joints": ("kinematics", "foundation"),
    "mass": ("mass", "kinematics", "foundation"),
    "simulation": _MOTION,
    "findings": ("consistency", "statics", *_MOTION),
}
"""Rooms whose code decides the result of each stage."""

_ASSEMBLY_FIELDS = (
    "name", "units", "parts", "groups", "assumptions", "ground", "tolerances", "infer_fasteners", "function",
    "simulation", "subassemblies", "source", "files", "notes", "check",
)  # fmt: skip


def mark(stage: str, found: Inputs) -> str:
    """The fingerprint of a result of this stage with these inputs, computed by the present code."""
    return digest(stage, __version__, versions_of(stage), dict(found))


def versions_of(stage: str) -> list[int]:
    """The versions of all code that decides the result of a stage; imports none of it."""
    return [_version_of(name) for name in _CODE[stage]]


def _version_of(package: str) -> int:
    module = sys.modules.get(f"kinform.{package}")
    version = getattr(module, "CODE_VERSION", None)  # not there yet while the package is being imported
    return _stated_version(package) if version is None else int(version)


@functools.cache
def _stated_version(package: str) -> int:
    """As the text of the package says, since importing it takes longer than a run that reuses everything."""
    for file in (f"{package}/__init__.py", f"{package}.py"):
        try:
            text = pkgutil.get_data("kinform", file) or b""
        except OSError:  # another kind of module, or compiled only
            continue
        stated = re.search(rb"^CODE_VERSION(?:: int)? = (\d+)$", text, re.MULTILINE)
        if stated is not None:
            return int(stated[1])
    return int(importlib.import_module(f"kinform.{package}").CODE_VERSION)


def of_assembly(assembly: Assembly) -> Inputs:
    """Everything that was read."""
    return {"the input": digest(assembly)}


def of_mesh(mesh: Mesh, tolerances: Tolerances) -> Inputs:
    """Inputs of the surfaces of one mesh."""
    return {"the shape": digest(inputs.bare_mesh(mesh)), "the tolerances": digest(tolerances)}


def of_parts(assembly: Assembly, surfaces: Mapping[str, MeshSurfaces]) -> dict[str, Inputs]:
    """What each meshed part, as the contacts stage sees it, brings to the contacts of its pairs."""
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts if part.mesh is not None}
    shapes = {key: digest(mesh, surfaces[key]) for key, mesh in meshes.items() if key in surfaces}
    return {
        part.name: {
            f"the shape of {part.name}": shapes[part.mesh.digest],
            f"the pose of {part.name}": digest(part.X_WP),
            f"whether {part.name} is solid": digest(part.solid),
        }
        for part in assembly.parts
        if part.mesh is not None and part.mesh.digest in shapes
    }


def of_pair(tolerances: Tolerances, first: Inputs, second: Inputs) -> Inputs:
    """Inputs of the contacts of two parts, from what each brings."""
    return {"the tolerances": digest(tolerances), **first, **second}


def of_stage(stage: str, design: Design, level: str | None = None, ranges: bool | None = None) -> Inputs:
    """Inputs of a whole stage: contacts, joints, mass, simulation or findings."""
    view = inputs.assembly_for(stage, design.assembly)
    found = {name.replace("_", " "): digest(getattr(view, name)) for name in _ASSEMBLY_FIELDS}
    if stage in ("contacts", "joints", "mass", "findings"):
        found["surfaces"] = digest(design.surfaces)
    if stage in ("joints", "findings"):
        found["contacts"] = digest(design.contacts)
    if stage == "mass" and design.kinematics is not None:
        found["bodies"] = digest(design.kinematics.bodies)
    if stage in ("simulation", "findings"):
        found["joints"] = digest(design.kinematics)
        found["mass"] = digest(design.mass)
    if stage == "findings":
        found["the simulated motion"] = digest(design.simulation)
    if stage == "simulation":
        found |= {"surfaces": digest(design.surfaces), "contacts": digest(design.contacts)}
        if ranges is not None:
            found["whether ranges are asked for"] = "yes" if ranges else "no"
    return found if level is None else found | {"level": level}


def changes(before: Inputs | None, after: Inputs) -> str:
    """In words, why a result with the inputs `before` is not one with the inputs `after`; {}: nobody noted them."""
    if before is None:
        return "not computed before"
    changed = [name for name in after if before.get(name) != after[name]] if before else []
    return f"{listed(changed)} changed" if changed else "computed by another version of kinform"


def listed(names: Sequence[str]) -> str:
    """The first few of some names, as a sentence lists them."""
    shown = list(names) if len(names) <= 4 else [*names[:3], f"{len(names) - 3} more"]
    return " and ".join(([", ".join(shown[:-1])] if len(shown) > 1 else []) + shown[-1:])
