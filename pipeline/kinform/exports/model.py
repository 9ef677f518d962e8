"""What every exporter reads: the port model of a design, where it starts, and what is left out of it.

It is the model that the simulation of the design used, so that an export and our trajectory are about the
same thing: the same joints, drives and initial values.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.behaviour import Behaviour, Component, JointComponent, RigidBody, System, build
from kinform.behaviour.components import Bushing, GasSpring, Gear, SpringDamper
from kinform.behaviour.shafts import DcMotor, EndStop, Friction
from kinform.behaviour.signals import STEADY
from kinform.design import Design
from kinform.errors import StageError
from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.function import no_stop_within, resolve_joint, stated_ranges
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import SimulationRequest
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassProperties
from kinform.model.simulation import Simulation
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.mechanism import Mechanism


@dataclass(frozen=True, eq=False)
class BodyStart:
    """Where a body is at time zero and how it moves, in the world."""

    position: Array
    """(3,) m, p_WB."""
    quaternion: Array
    """(4,) q_WB, wxyz, w ≥ 0."""
    velocity: Array
    """(3,) m/s of the body's origin."""
    omega: Array
    """(3,) rad/s."""


@dataclass(frozen=True)
class Limits:
    """Of a joint with one freedom; None: none is stated."""

    effort: float | None = None
    """N·m or N."""
    speed: float | None = None
    """rad/s or m/s."""


@dataclass(frozen=True, eq=False)
class ExportModel:
    """The port model and what belongs to it."""

    assembly: Assembly
    kinematics: Kinematics
    simulation: Simulation | None
    """Our own run, where there is one: done or stopped."""
    refused: str
    """Why our own simulation was refused, else ""."""
    system: System
    """Without levels."""
    nested: System
    """With a system for each sub-assembly."""
    masses: tuple[MassProperties, ...]
    """Of bodies, the ground included; empty where they are not computed."""
    mechanism: Mechanism
    gravity: Array
    """(3,) m/s²."""
    duration: float
    step: float
    q: Array
    """(nq,) joint coordinates at time zero, in the order of the mechanism."""
    v: Array
    """(n,) joint rates at time zero."""
    start: dict[str, BodyStart]
    """By name of body."""
    ranges: dict[str, tuple[float, float]]
    """(lower, upper) rad or m of joints with one freedom, ±inf for a free side, by name of joint."""
    limits: dict[str, Limits]
    """What joints are limited to besides, by name of joint; of those that are."""
    stated: dict[str, tuple[bool, int]]
    """By name of joint, of those that the function states: whether it only closes a loop, and its place among them."""
    adrift: tuple[str, ...]
    """Bodies that no joints connect with the ground, sorted."""
    missing: tuple[str, ...]
    """What the design has and the port model has not, in sentences."""
    elsewhere: tuple[str, ...]
    """Components of the port model that no other format has equations for, in sentences."""

    @property
    def lost(self) -> tuple[str, ...]:
        """What formats other than the port model itself do not carry, whatever they can say."""
        return (*self.missing, *self.elsewhere)

    @property
    def taken(self) -> tuple[str, ...]:
        """What follows from the stated joints and not from contact, in sentences: bodies, and joints that no contact
        holds."""
        members = self.kinematics.membership
        if not members:
            return ()
        unclear = [one.part for one in members if one.either]
        more = f"; {quoted(unclear)} could be in another" if unclear else ""
        stated = {joint.name for joint in self.kinematics.joints if joint.status == "stated"}
        joints = [
            f"{one.subject}: as stated, no contact holds it" for one in self.system.joints if one.subject in stated
        ]
        return (f"which parts are one body follows from the stated joints{more}", *joints)

    @property
    def dry(self) -> tuple[str, ...]:
        """Friction of a given effort, which some formats have a number for, in sentences."""
        return tuple(
            f"{one.subject}: Coulomb friction of {one.effort:g} N·m or N"
            for one in self.system.components
            if isinstance(one, Friction) and one.static == 0.0
        )

    @property
    def stiction(self) -> tuple[str, ...]:
        """What of it these have no number for."""
        return tuple(
            f"{one.subject}: that friction is greater at rest ({one.static_effort:g} N·m or N)"
            for one in self.system.components
            if isinstance(one, Friction) and one.static == 0.0 and one.static_effort > one.effort
        )

    @property
    def teeth(self) -> tuple[str, ...]:
        """What becomes of teeth where a format has gears as ratios between joints, in sentences."""
        return tuple(
            f"{gear.subject}: a ratio between its joints; what its teeth push on the bearings is left out"
            + (", and that they end" if math.isfinite(gear.lower) or math.isfinite(gear.upper) else "")
            for gear in self.system.gears
            if gear.pitch_point is not None
        )

    @property
    def name(self) -> str:
        """What the user calls it."""
        return self.assembly.name

    @property
    def with_forces(self) -> bool:
        """Whether our own run, if any, is one of dynamics."""
        return self.simulation is None or self.simulation.level == "dynamic"

    def coordinates(self, joint: str) -> tuple[Array, Array]:
        """Coordinates and rates of a joint at time zero."""
        (slot,) = (s for s in self.mechanism.slots if s.name == joint)
        return self.q[slot.q], self.v[slot.v]


