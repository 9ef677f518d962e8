"""What a run will need of later stages, made ready while other processes are at work at an earlier one.

Processes that share a stage seldom end together, and stages between them are done by one: their modules are imported,
and the parts weighed, in time that one processor would have waited. Nothing of it changes what the stages give, and
where a stage is done by one process nothing is done ahead.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence

from kinform.model.assembly import Assembly
from kinform.model.mass import MassProperties
from kinform.model.surfaces import MeshSurfaces
from kinform.reuse.dependence import MASS

LARGE = 100_000
"""Facets of an assembly from which on something is done ahead: surfaces of so many take a second, what is imported
ahead half of one."""

_JOINTS = ("kinform.kinematics.derivation", "scipy.optimize", "kinform.mass.compile")
_MOTION = ("kinform.simulation", "kinform.collisions", "kinform.behaviour.from_design")
_FINDINGS = ("kinform.consistency.inspection", "kinform.results.groups.behaviour")


def of(assembly: Assembly) -> Ahead | None:
    """For an assembly where it is worth it."""
    facets = sum(len(part.mesh.faces) for part in assembly.parts if part.mesh is not None)
    return Ahead(assembly) if facets >= LARGE else None


class Ahead:
    """What one run has made ready; each is to be called while other processes are at work."""

    def __init__(self, assembly: Assembly):
        self._assembly = assembly
        self.masses: dict[str, MassProperties] = {}
        """Of parts, by name."""

    def with_surfaces(self) -> None:
        """While surfaces are looked for."""
        _load(_JOINTS)

    def with_contacts(self, surfaces: Mapping[str, MeshSurfaces]) -> None:
        """While contacts between parts of these surfaces, by mesh, are looked for."""
        from kinform.mass.compile import masses_of_parts

        _load(_MOTION)
        if not self.masses:
            found = masses_of_parts(MASS.view(self._assembly), surfaces)
            self.masses.update((item.name, item) for item in found)

    def with_ranges(self) -> None:
        """While it is looked for how far joints go."""
        _load(_FINDINGS)


def _load(names: Sequence[str]) -> None:
    for name in names:
        importlib.import_module(name)
