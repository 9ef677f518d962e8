"""One design as the judges of requirements see it: results of its stages, and the geometry that answers them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from kinform.consistency.comparisons.plausibility import extent
from kinform.consistency.context import Context
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.function.joint_names import stated_as
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.findings import Witness
from kinform.model.function import PASSIVE, Function
from kinform.model.kinematics import Body, Joint, Kinematics
from kinform.model.simulation import Simulation
from kinform.requirements.evidence import (
    Amount,
    Coverage,
    Deviation,
    Driving,
    FitClearance,
    Resolved,
    Stage,
    Swept,
    WayOut,
)

if TYPE_CHECKING:
    from kinform.function.clearances import Apart
    from kinform.function.configurations import Chain
    from kinform.function.static_load import MechanismAtRest

# geometry is imported where a requirement asks for it: most designs state none


@dataclass(frozen=True, eq=False)
class CarriedBody:
    """A body that moves relative to the ground, with the chain between the two."""

    body: str
    chain: Chain

    def screws(self) -> Mapping[str, Array] | None:
        """The screws from the root to the body, with their bounds."""
        return self.chain.screws(self.body)

    def cover(self, carried: Array, targets: Array, *, directions: bool, near: float) -> Coverage:
        """How near a point (3,) m, or a direction, of the body comes to targets (k, 3)."""
        from kinform.function.coverage import cover

        return cover(self.chain, self.body, carried, targets, directions=directions, near=near)


@dataclass(frozen=True, eq=False)
class TwoGroups:
    """Parts of two bodies, and the distance between them."""

    context: Context
    bodies: tuple[str, str]
    apart: Apart

    @property
    def comparable(self) -> bool:
        """False where all their surfaces mate."""
        return any(pair.tests for pair in self.apart.pairs)

    @property
    def parts(self) -> Sequence[tuple[str, str]]:
        """All pairs of parts of the two, sorted names in each."""
        names = ((str(pair.first.name), str(pair.second.name)) for pair in self.apart.pairs)
        return [(min(pair), max(pair)) for pair in names]

    @property
    def mating(self) -> Sequence[tuple[str, str]]:
        """Pairs of parts whose mating surfaces do not count against each other, sorted."""
        return self.apart.left_out

    @cached_property
    def _chain(self) -> Chain | str:
        from kinform.function.configurations import chain_between

        return chain_between(self.context.assembly, self.context.kinematics, *self.bodies, "stated")

    def chain(self) -> Chain | str:
        """The joints between the two, or why there are none."""
        return self._chain

    def along(self, first: Array, second: Array, required: float) -> Swept:
        """The least distance along displacements (T, 4, 4) of both from the pose of the meshes."""
        from kinform.function.sweeps import along

        return along(self.apart, first, second, required)

    def over(self, low: Array, high: Array, required: float) -> Swept:
        """The least distance over all values of the chain's coordinates between two bounds (n,)."""
        from kinform.function.sweeps import over

        chain = self._chain
        assert not isinstance(chain, str)
        return over(self.apart, chain, *self.bodies, low, high, required)