def export_model(design: Design) -> ExportModel:
    """The model of a design. Raises StageError before joints are derived."""
    if design.ranged is None:
        raise StageError("`kinform export`", "joints")
    assembly, run = design.assembly, design.simulation
    refused = run.reason if run is not None and run.status == "refused" else ""
    if run is not None and run.status not in ("done", "partial", "stopped"):
        run = None
    kinematics, gears = design.ranged, all(part.mesh is None for part in assembly.parts)
    if run is not None and run.level == "functional":
        from kinform.kinematics import functional

        kinematics, gears = functional(assembly), True
    behaviour = design.behaviour
    if behaviour is None or run is None:
        behaviour = build(
            assembly, kinematics, design.mass, gears=gears, contacts=design.contacts, surfaces=design.surfaces
        )
    mechanism, adrift = assemble(behaviour.system)
    q, v = _initial(mechanism, run)
    request = assembly.simulation or SimulationRequest()
    return ExportModel(
        assembly=assembly,
        kinematics=kinematics,
        simulation=run,
        refused=refused,
        system=behaviour.system,
        nested=behaviour.nested,
        masses=() if design.mass is None else design.mass.bodies,
        mechanism=mechanism,
        gravity=np.asarray(request.gravity, dtype=np.float64),
        duration=request.duration,
        step=request.step,
        q=q,
        v=v,
        start=_starts(mechanism, q, v),
        ranges=_ranges(assembly, kinematics, behaviour.system.joints),
        limits=_limits(assembly, kinematics, behaviour.system.joints),
        stated=_stated(assembly, kinematics),
        adrift=tuple(sorted(adrift)),
        missing=_missing(behaviour, adrift),
        elsewhere=_elsewhere(behaviour.system),
    )


def _stated(assembly: Assembly, kinematics: Kinematics) -> dict[str, tuple[bool, int]]:
    """Joints as the function states them, in its order; one that it states twice by the first."""
    out: dict[str, tuple[bool, int]] = {}
    for place, intended in enumerate(assembly.function.joints):
        joint = resolve_joint(assembly, kinematics, intended.name).joint
        if joint is not None:
            out.setdefault(joint.name, (intended.closure, place))
    return out


def _initial(mechanism: Mechanism, run: Simulation | None) -> tuple[Array, Array]:
    """Coordinates and rates of our own run at its beginning, else rest at the pose of the meshes."""
    q, v = mechanism.start, np.zeros(mechanism.rates)
    if run is None or not len(run.time) or run.joint_names != tuple(slot.name for slot in mechanism.slots):
        return q, v
    for k, slot in enumerate(mechanism.slots):
        columns = slice(int(run.joint_offset[k]), int(run.joint_offset[k + 1]))
        q[slot.q] = run.joint_position[0, columns]
        v[slot.v] = run.joint_velocity[0, columns][1 if slot.has_ball else 0 :]
    return q, v


def _starts(mechanism: Mechanism, q: Array, v: Array) -> dict[str, BodyStart]:
    X = mechanism.poses(q)
    V = mechanism.twists(mechanism.screws(X), v)
    out = {}
    for name, link in zip(mechanism.bodies, mechanism.link_of, strict=True):
        R, omega = X[link, :3, :3], V[link, :3]
        about_centre = X[link, :3, 3] - R @ mechanism.centre
        velocity = V[link, 3:] + np.cross(omega, about_centre)
        out[name] = BodyStart(about_centre + mechanism.centre, quaternions(R[None])[0], velocity, omega)
    return out


