"""A simulated run: poses, joint values, efforts, energy over time."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Literal

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.collisions import Collision, JointRange
from kinform.model.quantities import Reason, columns
from kinform.model.sensors import Reading

Effort = Annotated[float, "N·m or N"]

DriveKind = Literal[
    "motion", "effort", "spring", "damper", "friction", "gear_loss", "rotor", "servo", "dc_motor", "stop"
]
"""What acts on the shaft of a joint. rotor: the friction of a motor's own rotor."""
SimulationStatus = Literal["done", "partial", "not requested", "refused", "stopped"]
"""partial: joints that are not understood were held, see `failures`; refused: it cannot be simulated, see `reason`;
stopped: it ended early."""
SimulationLevel = Literal["", "functional", "kinematic", "dynamic"]
""""" where nothing ran."""


@dataclass(frozen=True)
class DriveUse:
    """What one drive did in a dynamic run: for a prescribed motion what it must be able to do."""

    joint: str
    kind: DriveKind
    peak: Effort
    """Greatest effort at an output time, N·m or N."""
    rms: Effort
    """Root of the mean square of the effort over time."""
    peak_power: Annotated[float, "W"]
    """Greatest power that it put in, W; negative when it only took power out."""
    work: Annotated[float, "J"]
    """J put in over the run, springs included."""
    freedom: int = 0
    """Which of the joint's rates it acts on."""
    slides: bool = False
    """Whether that is a slide: efforts in N."""
    peak_speed: Annotated[float, "rad/s or m/s"] = 0.0
    """Greatest speed, without sign."""
    rms_power: Annotated[float, "W"] = 0.0
    """Root of the mean square of the power over time."""


@dataclass(frozen=True)
class Damping:
    """Vibrations of springs that the solver damped, as following them would have taken more steps than it may take."""

    since: Annotated[float, "s"]
    """s."""
    frequency: Annotated[float, "Hz"]
    """Hz, of the fastest."""
    energy: Annotated[float, "J"]
    """J that went with them."""


@dataclass(frozen=True, eq=False)
class Simulation:
    """T output times, B bodies, n joint coordinates (order: joint_names with joint_offset)."""

    status: SimulationStatus
    reason: str
    level: SimulationLevel
    time: Annotated[Array, "s"]
    """(T,) s."""
    body_names: tuple[str, ...]
    p_WB: Annotated[Array, "m"]
    """(T, B, 3) m."""
    q_WB: Annotated[Array, "1"]
    """(T, B, 4) wxyz; the body frame is the world frame at the pose of the meshes."""
    joint_names: tuple[str, ...]
    joint_types: tuple[str, ...]
    joint_offset: Ints
    """(joints + 1,) first coordinate of each joint."""
    joint_position: Annotated[Array, "rad or m"]
    """(T, n) rad or m; a joint value is of the second body about the joint's axis."""
    joint_velocity: Annotated[Array, "rad/s or m/s"]
    joint_effort: Annotated[Array, "N·m or N"]
    """(T, n) N·m or N that the drive gives; nan where unknown."""
    energy: Annotated[Array, "J"]
    """(T, 3): kinetic, potential, work put in by drives and loads so far (J); nan below dynamic."""
    residual: Annotated[Array, "m or rad"]
    """(T,) largest constraint residual (m or rad)."""
    rank: Ints
    """(T,) rank of the loop closures."""
    assumptions: tuple[str, ...]
    """Every value that was assumed, in sentences."""
    failures: tuple[Reason, ...] = ()
    """(subject, what cannot be simulated and why)."""
    not_dynamic: tuple[Reason, ...] = ()
    """(subject, why) of what keeps it below the dynamic level, where no level was asked for."""
    joint_acceleration: Annotated[Array, "rad/s² or m/s²"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, n) rad/s² or m/s²; nan where unknown."""
    F_A: Annotated[Array, "N·m, N"] = field(default_factory=lambda: np.zeros((0, 0, 6)))
    """(T, joints, 6) wrench (τ; f) of each joint on its first body, about the joint's point as that body
    carries it, in world axes; no times below dynamic."""
    F_B: Annotated[Array, "N·m, N"] = field(default_factory=lambda: np.zeros((0, 0, 6)))
    """The same on its second body."""
    undetermined: Flags = field(default_factory=lambda: np.zeros((0, 6), dtype=np.bool_))
    """(joints, 6) components that redundancy leaves open: F_A and F_B hold the smallest that balance."""
    gear_names: tuple[str, ...] = ()
    """G gears: the joints whose teeth they are, or what they are called."""
    gear_effort: Annotated[Array, "N·m or N"] = field(default_factory=lambda: np.zeros((0, 0, 2)))
    """(T, G, 2) N·m or N that each gives the shafts of its two joints; no times below dynamic."""
    gear_force: Annotated[Array, "N"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, G) N between the teeth, at half of their width and without friction; nan where not known."""
    friction_joints: tuple[str, ...] = ()
    """M frictions: the joints that they are in."""
    friction_effort: Annotated[Array, "N·m or N"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, M) N·m or N that each gives its shaft; of joints that stick by one motion one stands for all."""
    friction_limit: Annotated[Array, "N·m or N"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, M) what each would take at most at rest, under the load then."""
    friction_sticks: Flags = field(default_factory=lambda: np.zeros((0, 0), dtype=np.bool_))
    """(T, M) whether it sticks."""
    drives: tuple[DriveUse, ...] = ()
    """What acts on the shafts of joints, in order."""
    drive_effort: Annotated[Array, "N·m or N"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, drives) effort of each drive on its freedom; no times below dynamic."""
    drive_speed: Annotated[Array, "rad/s or m/s"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, drives) rate of the freedom that it acts on."""
    readings: tuple[Reading, ...] = ()
    """R columns of what sensors read, in the order of the sensors."""
    sensed: Annotated[Array, "of its reading"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, R); nan where unknown."""
    balance: Annotated[Array, "1"] = field(default_factory=lambda: np.zeros(0))
    """(T,) greatest error of the balance of a body or a node over the greatest wrench then."""
    balance_bodies: Annotated[Array, "1"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, B) of that the error at the node of each body's frame; no times below dynamic."""
    balance_shafts: Annotated[Array, "1"] = field(default_factory=lambda: np.zeros((0, 0)))
    """(T, n) the error at the node on the shaft of each joint coordinate."""
    dampings: tuple[Damping, ...] = ()
    """What the solver damped, in the order of time; its energy is in the work of `energy`."""
    ranges: tuple[JointRange, ...] | None = None
    """How far joints go until something stops them; None: not computed."""
    collisions: tuple[Collision, ...] | None = None
    """First contacts of parts outside of their mates, in the order of time; None: not looked for."""
    uncollided: tuple[Annotated[tuple[str, str, str], columns("part_a", "part_b", "reason")], ...] = ()
    """(part, part, why it is not known whether they collide)."""

    @property
    def partial(self) -> bool:
        """Whether it ran, to its end or not, with joints held that are not understood: it proves nothing."""
        return bool(self.failures) and self.status in ("partial", "stopped")

    @property
    def damped(self) -> float:
        """J that went with vibrations which the solver damped."""
        return sum(one.energy for one in self.dampings)

    @property
    def damped_share(self) -> float:
        """Of the energy exchanged in the run."""
        size = abs(self.damped)
        return size / max(size, float(np.ptp(self.energy, axis=0).max())) if size > 0.0 else 0.0

    def __repr__(self) -> str:
        level = f" {self.level}" if self.level else ""
        return f"Simulation:{level} {self.status}, {len(self.time)} samples"
