"""What acts on one freedom of the shaft of a joint: drives, springs, controllers, motors, stops."""

from __future__ import annotations

import math
from dataclasses import field
from typing import Annotated, ClassVar

import numpy as np

from kinform.behaviour.ports import Component, Port
from kinform.behaviour.signals import Signal
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import XYZ, Direction, JointValue, Metres, Ratio


def rubbing_back(efficiency: float) -> float:
    """Efficiency of a gear driven the other way round, where its teeth rub alike both ways: 2 − 1/η, which is negative
    below one half: it locks itself. nan for efficiencies that are not positive."""
    return 2.0 - 1.0 / efficiency if efficiency > 0.0 else math.nan


@dataclass(frozen=True)
class OnShaft(Component):
    """Something on one freedom of the shaft of a joint: it gives no effort along the others. As many equations as the
    shaft has rates."""

    freedom: int = field(default=0, kw_only=True)
    """Which of the rates of the shaft it acts on, from 0."""
    rates: int = field(default=1, kw_only=True)
    """How many the shaft has."""

    @property
    def ports(self) -> tuple[Port, ...]:
        """The shaft, as wide as that of its joint, then what its kind has beside."""
        return (Port("shaft", self.rates), *self.BESIDE)

    BESIDE: ClassVar[tuple[Port, ...]] = ()
    """Ports of the kind beside the shaft."""


@dataclass(frozen=True, eq=False)
class MotionDrive(OnShaft):
    """The joint's value follows the signal, whatever effort that takes."""

    signal: Signal


@dataclass(frozen=True, eq=False)
class EffortDrive(OnShaft):
    """The effort follows the signal (N·m or N)."""

    signal: Signal


@dataclass(frozen=True)
class Spring(OnShaft):
    """effort = stiffness · (rest − value); N·m/rad and rad, or N/m and m."""

    stiffness: Annotated[float, "N·m/rad or N/m"]
    rest: JointValue


@dataclass(frozen=True)
class Damper(OnShaft):
    """effort = −damping · rate; N·m·s/rad or N·s/m."""

    damping: Annotated[float, "N·m·s/rad or N·s/m"]


@dataclass(frozen=True)
class EndStop(OnShaft):
    """The value stays between `lower` and `upper` (rad or m). An impact turns the rate round and leaves it this share
    (Newton): 0 is without rebound, 1 without loss."""

    lower: JointValue = -math.inf
    upper: JointValue = math.inf
    restitution: Ratio = 0.0


def _round() -> Array:
    """No direction: what is loaded is round."""
    return np.zeros(3)


@dataclass(frozen=True, eq=False)
class Friction(OnShaft):
    """Coulomb friction: at rest any effort up to a limit, in motion the effort `kinetic · grip + effort` against it.

    The limit at rest is `static · grip + static_effort`. The grip follows from the wrench in the joint; with its force
    f and its torque τ about the joint's point, along the axis and across it (`mechanism.rubbing`):
    grip = radial · (|F₁| + |F₂|) + |axial · f∥ + torsion · τ∥|, where F₁ and F₂ are the forces across the axis, at
    `lower` and `upper` along it, that make f⊥ and τ⊥. Where both are equal τ⊥ does not count.
    """

    kinetic: Ratio
    """Coefficient in motion."""
    static: Ratio
    """Coefficient at rest."""
    effort: Annotated[float, "N·m or N"] = 0.0
    """What there is without load, in motion."""
    static_effort: Annotated[float, "N·m or N"] = 0.0
    """The same at rest."""
    radial: Annotated[float, "m or 1"] = 0.0
    """Arm of the friction of a journal; 1 for slides."""
    lower: Metres = 0.0
    """From the joint's point along its axis to one end of what carries loads across it."""
    upper: Metres = 0.0
    axial: Annotated[float, "m or 1"] = 0.0
    """Arm of the friction of a thrust ring; of a thread with `torsion`."""
    torsion: Annotated[float, "1 or 1/m"] = 0.0
    faces_u: Direction = field(default_factory=_round)
    """(3,) with `faces_v`, of a guide between flat faces: |F| is |F·u| + |F·v|. Zero where it is round."""
    faces_v: Direction = field(default_factory=_round)
    offset: Annotated[Array, "m", XYZ] = field(default_factory=_round)
    """(3,) from the joint's point, at the zero pose, to the point that all of this is about."""
    riding: bool = False
    """Whether the ends go along with the second body as it slides."""
    least: bool = False
    """Whether, where redundant constraints share loads, the least reactions that balance are taken for what presses."""


