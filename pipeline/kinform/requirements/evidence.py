"""What a judge may ask about a design, and what it is told.

Judges stand below the geometry that answers them, so they know it by these types only. `consistency.evidence` gives
them: from the results of stages, `function` and `statics`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from typing import Literal, Protocol

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.findings import Witness
from kinform.model.function import Function, IntendedJoint
from kinform.model.kinematics import Body, Joint, Kinematics
from kinform.model.simulation import Simulation

Stage = Literal["contacts", "kinematics", "mass", "simulation", "motion", "forces"]
"""Results that a judge may need: of a stage, or what a simulation shows."""


@dataclass(frozen=True, eq=False)
class Amount:
    """Several parts together, world axes, at the pose of the meshes."""

    mass: float
    """kg."""
    centre: Array
    """(3,) m."""
    inertia: Array
    """(3, 3) kg·m² about the centre."""
    bound: float
    """Relative bound of the mass's error."""
    parts: tuple[str, ...] = ()
    """What it is the sum of: parts, and groups with a stated mass."""
    numbers: Mapping[str, Array] = field(default_factory=dict)
    """Of each of them what a witness is computed from: density (kg/m³; 0 where the mass is stated), mass, centre and
    inertia in the world."""

    def about(self, axis: Array, point: Array | None) -> float:
        """Moment of inertia (kg·m²) about the unit axis through the point (m), or through the centre."""
        about_centre = float(axis @ self.inertia @ axis)
        if point is None:
            return about_centre
        return about_centre + self.mass * self.distance(axis, point) ** 2

    def distance(self, axis: Array, point: Array) -> float:
        """Distance (m) of the centre of mass from a line."""
        return float(np.linalg.norm(cross(axis, self.centre - point)))


FitKind = Literal["radial", "both sides", "gap"]


