"""What acts on one freedom of the shaft of a joint: drives, springs, controllers, motors, stops."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np

from kinform.behaviour.ports import Component, Port
from kinform.behaviour.signals import Signal
from kinform.model.arrays import Array
from kinform.model.quantities import XYZ, Direction, JointValue, Metres, Ratio


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

    The integral rests while the output is at its limit and would be pushed further.
    """

    kp: Annotated[float, "V or N·m or N, a rad or m"]
    ki: Annotated[float, "as kp, a s"] = 0.0
    kd: Annotated[float, "as kp, times s"] = 0.0
    limit: Annotated[float, "V or N·m or N"] = math.inf


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

    L di/dt = V − R i − k g ω, effort = k g i; no friction, no inertia of its own: these have a body as its rotor. A
    supply that limits the current keeps |i| within the limit, and the integral of its controller rests there.
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