@dataclass(frozen=True)
class Controller:
    """kp · e + ki · ∫e + kd · ė, e the target less the value, kept within ±limit.

    With a limit of speed it is a loop of speed in one of position: kd · m + ki · ∫m, m what is missing of the speed
    kp · e + rate of the target, kept within ±speed_limit. The integral rests while the output is at its limit and would
    be pushed further.
    """

    kp: Annotated[float, "V or N·m or N, a rad or m; 1/s"]
    ki: Annotated[float, "as kp, a s"] = 0.0
    kd: Annotated[float, "as kp, times s"] = 0.0
    limit: Annotated[float, "V or N·m or N"] = math.inf
    speed_limit: Annotated[float, "rad/s or m/s"] = math.inf
    """The greatest speed that is asked for; inf: position is controlled without a loop of speed."""

    @property
    def cascade(self) -> bool:
        """Whether it has a loop of speed."""
        return math.isfinite(self.speed_limit)

    @property
    def without_speed_limit(self) -> Controller:
        """What it is where its speed is not limited, but for the start of its integral."""
        if not self.cascade:
            return self
        return Controller(self.kd * self.kp + self.ki, self.ki * self.kp, self.kd, self.limit)


@dataclass(frozen=True, eq=False)
class Servo(OnShaft):
    """The effort (N·m or N) is the controller's output for the target."""

    target: Signal
    controller: Controller


@dataclass(frozen=True)
class OnShaftAndTerminals(OnShaft):
    """Something between a shaft and electric terminals; one equation more."""

    BESIDE = (Port("terminals", 1),)


@dataclass(frozen=True)
class DcMotor(OnShaftAndTerminals):
    """Motor with a gear: electric terminals (voltage across, current through) and a shaft. Two equations.

    L di/dt = V − R i − k g ω. The rotor, of inertia J and with friction f, passes E = k g i − g f sign(ω) − g² J dω/dt
    on to its gear, which gives the shaft η E where E drives, and E / η′ where the shaft does. The rotor's weight, and
    what it does as a top, are left to the body that bears it. A supply that limits the current keeps |i| within the
    limit, and the integral of its controller rests there.
    """

    resistance: Annotated[float, "Ω"]
    """Ω."""
    inductance: Annotated[float, "H"]
    """H; 0: the current follows at once."""
    constant: Annotated[float, "N·m/A"]
    """k: N·m/A, which equals V·s/rad."""
    gear: Annotated[float, "1 or rad/m"]
    """g: motor turns a turn of the joint, or radians of the motor a metre."""
    current_limit: Annotated[float, "A"] = math.inf
    """The greatest current that the supply gives, either way."""
    rotor_inertia: Annotated[float, "kg·m²"] = 0.0
    """About the motor's axis."""
    rotor_friction: Annotated[float, "N·m"] = 0.0
    """Of the motor without load."""
    efficiency: Ratio = 1.0
    """η of its gear: share of the rotor's power that comes out at the shaft."""
    efficiency_back: Ratio = 1.0
    """η′: of the shaft's power that comes out at the rotor; zero or less: the shaft cannot drive it."""

    @property
    def armature(self) -> float:
        """Inertia of the rotor as the shaft feels it: kg·m² or kg."""
        return self.rotor_inertia * self.gear**2

    @property
    def lossy(self) -> bool:
        """Whether its gear loses power."""
        return self.efficiency != 1.0 or self.efficiency_back != 1.0


@dataclass(frozen=True, eq=False)
class VoltageSource(Component):
    """The voltage across its terminals follows the signal (V); one equation."""

    PORTS = (Port("terminals", 1),)

    signal: Signal


@dataclass(frozen=True, eq=False)
class VoltageController(OnShaftAndTerminals):
    """A voltage across its terminals by a controller that reads the shaft without loading it. Two equations."""

    target: Signal
    controller: Controller


Actor = MotionDrive | EffortDrive | Spring | Damper | Friction | EndStop | Servo | DcMotor
"""What gives a shaft effort, or holds it."""