@dataclass(frozen=True, eq=False)
class DesignEvidence:
    """One design under check."""

    context: Context

    @property
    def assembly(self) -> Assembly:
        """The assembly."""
        return self.context.assembly

    @property
    def function(self) -> Function:
        """The stated function."""
        return self.context.function

    @property
    def units(self) -> str:
        """The unit in which lengths are shown."""
        return self.context.units

    @property
    def contacts(self) -> Contacts:
        """Contacts."""
        return self.context.contacts

    @property
    def kinematics(self) -> Kinematics:
        """Joints and mobility."""
        return self.context.kinematics

    @property
    def simulation(self) -> Simulation:
        """The simulation."""
        return self.context.simulation

    @property
    def size(self) -> float | None:
        """Diagonal (m) of the box around everything; None where nothing has a place."""
        return extent(self.context.assembly)

    def lacking(self, stage: Stage) -> str | None:
        """Why the result of a stage is not there; None where it is."""
        outcome = self.context.lacks(stage)
        return None if outcome is None else outcome.reason

    def body(self, name: str) -> str | None:
        """Name of the body that contains a part or group; None without kinematics."""
        return self.context.body(name)

    def resolve(self, joint: str) -> Resolved:
        """What the name of a joint stands for."""
        return resolve_joint(self.assembly, self.kinematics, joint)

    def stated_as(self, joint: str) -> tuple[str, int]:
        """The designer's name of a derived joint, and the sign of the designer's values."""
        return stated_as(self.assembly, self.kinematics, joint)

    def amount(self, parts: Sequence[str]) -> Amount | str:
        """Mass, centre and inertia of parts together."""
        from kinform.function.amounts import amount_of

        return amount_of(self.assembly, self.context.mass, parts)

    def fits(self, first: Sequence[str], second: Sequence[str]) -> Sequence[FitClearance]:
        """All fits between parts of two groups."""
        from kinform.function.fits import clearances

        return clearances(self.contacts, first, second)

    def deviation(self, body: str, point: Array, path: Array) -> Deviation:
        """How far a point (3,) m of a simulated body strays from rows of a path."""
        from kinform.function.paths import deviation

        run = self.simulation
        b = run.body_names.index(body)
        return deviation(run.time, run.p_WB[:, b], run.q_WB[:, b], point, path)

    def carrier(self, ground: str, body: str) -> CarriedBody | str:
        """A body that moves relative to the ground."""
        from kinform.function.configurations import chain_between

        chain = chain_between(self.assembly, self.kinematics, ground, body)
        return chain if isinstance(chain, str) else CarriedBody(body, chain)

    def groups(self, first: Body, parts: Sequence[str], second: Body, others: Sequence[str]) -> TwoGroups | None:
        """Parts of two bodies; None where one group has no mesh."""
        from kinform.function.clearances import apart

        found = apart(self.assembly, self.contacts, self.context.design.surfaces, parts, others)
        return None if found is None else TwoGroups(self.context, (first.name, second.name), found)

    def way_out(self, parts: Sequence[str], direction: Array, after: Array | None = None) -> WayOut:
        """How far parts go together along a unit direction (3,) while all others rest."""
        from kinform.collisions.ways_out import displaced, way_out

        shapes = self.context.shapes
        return way_out(shapes if after is None else displaced(shapes, parts, after), parts, direction)

    def in_each_other(self, parts: Sequence[str], displacements: Iterable[Array]) -> Witness | None:
        """The first pose in which two parts are in each other."""
        from kinform.consistency.questions.proofs import in_each_other

        return in_each_other(self.context, parts, displacements)

    def face_normals(self, parts: Sequence[str]) -> Array:
        """(k, 3) unit normals, up to sign, of the largest flat faces of parts."""
        from kinform.collisions.ways_out import face_normals

        return face_normals(self.context.shapes, parts)

    def mechanism(self) -> MechanismAtRest | str:
        """Everything that joints connect with the ground."""
        from kinform.function.static_load import mechanism_at_rest

        return mechanism_at_rest(self.assembly, self.kinematics, self.context.mass)

    def carried(self, joint: Joint, output: int) -> Mapping[str, Array] | None:
        """What a joint alone carries about an output time."""
        from kinform.consistency.questions.carried import carried

        return carried(self.context, joint, output)

    def driving(self, joint: Joint, pose: Mapping[str, float]) -> Driving | str:
        """What the joint's drive must give, with friction."""
        from kinform.function.static_load import pose_values
        from kinform.statics.driving import driving

        values = pose_values(self.assembly, self.kinematics, pose)
        if isinstance(values, str):
            return values
        found = (self.resolve(drive.joint).joint for drive in self.function.drives if drive.kind not in PASSIVE)
        drives = [str(one.name) for one in found if one is not None]
        return driving(self.context.design, joint.name, values, drives)