@dataclass(frozen=True, eq=False)
class FitClearance:
    """One fit: of round surfaces (radial), between planes (both sides), or of planes on one side (gap)."""

    kind: FitKind
    value: float
    """m; negative is press."""
    error: float
    """m: of the fitted surfaces, and of their chords where facets alone speak."""
    place: Array
    """(3,) m."""
    parts: tuple[str, ...] = ()
    """Of each pair of surfaces the two parts."""
    numbers: Mapping[str, Array] = field(default_factory=dict)
    """What a witness is computed from: of round surfaces axis (zero of balls), point and radii (2,); of planes axes
    (k, 3) and the heights (k, 2) of both sides along them."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """The greatest deviations from a path, with their times; angle None where the path has no orientation."""

    distance: float
    """m."""
    time: float
    place: Array
    """(3,) m: where the point is then."""
    angle: float | None
    """rad."""
    angle_time: float
    error: float
    """m: bound of what interpolation between output times adds."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """Of each target the least distance that was found (m, or rad for directions), and what came there."""

    distance: Array
    """(k,)."""
    nearest: Array
    """(k, 3) the point (m, world) or the direction that came nearest."""
    samples: int


@dataclass(frozen=True, eq=False)
class Nearest:
    """The least distance in one pose: between which parts, and where."""

    distance: float
    """m; 0 where they collide."""
    parts: tuple[str, str]
    place: Array
    """(3,) m, in the world at the pose of the meshes of the first group: about where they are nearest."""


@dataclass(frozen=True, eq=False)
class Swept:
    """What was found along a motion. `worst` falls short when its distance is less than required."""

    worst: Nearest
    """The nearest of the poses that were measured (a bound from below where it is far)."""
    where: float
    """Share of the way, in poses of the motion: 3.5 is half way between the fourth and the fifth."""
    values: tuple[float, ...]
    """Coordinates of the chain (rad or m, kinform's sign), over ranges."""
    complete: bool
    """False: the budget ended before everything was certified."""
    floor: float
    """m: between measured poses the distance may be so much less than required."""
    poses: int
    relative: Array | None = None
    """(4, 4) displacement of the second group relative to the first at a pose that falls short."""
    beyond: tuple[Array, ...] = ()
    """The same of poses that the motion comes to after it."""


@dataclass(frozen=True, eq=False)
class WayOut:
    """What becomes of parts that move along a straight line, all others at rest."""

    status: Literal["free", "stopped", "unknown"]
    travel: float = 0.0
    """m up to where they are stopped."""
    left: float = 0.0
    """m at which they have left so much of the contact that keeps them on the line that it no longer does."""
    by: tuple[str, ...] = ()
    """What stops them."""
    reason: str = ""
    """Why it is not known."""


class Coordinate(Protocol):
    """One coordinate of a chain. Values in rad, or m, of the joint as kinform signs it."""

    @property
    def joint(self) -> str: ...
    @property
    def turns(self) -> bool: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...


class Chain(Protocol):
    """The joints on all paths between two bodies."""

    @property
    def coordinates(self) -> Sequence[Coordinate]: ...
    @property
    def looped(self) -> bool:
        """Whether there are loops to close, or ratios to keep."""

    @property
    def freedoms(self) -> int:
        """Freedoms of first order in the pose of the meshes."""

    @property
    def lower(self) -> Array:
        """(n,) least coordinates."""

    @property
    def upper(self) -> Array:
        """(n,) greatest coordinates."""

    @property
    def unknown(self) -> tuple[str, ...]:
        """Joints of which no range is known."""

    def undetermined(self, body: str) -> tuple[str, ...]:
        """Joints without a known range that can move the body while all joints with one stand still."""


class Carrier(Protocol):
    """A body that moves relative to the ground, with the chain between the two."""

    @property
    def body(self) -> str: ...
    @property
    def chain(self) -> Chain: ...

    def screws(self) -> Mapping[str, Array] | None:
        """Unit screws (n, 6) (ω; v at the world's origin) from the root to the body, in the order in which they act,
        with the least and the greatest value of each (rad or m); None where loops close."""

    def cover(self, carried: Array, targets: Array, *, directions: bool, near: float) -> Coverage:
        """How near a point (3,) m, or a direction, of the body at the pose of the meshes comes to targets (k, 3)."""


class PairOfGroups(Protocol):
    """Two rigid groups of parts, and the distance between them without the surfaces by which they mate."""

    @property
    def comparable(self) -> bool:
        """False where all their surfaces mate."""

    @property
    def parts(self) -> Sequence[tuple[str, str]]:
        """All pairs of parts of the two, sorted names in each."""

    @property
    def mating(self) -> Sequence[tuple[str, str]]:
        """Pairs of parts whose mating surfaces do not count against each other, sorted."""

    def chain(self) -> Chain | str:
        """The joints between the two, with stated ranges before those that were found; or why there are none."""

    def along(self, first: Array, second: Array, required: float) -> Swept:
        """The least distance along displacements (T, 4, 4) of both from the pose of the meshes."""

    def over(self, low: Array, high: Array, required: float) -> Swept:
        """The least distance over all values of the chain's coordinates between two bounds (n,)."""


class Mechanism(Protocol):
    """Everything that joints connect with the ground."""

    def effort(self, joint: Joint, pose: Mapping[str, float]) -> float | str:
        """N·m or N that holds the joint without friction while other joints have the values (rad or m) of the pose,
        by the designer's names; or why it is not determined."""

    def work(self, joint: Joint, pose: Mapping[str, float]) -> Mapping[str, Array] | None:
        """Weights, loads and springs with the motion of each as the joint moves by one in that pose; None where that is
        not known."""


class Driving(Protocol):
    """Efforts (N·m or N) along a joint in one pose, with friction, in kinform's sense."""

    @property
    def without(self) -> float:
        """That holds it without friction."""

    @property
    def locked(self) -> bool:
        """Whether it stays without any drive."""

    @property
    def least(self) -> float:
        """That a drive must give at least to hold it."""

    @property
    def efficiency(self) -> float | None:
        """Share of the work of the drive that comes out as it moves against the load; None without a load."""


class Resolved(Protocol):
    """What the name of a joint stands for."""

    @property
    def joint(self) -> Joint | None: ...
    @property
    def intended(self) -> IntendedJoint | None: ...
    @property
    def sign(self) -> int:
        """Designer's value = sign · kinform's joint value."""

    @property
    def reason(self) -> str:
        """Why there is no such joint."""


class Evidence(Protocol):
    """One design, as judges see it. Results of a stage may be read where it is not lacking only."""

    @property
    def assembly(self) -> Assembly: ...
    @property
    def function(self) -> Function: ...
    @property
    def units(self) -> str:
        """The unit in which lengths are shown."""

    @property
    def contacts(self) -> Contacts: ...
    @property
    def kinematics(self) -> Kinematics: ...
    @property
    def simulation(self) -> Simulation: ...
    @property
    def size(self) -> float | None:
        """Diagonal (m) of the box around everything; None where nothing has a place."""

    def lacking(self, stage: Stage) -> str | None:
        """Why the result of a stage is not there; None where it is."""

    def body(self, name: str) -> str | None:
        """Name of the body that contains a part or group; None without kinematics."""

    def resolve(self, joint: str) -> Resolved:
        """What the name of a joint stands for. Needs kinematics."""

    def stated_as(self, joint: str) -> tuple[str, int]:
        """The name that the designer gave a derived joint, else its own, and the sign of the designer's values against
        kinform's. Needs kinematics."""

    def amount(self, parts: Sequence[str]) -> Amount | str:
        """Mass, centre and inertia of parts together, or why they are not known. Needs masses."""

    def fits(self, first: Sequence[str], second: Sequence[str]) -> Sequence[FitClearance]:
        """All fits between parts of two groups. Needs contacts."""

    def deviation(self, body: str, point: Array, path: Array) -> Deviation:
        """How far a point (3,) m of a simulated body strays from rows of a path. Needs a simulation."""

    def carrier(self, ground: str, body: str) -> Carrier | str:
        """A body that moves relative to the ground, or why no chain leads to it. Needs kinematics."""

    def groups(self, first: Body, parts: Sequence[str], second: Body, others: Sequence[str]) -> PairOfGroups | None:
        """Parts of two bodies; None where one group has no mesh. Needs contacts and kinematics."""

    def way_out(self, parts: Sequence[str], direction: Array, after: Array | None = None) -> WayOut:
        """How far parts go together along a unit direction (3,) while all others rest; `after`: displacement (3,) m by
        which they have left their contacts before. Needs contacts and kinematics."""

    def in_each_other(self, parts: Sequence[str], displacements: Iterable[Array]) -> Witness | None:
        """The first pose in which two parts are in each other, the second displaced (4, 4) relative to the first."""

    def face_normals(self, parts: Sequence[str]) -> Array:
        """(k, 3) unit normals, up to sign, of the largest flat faces of parts. Needs contacts and kinematics."""

    def mechanism(self) -> Mechanism | str:
        """Everything that joints connect with the ground, or why it has no poses. Needs kinematics and masses."""

    def carried(self, joint: Joint, output: int) -> Mapping[str, Array] | None:
        """What a joint alone carries about an output time: times, masses, inertias, places and turns of the bodies that
        hang on it, gravity, and its axis; None where loops, loads, springs or friction act too. Needs a simulation."""

    def driving(self, joint: Joint, pose: Mapping[str, float]) -> Driving | str:
        """What the joint's drive must give, with friction, where joints have the values (rad or m) of the pose by the
        designer's names; or why that is not determined. Needs kinematics and masses."""
