"""The behaviour of a design in the few values that a designer would recognise: what `diff` compares and a lock keeps.

SI and radians, world frame. A group of values is None where the stage that gives it has not run.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Joint
from kinform.model.mass import MassProperties

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Axis:
    """A line: unit direction, and a point on it (m), None where only the direction matters."""

    direction: Vector
    point: Vector | None


@dataclass(frozen=True)
class JointState:
    """A joint between two bodies."""

    name: str
    bodies: tuple[str, str]
    type: str
    status: str
    freedoms: int
    axis: Axis | None
    axis2: Axis | None
    centre: Vector | None
    """Of a spherical joint."""
    pitch: float | None
    range_lower: float | None
    range_upper: float | None
    """rad, or m of a prismatic joint; infinite where nothing stops it, None where that is not known."""
    range_status: str

    @property
    def slides(self) -> bool:
        """Whether its range is a length."""
        return self.type == "prismatic"


@dataclass(frozen=True)
class BodyMass:
    """Mass (kg), centre of mass (m) and moments of inertia (kg·m²) of a body; None where they are not known."""

    name: str
    mass: float | None
    centre_of_mass: Vector | None
    principal_moments: Vector | None
    """Principal."""
    inertia: tuple[float, ...] | None = None
    """xx, yy, zz, xy, xz, yz about the centre of mass, in the world: with the moments it says how the body is
    turned."""


@dataclass(frozen=True)
class Snapshot:
    """All of it, each sorted by name."""

    assembly: str
    bodies: tuple[tuple[str, tuple[str, ...]], ...] | None
    """(name, parts)."""
    ground: str | None
    joints: tuple[JointState, ...] | None
    mobility: tuple[tuple[str, int | None], ...] | None
    masses: tuple[BodyMass, ...] | None
    interferences: tuple[tuple[tuple[str, str], float], ...] | None
    """(parts, greatest depth in m) of overlaps that are no press fit."""
    simulation: tuple[str, str] | None
    """Status and level."""
    findings: tuple[tuple[str, tuple[str, ...], str, int], ...] | None
    """(code, subject, severity, how many)."""
    ranges: tuple[str, ...] | None = None
    """Joints whose range was computed; None where no range was."""
    shapes: tuple[tuple[str, str], ...] = ()
    """(part, what its mesh is known by), where it has one."""
    units: str = "mm"
    """Of the assembly, for people; all values are SI."""
    possible_overlaps: tuple[tuple[str, str], ...] = ()
    """Parts of which it is not known whether they overlap."""


def snapshot(design: Design) -> Snapshot:
    """The behaviour of a design as far as it has been derived."""
    kinematics, report = design.kinematics, design.report
    found = design.simulation.ranges if design.simulation is not None else None
    known = {item.joint: item for item in found or ()}
    return Snapshot(
        assembly=design.assembly.name,
        bodies=None
        if kinematics is None
        else tuple((str(b.name), tuple(map(str, b.parts))) for b in kinematics.bodies),
        ground=None if kinematics is None else next((str(b.name) for b in kinematics.bodies if b.ground), None),
        joints=None
        if kinematics is None
        else tuple(_joint(joint, known.get(joint.name)) for joint in kinematics.joints),
        mobility=None if kinematics is None else _counts(design),
        masses=None if design.mass is None else tuple(_mass(body) for body in design.mass.bodies),
        interferences=None if design.contacts is None else _overlaps(design),
        simulation=None if design.simulation is None else (design.simulation.status, design.simulation.level),
        findings=None
        if report is None
        else tuple(
            (code, subject, severity, count)
            for (code, subject, severity), count in sorted(
                Counter((f.code, f.subject, f.severity) for f in report.singles).items()
            )
        ),
        ranges=None if found is None else tuple(sorted(map(str, known))),
        shapes=tuple(sorted((str(p.name), p.mesh.digest) for p in design.assembly.parts if p.mesh is not None)),
        units=design.assembly.units,
        possible_overlaps=()
        if design.contacts is None
        else tuple((str(one.parts[0]), str(one.parts[1])) for one in design.contacts.possible_overlaps),
    )


def _joint(joint: Joint, limits: JointRange | None) -> JointState:
    line = joint.type in ("revolute", "screw", "cylindrical")
    point = _vector(joint.point)
    return JointState(
        name=str(joint.name),
        bodies=(str(joint.bodies[0]), str(joint.bodies[1])),
        type=joint.type,
        status=joint.status,
        freedoms=joint.freedoms,
        axis=_axis(joint.axis, point if line else None),
        axis2=_axis(joint.axis2, None),
        centre=point if joint.type in ("spherical", "universal") else None,
        pitch=joint.pitch,
        range_lower=None if limits is None else _end(limits.lower, -math.inf),
        range_upper=None if limits is None else _end(limits.upper, math.inf),
        range_status="unknown" if limits is None else limits.status,
    )


def _end(end: RangeEnd, free: float) -> float | None:
    return free if end.status == "unbounded" else end.value


def _counts(design: Design) -> tuple[tuple[str, int | None], ...]:
    from kinform.reports.values.kinematics import mobility_counts

    assert design.kinematics is not None
    return tuple(mobility_counts(design.kinematics.mobility).items())


def _mass(item: MassProperties) -> BodyMass:
    entries = item.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    tensor = tuple(map(float, entries)) if np.all(np.isfinite(entries)) else None
    return BodyMass(item.name, item.mass, _vector(item.centre_of_mass), _vector(item.principal_moments), tensor)


def _overlaps(design: Design) -> tuple[tuple[tuple[str, str], float], ...]:
    assert design.contacts is not None
    deepest: dict[tuple[str, str], float] = {}
    for overlap in design.contacts.interferences:
        if not overlap.mated:
            pair = (str(overlap.parts[0]), str(overlap.parts[1]))
            deepest[pair] = max(overlap.depth, deepest.get(pair, 0.0))
    return tuple(sorted(deepest.items()))


def _axis(direction: np.ndarray | None, point: Vector | None) -> Axis | None:
    found = _vector(direction)
    return None if found is None else Axis(found, point)


def _vector(values: np.ndarray | None) -> Vector | None:
    if values is None or not np.all(np.isfinite(values)):
        return None
    x, y, z = (float(value) for value in values)
    return (x, y, z)
