"""What the rules ask about a design, worked out once, and why something that they need is not there.

A stage that has not been run is not an error: what a rule needs of it is then lacking, with the outcome that the rule
hands on (`lacks`). Properties that give the result of a stage may be read where it is not lacking only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np

from kinform.behaviour import imposed_couplings
from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.comparisons.couplings import coupled_through
from kinform.consistency.comparisons.forbidden import Forbidden, forbidden
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.consistency.comparisons.known import bodies_of
from kinform.consistency.comparisons.links import Weighed, weighed
from kinform.consistency.comparisons.plausibility import Doubt, doubts
from kinform.consistency.outcome import Outcome, inconclusive, skipped
from kinform.consistency.questions.blocked_joints import BlockedJoints
from kinform.consistency.questions.captive_parts import CaptivePart, CaptiveParts
from kinform.consistency.questions.empty_bores import Row, empty_rows
from kinform.consistency.questions.open_loops import OpenLoop, open_loops
from kinform.design import Design
from kinform.foundation.meshes.shell_faults import ShellFaults, shell_faults
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly, MassOverride, Mesh, Part
from kinform.model.checks import Ignore
from kinform.model.contacts import Contacts
from kinform.model.function import PASSIVE, Function, Requirement
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation
from kinform.requirements.answer import Answer, triple

if TYPE_CHECKING:
    from kinform.collisions.parts.shapes import Shapes

DAMPED_UNSEEN = 1e-6
"""Share of the energy exchanged that went with vibrations which the solver damped, up to which the motion is known:
they had a thousandth of its speeds. A choice."""


Stage = TypeVar("Stage")
Need = Literal[
    "meshes", "solid meshes", "closed meshes", "stated masses", "sizes", "contacts", "kinematics", "mass",
    "attempt", "simulation", "motion", "forces", "comparisons", "intended joints", "stated mobility", "stated joints",
    "stated ranges", "stated couplings",
    "stated drives", "stated loads", "stated assumptions", "stated initial values", "inferred fasteners",
    "several parts", "stated mobility of sub-assemblies", "descriptions", "weighed shapes", "collision geometry",
    "described limits",
]  # fmt: skip
"""What a rule may need of a design: meshes, results of stages, something that the manifest states."""
APPLIES: dict[Need, tuple[Callable[[Context], object], str]] = {
    "meshes": (lambda c: c.meshes, "no part has a mesh"),
    "solid meshes": (lambda c: any(use.solid for use in c.meshes), "no part is a solid with a mesh"),
    "stated masses": (lambda c: c.overridden, "no part with a mesh has a stated mass"),
    "sizes": (
        lambda c: c.meshes or sum(joint.point is not None for joint in c.function.joints) > 1,
        "no part has a mesh, and fewer than two joints have a point",
    ),
    "closed meshes": (lambda c: c.closed_meshes, "no mesh is closed"),
    "several parts": (lambda c: len(c.assembly.parts) > 1, "the assembly has only one part"),
    "stated mobility": (lambda c: c.function.mobility is not None, "the function states no mobility"),
    "stated mobility of sub-assemblies": (
        lambda c: any(s.mobility is not None for s in c.assembly.subassemblies),
        "no sub-assembly states a mobility",
    ),
    "stated joints": (lambda c: c.function.joints, "the function states no joint"),
    "stated ranges": (lambda c: any(j.range is not None for j in c.function.joints), "no range is stated"),
    "stated couplings": (lambda c: c.function.couplings, "the function states no coupling"),
    "stated drives": (lambda c: c.function.drives, "the function states no drive"),
    "stated loads": (lambda c: c.function.loads, "the function states no load"),
    "stated assumptions": (lambda c: c.assembly.assumptions, "the manifest assumes nothing"),
    "stated initial values": (
        lambda c: c.assembly.simulation is not None and c.assembly.simulation.initial,
        "no initial value is stated",
    ),
    "descriptions": (lambda c: c.assembly.descriptions, "no source is a robot description"),
    "weighed shapes": (lambda c: c.weighed, "nothing with a mesh has a stated mass"),
    "collision geometry": (
        lambda c: any(link.collisions for d in c.assembly.descriptions for link in d.links),
        "no description has collision geometry",
    ),
    "described limits": (
        lambda c: any(j.needs_limits or j.limits for d in c.assembly.descriptions for j in d.joints),
        "no description states limits of joints",
    ),
    "inferred fasteners": (lambda c: c.assembly.infer_fasteners, "the manifest does not ask to infer fasteners"),
}
"""Where a rule does not apply: whether what it needs is there, and the reason where it is not."""
NOT_RUN: dict[Need, str] = {
    "contacts": "contacts have not been found: run `kinform contacts`",
    "kinematics": "joints have not been derived: run `kinform joints`",
    "mass": "mass has not been computed: run `kinform mass`",
    "attempt": "the simulation has not been run: run `kinform simulate`",
}
"""By stage: why a rule that needs its result is inconclusive."""
DAMPED = "vibrations that the solver could not follow were damped (KF508)"
"""Why rules that would have to know them are inconclusive."""


@dataclass(frozen=True)
class Unused:
    """An entry of `[check]` that changed nothing, and why."""

    name: str
    """The rule as the entry has it."""
    message: str
    ignore: Ignore | None = None


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
        if self.mesh.body is None:
            return self.mesh.path
        return f"{self.mesh.path}, body '{self.mesh.body}'" if self.mesh.path else f"'{self.mesh.body}'"

    @property
    def solid(self) -> bool:
        """Whether any of the parts is meant to be a solid."""
        return any(part.solid for part in self.parts)


@dataclass(frozen=True, eq=False)
class Context:
    """One design under check."""

    design: Design
    judges: Mapping[str, Callable[[Context, Requirement], Answer]] = field(default_factory=dict)
    """What answers each kind of requirement that `[check]` asks about."""
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
    def closed_meshes(self) -> tuple[MeshUse, ...]:
        """Those that bound a volume: watertight, and wound one way."""
        return tuple(u for u in self.meshes if u.mesh.health.watertight and u.mesh.health.consistent_winding)

    @cached_property
    def shell_faults(self) -> tuple[ShellFaults, ...]:
        """Of each of the meshes, what is wrong with its shells."""
        return tuple(shell_faults(use.mesh) for use in self.meshes)

    @cached_property
    def overridden(self) -> tuple[tuple[Part, MassOverride], ...]:
        """Parts with a mesh whose mass is stated, with what is stated."""
        return tuple((p, p.override) for p in self.assembly.parts if p.mesh is not None and p.override is not None)

    @cached_property
    def weighed(self) -> tuple[Weighed, ...]:
        """Parts and groups with meshes whose mass is stated."""
        return tuple(weighed(self.assembly))

    @cached_property
    def shaped(self) -> frozenset[str]:
        """Bodies of which a part has a mesh; empty without kinematics."""
        if self.design.kinematics is None:
            return frozenset()
        of_part = {part: body.name for body in self.design.kinematics.bodies for part in body.parts}
        return frozenset(of_part[part.name] for part in self.assembly.parts if part.mesh is not None)

    @cached_property
    def shapes(self) -> Shapes:
        """The meshes of all parts, for questions about motions. Needs contacts and kinematics."""
        from kinform.collisions.joint_ranges import shapes_of  # most designs ask for no motion here

        return shapes_of(self.assembly, self.design.surfaces, self.contacts, self.kinematics)

    @cached_property
    def doubts(self) -> tuple[Doubt, ...]:
        """What is implausible about the sizes."""
        return doubts(self.assembly)

    @cached_property
    def _nothing_to_touch(self) -> Outcome | None:
        """Why contacts, and all that follows from them, mean nothing; None when they do."""
        if self.assembly.lost:
            return inconclusive("mesh files have lost the shapes of parts (KF111): contacts of these mean nothing")
        if self.assembly.tolerances.contact is None and any(doubt.severity == "error" for doubt in self.doubts):
            return inconclusive("parts are in different units (KF110): contacts between them mean nothing")
        return None

    def lacks(self, need: Need) -> Outcome | None:
        """Why what a rule needs is not there: it does not apply, or nothing can be decided; None where it is there."""
        if need in APPLIES:
            present, reason = APPLIES[need]
            return None if present(self) else skipped(reason)
        if need == "simulation":
            missing, attempt = self.lacks("attempt"), self.design.simulation
            if missing is not None or attempt is None or not attempt.partial:
                return missing
            held = ", ".join(dict.fromkeys(subject for subject, _ in attempt.failures))
            return inconclusive(f"the simulation is partial: {held}: held, because not understood")
        if need in ("motion", "forces"):
            return self.lacks("simulation") or self._unseen(need)
        if need == "intended joints":
            return self.lacks("stated joints") or self.lacks("kinematics")
        if need == "comparisons":
            no_geometry = skipped("all joints come from the function itself: there is no geometry to compare")
            missing = self.lacks("stated joints") or self.lacks("kinematics")
            return missing or (no_geometry if all(c.state == "stated" for c in self._every_comparison) else None)
        if need == "contacts" and not self.meshes:
            return self.lacks("meshes")
        if need == "attempt" and not self.simulation_requested:
            return skipped("no simulation is requested")
        if need != "mass" and self._nothing_to_touch is not None:
            return self._nothing_to_touch
        result = self.design.simulation if need == "attempt" else getattr(self.design, need)
        run = result is not None and not (isinstance(result, Simulation) and result.status == "not requested")
        return None if run else inconclusive(NOT_RUN[need])

    def _unseen(self, need: Need) -> Outcome | None:
        """Why a simulation does not show the motion, or the forces."""
        run = self.simulation
        if need == "motion" and len(run.time) < 2:
            return skipped("nothing moved")
        if need == "motion" and run.damped_share > DAMPED_UNSEEN:
            return inconclusive(f"{DAMPED}: the motion is known without them only")
        return inconclusive(f"{DAMPED}: their forces are not known") if need == "forces" and run.dampings else None

    def _result(self, need: Need, result: Stage | None) -> Stage:
        """The result of a stage, which is not lacking."""
        lacking = self.lacks(need)
        if lacking is not None or result is None:
            raise LookupError(f"{need}: {lacking.reason if lacking else 'none'}; a rule must declare what it needs")
        return result

    @cached_property
    def contacts(self) -> Contacts:
        """Contacts."""
        return self._result("contacts", self.design.contacts)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Joints and mobility."""
        return self._result("kinematics", self.design.kinematics)

    @cached_property
    def afloat(self) -> CaptiveParts:
        """Parts with play between two others that they do not both touch."""
        return CaptiveParts(self.assembly, self.contacts)

    @cached_property
    def blocked_joints(self) -> BlockedJoints | None:
        """Joints that finite steps prove to be blocked; None without contacts."""
        if self.lacks("contacts") is not None:
            return None
        return BlockedJoints(self.assembly, self.design.surfaces, self.contacts)

    def forbidden(self, compared: Comparison) -> Forbidden | None:
        """What proves that contact forbids an intended joint, or why that is open; None where contact gives the joint,
        or more, or is not decided itself. Needs kinematics, though what it follows from may mean nothing."""
        assert self.design.kinematics is not None
        return forbidden(self.assembly, self.design.kinematics, self.blocked_joints, compared)

    def with_play(self, parts: Iterable[str] | None = None) -> CaptivePart | None:
        """The first part with play between two bodies, of some parts or of all, that it does not both touch: what these
        leave free may be held by it. None where the function states all joints, which decide then, or no part has a
        mesh."""
        if self.kinematics.membership or self.lacks("contacts") is not None:
            return None
        number = {str(part): k for k, body in enumerate(self.kinematics.bodies) for part in body.parts}
        some = self.afloat.units if parts is None else {name: self.afloat.units[name] for name in parts}
        return next(self.afloat.between({unit: number[name] for name, unit in some.items()}), None)

    @cached_property
    def empty_rows(self) -> tuple[Row, ...]:
        """Bores of several bodies in a row, with nothing in them. Needs kinematics."""
        return empty_rows(replace(self.design, kinematics=self.kinematics))

    @cached_property
    def open_loops(self) -> tuple[OpenLoop, ...]:
        """Loops of descriptions that contact closes, and no stated joint."""
        if not self.assembly.descriptions or self.lacks("contacts") is not None:
            return ()
        return tuple(open_loops(self.kinematics, self.contacts))

    @cached_property
    def mass(self) -> MassReport:
        """Mass properties."""
        return self._result("mass", self.design.mass)

    @property
    def simulation_requested(self) -> bool:
        """Whether the manifest, or whoever ran the simulation, asked for one."""
        ran = self.design.simulation is not None and self.design.simulation.status != "not requested"
        return ran or self.assembly.simulation is not None or self.function.driven

    @cached_property
    def attempt(self) -> Simulation:
        """The simulation, whatever came of it: also where parts of it were held."""
        return self._result("attempt", self.design.simulation)

    @cached_property
    def simulation(self) -> Simulation:
        """The simulation of the whole, which may have been refused, or have stopped early."""
        return self._result("simulation", self.design.simulation)

    @cached_property
    def comparisons(self) -> tuple[Comparison, ...]:
        """Each intended joint beside what geometry gives, sorted by name."""
        return self._result("comparisons", self._every_comparison)

    @property
    def intended(self) -> tuple[Comparison, ...]:
        """The same, also where all joints come from the function itself."""
        return self._result("intended joints", self._every_comparison)

    @cached_property
    def _every_comparison(self) -> tuple[Comparison, ...]:
        joints = sorted(self.function.joints, key=lambda joint: joint.name)
        return tuple(compare_joints(self.assembly, self.design.contacts, self.kinematics, joints))

    @cached_property
    def dormant(self) -> frozenset[Requirement]:
        """Limits that are not asked about: there is no run, or nothing drives the joint whose effort they limit."""
        driven = {drive.joint for drive in self.function.drives if drive.kind not in PASSIVE}
        return frozenset(
            r
            for r in self.function.requirements
            if r.when_run
            and (not self.simulation_requested or (r.kind == "torque" and r.values.get("joint") not in driven))
        )

    @cached_property
    def answers(self) -> Mapping[Requirement, Answer]:
        """What became of each requirement that `[check]` asks about, in the order of the manifest."""
        requirements = [r for r in self.function.requirements if r.kind in self.judges and r not in self.dormant]
        return {requirement: self.judges[requirement.kind](self, requirement) for requirement in requirements}

    @cached_property
    def intended_pairs(self) -> frozenset[tuple[str, str]]:
        """Pairs of bodies (sorted names) that an intended joint joins; empty without kinematics."""
        if self.lacks("kinematics"):
            return frozenset()
        pairs = (bodies_of(self.assembly, self.kinematics, joint.between) for joint in self.function.joints)
        return frozenset((min(pair), max(pair)) for pair in pairs)

    @cached_property
    def intended_bodies(self) -> frozenset[str]:
        """Bodies that an intended joint names; empty without kinematics."""
        return frozenset(name for pair in self.intended_pairs for name in pair)

    @cached_property
    def unintended_joints(self) -> tuple[Joint, ...]:
        """Joints between two bodies that intended joints name, where no intended joint joins these two, and no stated
        coupling goes through them."""
        stated = self.function.couplings
        meshing = {name for c in stated for name in coupled_through(self.assembly, self.kinematics, c)}
        meshing |= set(imposed_couplings(self.assembly, self.kinematics, self.design.contacts).replaced)
        return tuple(
            j
            for j in self.kinematics.joints
            if tuple(sorted(j.bodies)) not in self.intended_pairs
            and self.intended_bodies.issuperset(j.bodies)
            and str(j.name) not in meshing
        )

    def body(self, name: str) -> str | None:
        """Name of the body that contains a part or group; None without kinematics."""
        if self.design.kinematics is None:
            return None
        return self.design.kinematics.body_of(self.assembly.parts_of(name)[0]).name

    def joint(self, name: str) -> Joint | None:
        """The derived joint of that name."""
        if self.lacks("kinematics"):
            return None
        return self.kinematics.named_joints.get(name)

    def place_of(self, joint: Joint | None) -> tuple[float, float, float] | None:
        """A point (m) at the joint: on its axis, else in the middle of its contact."""
        if joint is None:
            return None
        if joint.point is not None:
            return triple(joint.point)
        contacts = self.design.contacts
        points = [contacts.patches[k].points for k in joint.patches] if contacts is not None else []
        return triple(np.concatenate(points).mean(axis=0)) if any(map(len, points)) else None
