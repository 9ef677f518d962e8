"""Makes the port model of a design from its joints, its masses and what acts on it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from kinform.behaviour.component_owners import component_owners
from kinform.behaviour.components import Ground, JointComponent, RigidBody, System
from kinform.behaviour.couplings import Imposed, imposed_couplings
from kinform.behaviour.drives_and_loads import make_drive, make_gear, make_load, make_spring, mesh_gear
from kinform.behaviour.efficiencies import lossy, lost_nowhere, stated_losses
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.nested import nest
from kinform.behaviour.ports import Component, Node
from kinform.behaviour.shafts import EndStop
from kinform.behaviour.sliding import sliding_joints
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.function import resolve_joint, stated_ranges
from kinform.kinematics import is_higher
from kinform.model.assembly import Assembly
from kinform.model.collisions import JointRange
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.mass import MassReport
from kinform.model.quantities import Reason
from kinform.model.surfaces import MeshSurfaces


@dataclass(frozen=True, eq=False)
class Behaviour:
    """The port model of a design, and what could not be made part of it."""

    system: System
    """Without levels, as the solver reads it."""
    nested: System
    """The same with a system for each sub-assembly; without its levels it is `system` in another order."""
    failures: tuple[Reason, ...]
    """(subject, why) of joints and drives without which the model is not that of the design."""
    forces_missing: tuple[Reason, ...]
    """(subject, why) of what acts only by forces: dynamics would be wrong without, kinematics is not."""
    held: tuple[Reason, ...] = ()
    """(subject, why) of joints that are not understood and rigid in the model, and of what acts on them and is left
    out: what is asked for with `[simulation] partial = true`."""
    imposed: tuple[Reason, ...] = ()
    """(subject of the gear, what it stands for) of couplings that are imposed as stated on joints of geometry."""


class _Builder:
    """Collects components and which ports meet."""

    def __init__(self) -> None:
        self.components: list[Component] = []
        self.meetings: dict[str, list[tuple[str, str]]] = defaultdict(list)
        self.sizes: dict[str, int] = {}

    def add(self, component: Component, **nodes: str) -> None:
        """Add a component whose ports go to the nodes of these keys."""
        self.components.append(component)
        for port in component.ports:
            key = nodes[port.name]
            self.meetings[key].append((component.name, port.name))
            self.sizes[key] = port.size

    def system(self) -> System:
        nodes = tuple(Node(tuple(ports), self.sizes[key]) for key, ports in self.meetings.items())
        return System(tuple(self.components), nodes)


def build(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    *,
    gears: bool = False,
    contacts: Contacts | None = None,
    surfaces: Mapping[str, MeshSurfaces] | None = None,
    reach: Sequence[JointRange] = (),
) -> Behaviour:
    """The port model: bodies and ground, joints, drives, loads, and with `gears` the couplings of
    `[function]`, which geometry does not show.

    Joints that are ambiguous or general are failures, as are drives on freedoms that do not exist; where `[simulation]`
    is partial such joints are rigid instead, and what acts on them is left out. From `contacts` and `surfaces`
    friction has its radii and its materials. `reach`: how far joints go, where they are to stop where meshes meet.
    """
    builder = _Builder()
    partial = assembly.simulation is not None and assembly.simulation.partial
    failures: list[tuple[str, str]] = []
    held: list[tuple[str, str]] = []
    forces_missing: list[tuple[str, str]] = []
    masses = {} if mass is None else {body.name: body for body in mass.bodies}
    for body in kinematics.bodies:
        name = f"body {body.name}"
        if body.ground:
            builder.add(Ground(name, body.name), frame=name)
            continue
        known = masses.get(body.name)
        if known is None or known.mass is None:
            rigid = RigidBody(name, body.name, None, np.full(3, np.nan), np.full((3, 3), np.nan))
        else:
            rigid = RigidBody(name, body.name, known.mass, known.centre_of_mass, known.inertia)
        builder.add(rigid, frame=name)
    stated = enumerate(assembly.function.couplings, start=1)
    imposed = Imposed(tuple(stated), {}) if gears else imposed_couplings(assembly, kinematics, contacts)
    ties = {
        coupling.through: coupling
        for coupling in reversed(kinematics.couplings)
        if coupling.kind != "screw" and coupling.through not in imposed.replaced
    }
    uneven = {coupling.through for coupling in kinematics.couplings if coupling.kind == "cam"}
    for joint in kinematics.joints:
        if joint.type == "general" and (joint.freedoms == 6 or joint.name in ties or joint.name in imposed.replaced):
            continue
        made, why = _joint(joint)
        if contacts is not None and joint.name not in uneven and is_higher(joint, contacts.patches):
            why += "; if it is of teeth, state the ratio of the joints that they tie as a [[function.coupling]]"
        first, second = (f"body {name}" for name in joint.bodies)
        if made is None:
            if partial:
                builder.add(_rigid(joint.name), a=first, b=second)
            (held if partial else failures).append((joint.name, why))
            continue
        builder.add(made, a=first, b=second, shaft=f"shaft {joint.name}")
    losing = stated_losses(assembly, kinematics, imposed)
    modelled = {c.subject: c for c in builder.components if isinstance(c, JointComponent)}
    stiff = {name for name, _ in held}
    modelled = {name: joint for name, joint in modelled.items() if name not in stiff}
    for name, coupling in sorted(ties.items()):
        teeth = mesh_gear(coupling, modelled)
        teeth = teeth if isinstance(teeth, str) else lossy(teeth, coupling, losing)
        if isinstance(teeth, str):
            if partial:
                bodies = next(joint.bodies for joint in kinematics.joints if joint.name == name)
                builder.add(_rigid(name), a=f"body {bodies[0]}", b=f"body {bodies[1]}")
            (held if partial else failures).append((name, teeth))
        else:
            builder.add(teeth, **{port: f"shaft {joint}" for port, joint in zip("ab", coupling.joints, strict=True)})
    rubbing = sliding_joints(assembly, kinematics, contacts, surfaces or {})
    for number, drive in enumerate(assembly.function.drives, start=1):
        actors, joint_name, why, by_force = make_drive(assembly, kinematics, modelled, drive, number, rubbing)
        for component in actors:
            builder.add(component, shaft=f"shaft {joint_name}", terminals=f"terminals {number}")
        if not actors:
            lost = held if partial and _acts_on(assembly, kinematics, drive.joint, held) else failures
            (forces_missing if by_force else lost).append((drive.joint, why))
    geared = []
    for number, wanted in imposed.couplings:
        gear, sides, why = make_gear(assembly, kinematics, modelled, wanted, number)
        if gear is not None:
            builder.add(gear, **{port: f"shaft {joint}" for port, joint in sides.items()})
            geared.append((gear.subject, [name for name, by in imposed.replaced.items() if by == number]))
        elif gears or number in imposed.replaced.values():
            failures.append(("coupling of " + " and ".join(wanted.every), why))
    forces_missing += lost_nowhere(losing, ties.values())
    for name, (lower, upper) in _stops(assembly, kinematics, reach):
        if name in modelled and modelled[name].kind.rates == 1 and not np.all(np.isinf([lower, upper])):
            restitution = assembly.simulation.restitution if assembly.simulation is not None else 0.0
            builder.add(EndStop(f"stop {name}", name, lower, upper, restitution), shaft=f"shaft {name}")
    for number, load in enumerate(assembly.function.loads, start=1):
        component_load, body_name, why = make_load(assembly, kinematics, mass, load, number)
        if component_load is not None:
            builder.add(component_load, frame=f"body {body_name}")
        else:
            forces_missing.append((load.part, why))
    for number, stated_spring in enumerate(assembly.function.springs, start=1):
        spring, ends, why = make_spring(assembly, kinematics, stated_spring, number)
        if spring is not None:
            builder.add(spring, a=f"body {ends[0]}", b=f"body {ends[1]}")
        else:
            forces_missing.append((stated_spring.name, why))
    system = builder.system()
    parts = {str(body.name): body.parts for body in kinematics.bodies}
    nested = nest(system, component_owners(system, parts))
    said = () if gears else tuple(_imposed(subject, replaced) for subject, replaced in geared)
    return Behaviour(system, nested, tuple(failures), tuple(forces_missing), tuple(held), said)


def _stops(
    assembly: Assembly, kinematics: Kinematics, reach: Sequence[JointRange]
) -> Iterator[tuple[str, tuple[float, float]]]:
    """Joints with where they stop (rad or m), as the request asks."""
    asked = assembly.simulation.stops if assembly.simulation is not None else ""
    if asked == "range":
        yield from stated_ranges(assembly, kinematics)
    for item in reach if asked == "found" else ():
        lower, upper = (
            free if end.status != "found" or end.value is None else float(end.value)
            for end, free in ((item.lower, -math.inf), (item.upper, math.inf))
        )
        yield str(item.joint), (lower, upper)


def _imposed(subject: str, replaced: Sequence[str]) -> Reason:
    """A coupling that is imposed as stated, and the contact that it stands for."""
    return subject, f"it stands for the contact of {quoted(replaced)}" if replaced else ""


def _rigid(name: str) -> JointComponent:
    """What holds a joint that is not understood."""
    return JointComponent(f"joint {name}", name, KINDS["fixed"], JointGeometry())


def _acts_on(assembly: Assembly, kinematics: Kinematics, name: str, held: Sequence[Reason]) -> bool:
    """Whether what acts on the joint of that name acts on one that is held."""
    joint = resolve_joint(assembly, kinematics, name).joint
    return joint is not None and joint.name in [subject for subject, _ in held]


def _joint(joint: Joint) -> tuple[JointComponent | None, str]:
    """The component of a derived joint, or why it has none."""
    if joint.type == "general" or joint.type not in KINDS:
        return None, f"the joint is {joint.type} with {joint.freedoms} freedoms: {joint.reason}"
    if joint.status == "ambiguous":
        return None, f"the joint is ambiguous: {joint.reason}"
    geometry = JointGeometry(joint.axis, joint.point, joint.axis2, joint.pitch)
    kind = KINDS[joint.type]
    try:
        kind.chain(geometry)
    except ValueError as error:
        return None, f"the {joint.type} joint cannot be placed: {error}"
    return JointComponent(f"joint {joint.name}", joint.name, kind, geometry), ""
