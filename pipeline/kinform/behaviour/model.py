"""Port models by hand: components are named, ports are joined by the names of what they meet.

    model = Model()
    model.ground("base")
    model.body("bob", 1.0, (0, 0, -1), inertia=(0, 0, 0))
    model.joint("hinge", "base", "bob", "revolute", axis=(0, 1, 0), point=(0, 0, 0))
    model.spring("return", "hinge", stiffness=2.0)
    system = model.system()

World axes at the pose in which the model is written, SI and radians; a joint's value is zero in that pose.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from string import ascii_lowercase

import numpy as np
from numpy.typing import ArrayLike

from kinform.behaviour import shafts
from kinform.behaviour.components import (
    Bushing,
    GasSpring,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    RigidBody,
    SpringDamper,
    System,
)
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.nested import placed
from kinform.behaviour.ports import Component, Node
from kinform.behaviour.rubbing import Rubs
from kinform.behaviour.signals import STEADY, Signal
from kinform.foundation.graphs.graph import UnionFind
from kinform.model.arrays import Array

Where = str | tuple[str, str]
"""A component by name, or one of its ports: (component, port)."""


class Model:
    """A port model while it is written; `system()` is what it has become. Every method that adds raises ValueError
    for a name that is taken, or a component or port that is not there."""

    def __init__(self) -> None:
        self.components: dict[str, Component] = {}
        self._joined: list[tuple[tuple[str, str], tuple[str, str]]] = []
        self._exposed: list[tuple[str, tuple[str, str]]] = []

    def add(self, component: Component, **joined: Where) -> None:
        """Add a component; `joined`: what each of its ports meets. A port that is not named meets nothing (yet)."""
        if component.name in self.components:
            raise ValueError(f'there is a component "{component.name}" already')
        sizes = {port.name: port.size for port in component.ports}
        for port in joined:
            if port not in sizes:
                raise ValueError(f'"{component.name}" has no port "{port}": it has {", ".join(sizes) or "none"}')
        met = [((component.name, port), self._port(where, port, sizes[port])) for port, where in joined.items()]
        self.components[component.name] = component
        self._joined += met

    def _port(self, where: Where, port: str, size: int) -> tuple[str, str]:
        """The port that is meant: the one named, the one of the same name, or the only one that fits."""
        name, wanted = (where, None) if isinstance(where, str) else where
        if name not in self.components:
            raise ValueError(f'there is no component "{name}": there are {", ".join(self.components) or "none"}')
        fits = [p.name for p in self.components[name].ports if p.size == size]
        if wanted is not None:
            if wanted not in fits:
                raise ValueError(f'"{name}" has no port "{wanted}" of size {size}: it has {", ".join(fits) or "none"}')
            return name, wanted
        if port in fits and not isinstance(self.components[name], JointComponent):
            return name, port
        if len(fits) != 1:
            raise ValueError(
                f'which port of "{name}" is meant for "{port}"? It has {", ".join(fits) or "none"} so wide'
            )
        return name, fits[0]

    def join(self, first: tuple[str, str], second: Where) -> None:
        """Join a port of a component with one of another: they are in one node then."""
        name, port = first
        size = {p.name: p.size for c in (self.components.get(name),) if c is not None for p in c.ports}.get(port)
        if size is None:
            raise ValueError(f'there is no port "{port}" of a component "{name}"')
        self._joined.append((first, self._port(second, port, size)))

    def expose(self, port: str, component: str, inner: str) -> None:
        """Make a port of the system out of the node in which the port `inner` of a component is."""
        if (component, inner) not in {(c.name, p.name) for c in self.components.values() for p in c.ports}:
            raise ValueError(f'there is no port "{inner}" of a component "{component}" to expose as "{port}"')
        self._exposed.append((port, (component, inner)))

    def system(self, name: str = "", subject: str = "") -> System:
        """The components, and the nodes that their joined ports make."""
        ports = [(c.name, port.name) for c in self.components.values() for port in c.ports]
        sizes = {(c.name, port.name): port.size for c in self.components.values() for port in c.ports}
        number = {port: k for k, port in enumerate(ports)}
        merged = UnionFind(len(ports))
        for first, second in self._joined:
            merged.union(number[first], number[second])
        groups: dict[int, list[tuple[str, str]]] = defaultdict(list)
        for port in ports:
            groups[merged.find(number[port])].append(port)
        nodes = tuple(Node(tuple(group), sizes[group[0]]) for group in groups.values())
        return System(tuple(self.components.values()), nodes, name, subject, tuple(self._exposed))

    def include(self, name: str, system: System, X: ArrayLike | None = None, **joined: Where) -> None:
        """Put a system in, called `name`, moved by the pose X (4, 4); its ports meet what is named."""
        moved = system if X is None else placed(system, np.asarray(X, dtype=np.float64))
        self.add(System(moved.components, moved.nodes, name, name, moved.exposed), **joined)

    def ground(self, name: str = "ground") -> None:
        """What is at rest."""
        self.add(Ground(name, name))

    def body(self, name: str, mass: float | None, centre_of_mass: ArrayLike, inertia: ArrayLike) -> None:
        """A rigid body: kg, m, kg·m² about the centre of mass ((3, 3), or the diagonal)."""
        tensor = np.asarray(inertia, dtype=np.float64)
        tensor = np.diag(tensor) if tensor.ndim == 1 else tensor
        self.add(RigidBody(name, name, mass, np.asarray(centre_of_mass, dtype=np.float64), tensor))

    def joint(
        self,
        name: str,
        a: Where,
        b: Where,
        kind: str = "revolute",
        *,
        axis: ArrayLike | None = None,
        point: ArrayLike | None = None,
        axis2: ArrayLike | None = None,
        pitch: float | None = None,
    ) -> None:
        """A joint between two bodies, of the kinds in `kinform.behaviour.joints.KINDS`; m a turn for the pitch."""
        if kind not in KINDS:
            raise ValueError(f'the joint "{name}" is of the unknown kind "{kind}": expected one of {", ".join(KINDS)}')
        geometry = JointGeometry(_unit(axis), _vector(point), _unit(axis2), pitch)
        self.add(JointComponent(name, name, KINDS[kind], geometry), a=a, b=b)

    def _on(self, joint: Where, freedom: int | None) -> dict[str, int]:
        """Fields of what acts on one of the freedoms of a joint; ValueError where it has fewer, or where it has several
        and none is named."""
        name, wanted = (joint, "shaft") if isinstance(joint, str) else joint
        component = self.components.get(name)
        if component is None:
            return {}
        named = [port.size for port in component.ports if port.name == wanted]
        rates = (named or [1])[0]
        if freedom is None:
            if rates != 1:
                raise ValueError(f'which freedom of "{name}" is meant? It has {rates}, numbered from 0')
            freedom = 0
        if not 0 <= freedom < rates:
            raise ValueError(f'"{name}" has no freedom {freedom}: it has {rates}, numbered from 0')
        return {"freedom": freedom, "rates": rates}

    def motion(self, name: str, joint: Where, signal: Signal, *, freedom: int | None = None) -> None:
        """The joint's value follows the signal. `freedom`, here as in all that acts on joints: which of its rates."""
        self.add(shafts.MotionDrive(name, name, signal, **self._on(joint, freedom)), shaft=joint)

    def effort(self, name: str, joint: Where, signal: Signal, *, freedom: int | None = None) -> None:
        """The joint gets the effort of the signal, N·m or N."""
        self.add(shafts.EffortDrive(name, name, signal, **self._on(joint, freedom)), shaft=joint)

    def spring(
        self, name: str, joint: Where, stiffness: float, rest: float = 0.0, *, freedom: int | None = None
    ) -> None:
        """N·m/rad and rad, or N/m and m."""
        self.add(shafts.Spring(name, name, stiffness, rest, **self._on(joint, freedom)), shaft=joint)

    def damper(self, name: str, joint: Where, damping: float, *, freedom: int | None = None) -> None:
        """N·m·s/rad or N·s/m."""
        self.add(shafts.Damper(name, name, damping, **self._on(joint, freedom)), shaft=joint)

    def friction(
        self,
        name: str,
        joint: Where,
        coefficient: float = 0.0,
        *,
        static: float | None = None,
        effort: float = 0.0,
        static_effort: float | None = None,
        surfaces: Rubs | None = None,
        least: bool = False,
        freedom: int | None = None,
    ) -> None:
        """Coulomb friction: the coefficient in motion, and that at rest where it is greater; `effort` (N·m or N) that
        there is without load. `surfaces`: what rubs, needed for joints that turn; a slide takes loads at its point.
        `least`: where redundant constraints share loads, take the least reactions that balance; refused otherwise.
        """
        on = self._on(joint, freedom)
        component = self.components.get(joint if isinstance(joint, str) else joint[0])
        static = coefficient if static is None else static
        rest = effort if static_effort is None else static_effort
        friction = shafts.Friction(
            name,
            name,
            coefficient,
            static,
            effort,
            rest,
            freedom=on.get("freedom", 0),
            least=least,
            rates=on.get("rates", 1),
        )
        if static and isinstance(component, JointComponent):
            levers = (surfaces or Rubs()).levers(component.kind, component.geometry, friction.freedom)
            friction = replace(friction, **levers)
        self.add(friction, shaft=joint)

    def stop(
        self,
        name: str,
        joint: Where,
        lower: float = -math.inf,
        upper: float = math.inf,
        restitution: float = 0.0,
        *,
        freedom: int | None = None,
    ) -> None:
        """The joint's value stays between the limits, rad or m; impacts leave this share of the speed."""
        self.add(shafts.EndStop(name, name, lower, upper, restitution, **self._on(joint, freedom)), shaft=joint)

    def gear(
        self,
        name: str,
        a: Where,
        b: Where,
        ratio: float,
        *,
        pitch_point: ArrayLike | None = None,
        flanks: tuple[ArrayLike, ArrayLike] | None = None,
        others: Mapping[str, float] | None = None,
        efficiency: float = 1.0,
        efficiency_back: float | None = None,
    ) -> None:
        """The value of joint `a` is the ratio times that of joint `b`, and of `others`, by their names, each with its
        own ratio: planetary trains and differentials.

        `pitch_point` (3,) m and `flanks`, the directions (3,) in which either side of the teeth at `a` pushes those at
        `b`, where the force between the teeth is to be known, and what it does to the bearings. `efficiency` from `a`
        to `b`, and back: default that of teeth that rub alike both ways (`shafts.rubbing_back`).
        """
        flank, back = (None, None) if flanks is None else (_unit(side) for side in flanks)
        more = dict(zip(ascii_lowercase[2:], (others or {}).items(), strict=False))
        ratios = {port: factor for port, (_, factor) in more.items()}
        lost = efficiency, shafts.rubbing_back(efficiency) if efficiency_back is None else efficiency_back
        gear = Gear(name, name, ratio, _vector(pitch_point), flank, back, -math.inf, math.inf, ratios, *lost)
        self.add(gear, a=a, b=b, **{port: joint for port, (joint, _) in more.items()})

    def servo(
        self, name: str, joint: Where, target: Signal, controller: shafts.Controller, *, freedom: int | None = None
    ) -> None:
        """The effort on the joint is the controller's output for the target of its value."""
        self.add(shafts.Servo(name, name, target, controller, **self._on(joint, freedom)), shaft=joint)

    def motor(
        self,
        name: str,
        joint: Where,
        resistance: float,
        inductance: float,
        constant: float,
        gear: float = 1.0,
        current_limit: float = math.inf,
        *,
        rotor_inertia: float = 0.0,
        rotor_friction: float = 0.0,
        efficiency: float = 1.0,
        efficiency_back: float | None = None,
        freedom: int | None = None,
    ) -> None:
        """A DC motor on the joint: Ω, H, N·m/A, turns of the motor a turn of the joint, A; its rotor: kg·m², N·m; the
        efficiency of its gear, and back: default that of teeth that rub alike both ways (`shafts.rubbing_back`)."""
        back = shafts.rubbing_back(efficiency) if efficiency_back is None else efficiency_back
        rotor = rotor_inertia, rotor_friction, efficiency, back
        on = self._on(joint, freedom)
        motor = shafts.DcMotor(name, name, resistance, inductance, constant, gear, current_limit, *rotor, **on)
        self.add(motor, shaft=joint)

    def voltage(self, name: str, motor: Where, signal: Signal) -> None:
        """The voltage across the terminals of a motor, V."""
        self.add(shafts.VoltageSource(name, name, signal), terminals=motor)

    def controller(
        self,
        name: str,
        motor: Where,
        joint: Where,
        target: Signal,
        controller: shafts.Controller,
        *,
        freedom: int | None = None,
    ) -> None:
        """A controller that gives the motor its voltage for the target of the joint's value."""
        on = self._on(joint, freedom)
        self.add(shafts.VoltageController(name, name, target, controller, **on), terminals=motor, shaft=joint)

    def spring_between(
        self,
        name: str,
        a: Where,
        b: Where,
        points: tuple[ArrayLike, ArrayLike],
        stiffness: float,
        damping: float = 0.0,
        rest: float = 0.0,
    ) -> None:
        """A spring and damper between a point of body `a` and one of body `b`: N/m, N·s/m, m."""
        point, other = (np.asarray(end, dtype=np.float64) for end in points)
        self.add(SpringDamper(name, name, point, other, stiffness, damping, rest), a=a, b=b)

    def gas_spring(
        self,
        name: str,
        a: Where,
        b: Where,
        points: tuple[ArrayLike, ArrayLike],
        force: float,
        extended: float,
        column: float,
        exponent: float = 1.0,
        damping: float = 0.0,
    ) -> None:
        """A gas spring between a point of body `a` and one of body `b`: N at the extended length, m, m of gas there,
        the exponent of the gas law, N·s/m."""
        point, other = (np.asarray(end, dtype=np.float64) for end in points)
        self.add(GasSpring(name, name, point, other, force, extended, column, exponent, damping), a=a, b=b)

    def bushing(
        self,
        name: str,
        a: Where,
        b: Where,
        point: ArrayLike,
        stiffness: ArrayLike,
        torsion: ArrayLike = (0.0, 0.0, 0.0),
        damping: ArrayLike = (0.0, 0.0, 0.0),
        torsion_damping: ArrayLike = (0.0, 0.0, 0.0),
        *,
        axes: ArrayLike | None = None,
    ) -> None:
        """An elastic bearing of body `b` in body `a` at a point: N/m and N·m/rad along and about three axes, N·s/m and
        N·m·s/rad; `axes` (3, 3) as columns, by default those of the world."""
        at, triad = np.asarray(point, dtype=np.float64), np.eye(3) if axes is None else np.asarray(axes, np.float64)
        of_axes = (np.asarray(values, np.float64) for values in (stiffness, torsion, damping, torsion_damping))
        self.add(Bushing(name, name, at, at, triad, *of_axes), a=a, b=b)

    def load(
        self,
        name: str,
        body: Where,
        point: ArrayLike,
        force: ArrayLike = (0.0, 0.0, 0.0),
        torque: ArrayLike = (0.0, 0.0, 0.0),
        *,
        turning: bool = False,
        signal: Signal | None = None,
    ) -> None:
        """A force (N) and a torque (N·m) on a body at a point; `turning`: they turn with the body; `signal`: what both
        are multiplied by."""
        push, twist, at = (np.asarray(value, dtype=np.float64) for value in (force, torque, point))
        self.add(LoadComponent(name, name, push, twist, at, turning, signal or STEADY), frame=body)


def _vector(value: ArrayLike | None) -> Array | None:
    return None if value is None else np.asarray(value, dtype=np.float64)


def _unit(value: ArrayLike | None) -> Array | None:
    """The direction with length 1; what has none stays as it is, and is refused where it is needed."""
    vector = _vector(value)
    with np.errstate(over="ignore"):
        length = 0.0 if vector is None else float(np.linalg.norm(vector))
    return vector / length if vector is not None and 0.0 < length < np.inf else vector