def _ranges(
    assembly: Assembly, kinematics: Kinematics, joints: tuple[JointComponent, ...]
) -> dict[str, tuple[float, float]]:
    """Ranges that the geometry leaves; a side that it leaves open, or that is not known, as the function states it.
    What a robot description states is a limit, beyond which it does not go though its parts could. Of a joint that
    contact does not hold, what meets where it is drawn ends no range: it overlaps, or touches, from the start."""
    single = {joint.subject for joint in joints if joint.kind.rates == 1}
    out: dict[str, tuple[float, float]] = {}
    for name, (low, high) in stated_ranges(assembly, kinematics):
        if name in single:
            out[name] = (float(low), float(high))
    described = {joint.name for description in assembly.descriptions for joint in description.joints}
    named = (resolve_joint(assembly, kinematics, name).joint for name in sorted(described))
    limited = {joint.name for joint in named if joint is not None}
    for joint in kinematics.joints:
        if joint.name in single and joint.range_status in ("found", "unbounded"):
            stated_low, stated_high = out.get(joint.name, (-np.inf, np.inf))
            wide = stated_high - stated_low if np.isfinite(stated_high - stated_low) else 0.0
            near = no_stop_within(joint.type, wide)
            low, high = (
                said if end is None or (joint.status == "stated" and abs(end) <= near) else end
                for end, said in ((joint.range_lower, stated_low), (joint.range_upper, stated_high))
            )
            if joint.name in limited:
                low, high = max(low, stated_low), min(high, stated_high)
            out[joint.name] = (float(low), float(high))
    return dict(sorted(out.items()))


def _limits(assembly: Assembly, kinematics: Kinematics, joints: tuple[JointComponent, ...]) -> dict[str, Limits]:
    """The least limits of effort and speed that joints have in all runs, as robot descriptions state them."""
    single = {joint.subject for joint in joints if joint.kind.rates == 1}
    least: dict[tuple[str, str], float] = {}
    for requirement in assembly.function.requirements:
        if requirement.when_run and requirement.kind in ("torque", "speed"):
            joint = resolve_joint(assembly, kinematics, requirement.values["joint"]).joint
            if joint is not None and joint.name in single:
                key, limit = (str(joint.name), requirement.kind), float(requirement.values["limit"])
                least[key] = min(limit, least.get(key, math.inf))
    names = sorted({name for name, _ in least})
    return {name: Limits(least.get((name, "torque")), least.get((name, "speed"))) for name in names}


_ELSEWHERE: dict[type[Component], str] = {
    EndStop: "end stops with impacts",
    Friction: "Coulomb friction by load",
    SpringDamper: "a spring between two points",
    GasSpring: "a gas spring",
    Bushing: "a bushing",
}
"""What the equations of the other formats are not written for."""


def _elsewhere(system: System) -> tuple[str, ...]:
    out = [
        f"{component.subject}: {_ELSEWHERE[type(component)]}, which only json carries"
        for component in system.components
        if type(component) in _ELSEWHERE and not (isinstance(component, Friction) and component.static == 0.0)
    ]
    out += [
        f"{one.subject}: the efficiency of its gear ({one.efficiency:g}, back {one.efficiency_back:g}), which only "
        "json carries"
        for one in system.components
        if isinstance(one, Gear | DcMotor) and one.lossy
    ]
    changing = [load for load in system.loads if load.signal != STEADY]
    return (*out, *(f"{load.subject}: a load that changes over time, which only json carries" for load in changing))


def _missing(behaviour: Behaviour, adrift: tuple[str, ...]) -> tuple[str, ...]:
    out = [f"{subject}: {why}" for subject, why in (*behaviour.failures, *behaviour.forces_missing)]
    out += [f"{subject}: it is held: {why}" for subject, why in behaviour.held]
    out += [f"{body.subject}: its mass is not known" for body in _weightless(behaviour.system)]
    out += [f"{name}: no joints connect this body with the ground; it is free" for name in sorted(adrift)]
    return tuple(out)


def _weightless(system: System) -> list[RigidBody]:
    return [body for body in system.bodies if isinstance(body, RigidBody) and body.mass is None]
