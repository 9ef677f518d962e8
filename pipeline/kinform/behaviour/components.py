"""Components, their ports, and the nodes that join ports: the device as a network."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field
from functools import cached_property
from typing import Annotated

import numpy as np

from kinform.behaviour import shafts
from kinform.behaviour.joints import JointGeometry, JointKind
from kinform.behaviour.ports import FRAME, Component, Node, Port
from kinform.behaviour.signals import STEADY, Signal
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import MATRIX, XYZ, Direction, Inertia, JointValue, Metres, Place, Ratio

LEAST_GAS = 1e-6
"""Share of the column of a gas spring below which its force grows no further, so that it stays finite: nothing is
pushed in so far."""


@dataclass(frozen=True)
class Ground(Component):
    """Six equations: its frame is at rest."""


@dataclass(frozen=True, eq=False)
class RigidBody(Component):
    """Six equations: Newton and Euler. World frame at the pose of the meshes."""

    mass: Annotated[float, "kg"] | None
    """kg; None when unknown: the body then moves in kinematics only."""
    centre_of_mass: Place
    """(3,) m."""
    inertia: Inertia
    """(3, 3) kg·m² about the centre of mass."""


@dataclass(frozen=True, eq=False)
class JointComponent(Component):
    """Ports a and b at its first and second body, and the shaft with its rates and efforts.

    Six equations: the wrenches at a and b balance. Six: b's twist less a's is that of the shaft's
    rates. As many as rates: the wrench at b along the freedoms is the shaft's effort.
    """

    kind: JointKind
    geometry: JointGeometry

    @property
    def ports(self) -> tuple[Port, ...]:
        frames = (Port("a", FRAME), Port("b", FRAME))
        return (*frames, Port("shaft", self.kind.rates)) if self.kind.rates else frames


@dataclass(frozen=True, eq=False)
class Gear(Component):
    """value at a = ratio · value at b + Σ others · value at c, d, …; the efforts do no work between them, but for what
    a gear of two ports loses. An equation a port.

    Where teeth do that, their force acts along one of two lines through the pitch point, whichever pushes. Planetary
    trains and differentials have three ports and more.
    """

    PORTS = (Port("a", 1), Port("b", 1))

    ratio: Ratio
    pitch_point: Place | None = None
    """(3,) m, at the pose of the meshes; the body that both joints have in common carries it."""
    flank: Direction | None = None
    """(3,) unit: from the other body of the joint at a into that of the joint at b."""
    back: Direction | None = None
    """(3,) the same of the flanks behind the teeth."""
    lower: JointValue = -math.inf
    """Values at a (rad or m) between which there are teeth."""
    upper: JointValue = math.inf
    others: dict[str, float] = field(default_factory=dict)
    """By the names of the ports after b, which are c, d, …: the ratio of each."""
    efficiency: Ratio = 1.0
    """Share of the power put in at a that comes out at b; zero or less: a cannot drive b."""
    efficiency_back: Ratio = 1.0
    """Of the power put in at b, at a; one of the two is positive."""

    @property
    def lossy(self) -> bool:
        """Whether it loses power."""
        return self.efficiency != 1.0 or self.efficiency_back != 1.0

    @property
    def ports(self) -> tuple[Port, ...]:
        """a, b, and one for each of the others."""
        return (*self.PORTS, *(Port(name, 1) for name in self.others))

    @property
    def terms(self) -> tuple[tuple[str, float], ...]:
        """Ports, each with what multiplies its value in the sum that is zero: 1 at a."""
        return (("a", 1.0), ("b", -self.ratio), *((name, -float(ratio)) for name, ratio in self.others.items()))


@dataclass(frozen=True, eq=False)
class LoadComponent(Component):
    """A given wrench on a body at a point; six equations."""

    force: Annotated[Array, "N", XYZ]
    """(3,) N."""
    torque: Annotated[Array, "N·m", XYZ]
    """(3,) N·m."""
    point: Place
    """(3,) m, of the body, in the world at the pose of the meshes."""
    turning: bool
    """True: force and torque turn with the body."""
    signal: Signal = STEADY
    """What both are multiplied by."""


@dataclass(frozen=True, eq=False)
class SpringDamper(Component):
    """A spring and a damper in parallel between a point of one body and a point of another.

    Its pull along the line is stiffness · (length − rest) + damping · d(length)/dt. Twelve equations.
    """

    PORTS = (Port("a", FRAME), Port("b", FRAME))

    point: Place
    """(3,) m, of the body at port a, in the world at the pose of the meshes."""
    other: Place
    """(3,) m, of the body at port b."""
    stiffness: Annotated[float, "N/m"]
    """N/m."""
    damping: Annotated[float, "N·s/m"]
    """N·s/m."""
    rest: Metres
    """m."""

    def pull(self, length: Array) -> Array:
        """N, of the spring alone, at lengths (m)."""
        return np.asarray(self.stiffness * (length - self.rest))


@dataclass(frozen=True, eq=False)
class GasSpring(Component):
    """A gas spring and a damper in parallel between a point of one body and a point of another.

    It pushes with force · (column / (column − (extended − length)))^exponent, the gas law, in which `column` is the
    length of gas at the extended length. Twelve equations.
    """

    PORTS = (Port("a", FRAME), Port("b", FRAME))

    point: Place
    """(3,) m, of the body at port a, in the world at the pose of the meshes."""
    other: Place
    """(3,) m, of the body at port b."""
    force: Annotated[float, "N"]
    """N, at the extended length."""
    extended: Metres
    """m."""
    column: Metres
    """m."""
    exponent: Ratio
    damping: Annotated[float, "N·s/m"]
    """N·s/m."""

    def left(self, length: Array) -> Array:
        """m of gas that is left at lengths (m); no less than LEAST_GAS of it all."""
        return np.maximum(self.column - (self.extended - length), LEAST_GAS * self.column)

    def pull(self, length: Array) -> Array:
        """N, of the gas alone, at lengths (m): it pushes."""
        return np.asarray(-self.force * (self.column / self.left(length)) ** self.exponent)


@dataclass(frozen=True, eq=False)
class Bushing(Component):
    """An elastic bearing between two bodies: in axes that the body at port a carries, forces along each against the
    shift of the second point from the first, torques about each against the rotation vector. Twelve equations."""

    PORTS = (Port("a", FRAME), Port("b", FRAME))

    point: Place
    """(3,) m, of the body at port a, in the world at the pose of the meshes."""
    other: Place
    """(3,) m, of the body at port b; both forces act here."""
    axes: Annotated[Array, "1", MATRIX]
    """(3, 3) as columns."""
    stiffness: Annotated[Array, "N/m", XYZ]
    """(3,)."""
    torsion: Annotated[Array, "N·m/rad", XYZ]
    """(3,)."""
    damping: Annotated[Array, "N·s/m", XYZ]
    """(3,)."""
    torsion_damping: Annotated[Array, "N·m·s/rad", XYZ]
    """(3,)."""


Elastic = SpringDamper | GasSpring | Bushing
"""What pulls between two bodies."""


@dataclass(frozen=True, eq=False, init=False)
class System(Component):
    """Components and the nodes between them; every port is in exactly one node.

    A component may be a system itself, to any depth: from outside it is a component with the ports that it
    exposes. `flat` (module `nested`) is the same network without levels, which the solver and the exports read.
    """

    components: tuple[Component, ...]
    nodes: tuple[Node, ...]
    exposed: tuple[tuple[str, tuple[str, str]], ...]
    """(name of a port of the system, (component, port) inside whose node it is)."""
    prefixed: bool
    """Whether names inside get the system's own in front where levels are left out; False where names are unique
    in the whole model already, as those of sub-assemblies are."""
    _by_name: dict[str, Component] = field(init=False, repr=False)

    def __init__(
        self,
        components: tuple[Component, ...],
        nodes: tuple[Node, ...],
        name: str = "",
        subject: str = "",
        exposed: tuple[tuple[str, tuple[str, str]], ...] = (),
        prefixed: bool = True,
    ) -> None:
        """Raises ValueError for names that are taken twice, and for ports in no node or in two."""
        by_name = {component.name: component for component in components}
        values = {
            "name": name, "subject": subject or name, "components": components, "nodes": nodes, "exposed": exposed,
            "prefixed": prefixed, "_by_name": by_name,
        }  # fmt: skip
        for key, value in values.items():
            object.__setattr__(self, key, value)
        if len(by_name) != len(components):
            names = [component.name for component in components]
            twice = min(name for name in by_name if names.count(name) > 1)
            raise ValueError(f'two components of a system have the same name: "{twice}"')
        if len({port for port, _ in exposed}) != len(exposed):
            raise ValueError(f'the system "{name}" exposes two ports of the same name')
        self._check_ports()

    def _check_ports(self) -> None:
        """Every port is in exactly one node, and fits it."""
        sizes = {(c.name, port.name): port.size for c in self.components for port in c.ports}
        for node in self.nodes:
            for port in node.ports:
                if sizes.pop(port, None) != node.size:
                    raise ValueError(f"port {port[1]} of {port[0]} is joined twice, does not exist, or does not fit")
        if sizes:
            component, name = min(sizes)
            raise ValueError(f"port {name} of {component} is in no node")
        for name, inner in self.exposed:
            if inner not in self._node_of:
                raise ValueError(
                    f"the exposed port {name} leads to port {inner[1]} of {inner[0]}, which does not exist"
                )

    @property
    def ports(self) -> tuple[Port, ...]:
        """What it exposes."""
        return tuple(Port(name, self._node_of[inner].size) for name, inner in self.exposed)

    @property
    def equations(self) -> int:
        """What is left between its ports of its equations, once those found the unknowns inside."""
        inside = sum(port.size for c in self.components for port in c.ports)
        outside = sum(port.size for port in self.ports)
        return sum(c.equations for c in self.components) + inside + outside - 2 * inside

    @property
    def systems(self) -> tuple[System, ...]:
        """Systems inside, in order."""
        return tuple(c for c in self.components if isinstance(c, System))

    @cached_property
    def _node_of(self) -> dict[tuple[str, str], Node]:
        return {port: node for node in self.nodes for port in node.ports}

    @cached_property
    def _met(self) -> dict[tuple[str, str], tuple[list[Ground | RigidBody], list[JointComponent]]]:
        """Bodies and joints at each node, by its first port: a node of thousands of ports is looked through once."""
        out: dict[tuple[str, str], tuple[list[Ground | RigidBody], list[JointComponent]]] = {}
        for node in self.nodes:
            bodies, joints = out.setdefault(node.ports[0], ([], []))
            for name, _ in node.ports:
                component = self._by_name[name]
                if isinstance(component, Ground | RigidBody):
                    bodies.append(component)
                elif isinstance(component, JointComponent):
                    joints.append(component)
        return out

    def bodies_at(self, component: str, port: str) -> list[Ground | RigidBody]:
        """Bodies and ground at the node of a port; KeyError for unknown ports."""
        return self._met[self.node(component, port).ports[0]][0]

    def joints_at(self, component: str, port: str) -> list[JointComponent]:
        """Joints at the node of a port, one as often as it has ports there; KeyError for unknown ports."""
        return self._met[self.node(component, port).ports[0]][1]

    def component(self, name: str) -> Component:
        """The component of that name; KeyError otherwise."""
        return self._by_name[name]

    def node(self, component: str, port: str) -> Node:
        """The node that a port is in; KeyError for unknown ports."""
        return self._node_of[component, port]

    def at(self, component: str, port: str) -> Iterable[tuple[Component, str]]:
        """The other components at the node of a port, each with its port there."""
        for name, other in self.node(component, port).ports:
            if (name, other) != (component, port):
                yield self._by_name[name], other

    @property
    def ground(self) -> Ground:
        """The ground; ValueError when there is not exactly one."""
        (only,) = (c for c in self.components if isinstance(c, Ground))
        return only

    @cached_property
    def bodies(self) -> tuple[Ground | RigidBody, ...]:
        """Ground and bodies in order."""
        return tuple(c for c in self.components if isinstance(c, Ground | RigidBody))

    @cached_property
    def joints(self) -> tuple[JointComponent, ...]:
        """Joints in order."""
        return tuple(c for c in self.components if isinstance(c, JointComponent))

    @cached_property
    def gears(self) -> tuple[Gear, ...]:
        """Gears in order."""
        return tuple(c for c in self.components if isinstance(c, Gear))

    @cached_property
    def springs(self) -> tuple[Elastic, ...]:
        """Springs, gas springs and bushings between points, in order."""
        return tuple(c for c in self.components if isinstance(c, Elastic))

    @cached_property
    def loads(self) -> tuple[LoadComponent, ...]:
        """Loads in order."""
        return tuple(c for c in self.components if isinstance(c, LoadComponent))

    @cached_property
    def steady_loads(self) -> tuple[LoadComponent, ...]:
        """Those that do not change over time."""
        return tuple(load for load in self.loads if load.signal == STEADY)

    def actors(self, joint: str) -> tuple[shafts.Actor, ...]:
        """What acts on the shaft of the joint component of that name."""
        component = self._by_name[joint]
        if not isinstance(component, JointComponent) or component.kind.rates == 0:
            return ()
        return tuple(c for c, _ in self.at(joint, "shaft") if isinstance(c, shafts.Actor))

    def supply(self, motor: str) -> shafts.VoltageSource | shafts.VoltageController:
        """What gives the motor of that name its voltage; ValueError when there is not exactly one."""
        sources = shafts.VoltageSource | shafts.VoltageController
        (only,) = (c for c, _ in self.at(motor, "terminals") if isinstance(c, sources))
        return only

    def body_at(self, component: str, port: str) -> Ground | RigidBody:
        """The body or ground at the node of a port; ValueError when there is not exactly one."""
        (only,) = self.bodies_at(component, port)
        return only

    def joint_at(self, component: str, port: str) -> JointComponent:
        """The joint at the node of a port; ValueError when there is not exactly one."""
        (only,) = self.joints_at(component, port)
        return only


COMPONENTS: dict[str, type[Component]] = {
    "ground": Ground,
    "rigid_body": RigidBody,
    "joint": JointComponent,
    "motion": shafts.MotionDrive,
    "effort": shafts.EffortDrive,
    "spring": shafts.Spring,
    "damper": shafts.Damper,
    "friction": shafts.Friction,
    "end_stop": shafts.EndStop,
    "servo": shafts.Servo,
    "dc_motor": shafts.DcMotor,
    "voltage_source": shafts.VoltageSource,
    "voltage_controller": shafts.VoltageController,
    "spring_damper": SpringDamper,
    "gas_spring": GasSpring,
    "bushing": Bushing,
    "gear": Gear,
    "load": LoadComponent,
    "system": System,
}
"""What components are called where the port model is data: in results files, in JSON, and on the screen."""

_NAMES = {cls: name for name, cls in COMPONENTS.items()}


def kind_of(component: Component) -> str:
    """The name of the component's kind. Raises ValueError for a kind that is none of kinform's."""
    try:
        return _NAMES[type(component)]
    except KeyError:
        raise ValueError(f'"{component.name}" is a {type(component).__name__}, which is no kind of component') from None
