"""What the rules ask about a design, worked out once.

A stage that has not been run is not an error here: its property is then the inconclusive outcome
that the rule hands on.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from kinform.consistency.comparisons.intended_joints import Comparison, bodies_of, compare
from kinform.consistency.comparisons.plausibility import Doubt, doubts
from kinform.consistency.control import Unused
from kinform.consistency.rule import Outcome, inconclusive, skipped
from kinform.design import Design
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.contacts import Contacts
from kinform.model.function import Function
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation

__all__ = ["Context", "MeshUse"]

Stage = TypeVar("Stage")


@dataclass(frozen=True, eq=False)
class MeshUse:
    """A mesh with the parts that use it, sorted by name."""

    mesh: Mesh
    parts: tuple[Part, ...]

    @property
    def subject(self) -> tuple[str, ...]:
        """Names of the parts."""
        return tuple(part.name for part in self.parts)

    @property
    def label(self) -> str:
        """File, and body in the file: "parts/arm.obj, body 'link'"."""
        return self.mesh.path if self.mesh.body is None else f"{self.mesh.path}, body '{self.mesh.body}'"

    @property
    def solid(self) -> bool:
        """Whether any of the parts is meant to be a solid."""
        return any(part.solid for part in self.parts)


@dataclass(frozen=True, eq=False)
class Context:
    """One design under check."""

    design: Design
    unused_settings: tuple[Unused, ...] | None = None
    """Entries of `[check]` without effect; None before the other rules have run."""

    @property
    def assembly(self) -> Assembly:
        """The assembly."""
        return self.design.assembly

    @property
    def function(self) -> Function:
        """The stated function."""
        return self.design.assembly.function

    @property
    def units(self) -> str:
        """The unit in which lengths are shown."""
        return self.design.assembly.units

    @cached_property
    def meshes(self) -> tuple[MeshUse, ...]:
        """Every distinct mesh once, in the order of the first part that uses it."""
        uses: dict[tuple[str, str, str], list[Part]] = {}
        for part in sorted(self.assembly.parts, key=lambda part: part.name):
            if part.mesh is not None:
                key = (part.mesh.path, part.mesh.body or "", part.mesh.digest)
                uses.setdefault(key, []).append(part)
        return tuple(MeshUse(parts[0].mesh, tuple(parts)) for parts in uses.values() if parts[0].mesh is not None)

    @cached_property
    def shaped(self) -> frozenset[str]:
        """Bodies of which a part has a mesh; empty without kinematics."""
        if self.design.kinematics is None:
            return frozenset()
        of_part = {part: body.name for body in self.design.kinematics.bodies for part in body.parts}
        return frozenset(of_part[part.name] for part in self.assembly.parts if part.mesh is not None)

    @cached_property
    def doubts(self) -> tuple[Doubt, ...]:
        """What is implausible about the sizes."""
        return doubts(self.assembly)

    @cached_property
    def _mistaken_scale(self) -> Outcome | None:
        """Why contacts, and all that follows from them, mean nothing at this size; None when they do."""
        if not self.meshes or self.assembly.tolerances.contact is not None:
            return None
        if not any(doubt.severity == "error" for doubt in self.doubts):
            return None
        return inconclusive("the units are implausible (KF110): contacts found at this size mean nothing")

    def _stage(self, value: Stage | None, missing: str) -> Stage | Outcome:
        if self._mistaken_scale is not None:
            return self._mistaken_scale
        return inconclusive(missing) if value is None else value

    @cached_property
    def contacts(self) -> Contacts | Outcome:
        """Contacts; skipped without meshes, inconclusive when not found yet."""
        if not self.meshes:
            return skipped("no part has a mesh")
        return self._stage(self.design.contacts, "contacts have not been found: run `kinform contacts`")

    @cached_property
    def kinematics(self) -> Kinematics | Outcome:
        """Joints and mobility; inconclusive when not derived yet."""
        return self._stage(self.design.kinematics, "joints have not been derived: run `kinform joints`")

    @cached_property
    def mass(self) -> MassReport | Outcome:
        """Mass properties; inconclusive when not computed yet."""
        if self.design.mass is None:
            return inconclusive("mass has not been computed: run `kinform mass`")
        return self.design.mass

    @property
    def simulation_requested(self) -> bool:
        """Whether the manifest, or whoever ran the simulation, asked for one."""
        ran = self.design.simulation is not None and self.design.simulation.status != "not requested"
        return ran or self.assembly.simulation is not None or bool(self.function.drives)

    @cached_property
    def simulation(self) -> Simulation | Outcome:
        """The simulation; skipped when not requested, inconclusive when not run yet."""
        if not self.simulation_requested:
            return skipped("no simulation is requested")
        simulation = self.design.simulation
        if simulation is not None and simulation.status == "not requested":
            simulation = None
        return self._stage(simulation, "the simulation has not been run: run `kinform simulate`")

    @cached_property
    def comparisons(self) -> tuple[Comparison, ...] | Outcome:
        """Each intended joint beside what geometry gives, sorted by name."""
        if not self.function.joints:
            return skipped("the function states no joint")
        if isinstance(self.kinematics, Outcome):
            return self.kinematics
        joints = sorted(self.function.joints, key=lambda joint: joint.name)
        found = tuple(compare(self.assembly, self.design.contacts, self.kinematics, joint) for joint in joints)
        if all(comparison.state == "stated" for comparison in found):
            return skipped("all joints come from the function itself: there is no geometry to compare")
        return found

    @cached_property
    def answers(self) -> dict[int, Any]:
        """Answers to requirements that were worked out already, by the identity of the requirement."""
        return {}

    @cached_property
    def intended_pairs(self) -> frozenset[tuple[str, str]]:
        """Pairs of bodies (sorted names) that an intended joint joins; empty without kinematics."""
        if isinstance(self.kinematics, Outcome):
            return frozenset()
        pairs = (bodies_of(self.assembly, self.kinematics, joint.between) for joint in self.function.joints)
        return frozenset((min(pair), max(pair)) for pair in pairs)

    @cached_property
    def intended_bodies(self) -> frozenset[str]:
        """Bodies that an intended joint names; empty without kinematics."""
        return frozenset(name for pair in self.intended_pairs for name in pair)

    def body(self, name: str) -> str | None:
        """Name of the body that contains a part or group; None without kinematics."""
        if self.design.kinematics is None:
            return None
        return self.design.kinematics.body_of(self.assembly.parts_of(name)[0]).name

    def joint(self, name: str) -> Joint | None:
        """The derived joint of that name."""
        if isinstance(self.kinematics, Outcome):
            return None
        return next((joint for joint in self.kinematics.joints if joint.name == name), None)

    def place_of(self, joint: Joint) -> tuple[float, float, float] | None:
        """A point (m) at the joint: on its axis, else in the middle of its contact."""
        if joint.point is not None:
            return _triple(joint.point)
        contacts = self.design.contacts
        points = [contacts.patches[k].points for k in joint.patches] if contacts is not None else []
        return _triple(np.concatenate(points).mean(axis=0)) if any(map(len, points)) else None


def _triple(point: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in point)
    return (x, y, z)
