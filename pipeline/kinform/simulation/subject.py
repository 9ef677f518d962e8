"""What is simulated of an assembly: its joints and its port model, or nothing and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.behaviour import Behaviour, build
from kinform.model.assembly import Assembly
from kinform.model.collisions import JointRange
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation, SimulationStatus
from kinform.model.surfaces import MeshSurfaces

Failures = tuple[tuple[str, str], ...]
"""(subject, why)."""


def port_model(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    *,
    level: str | None = None,
    contacts: Contacts | None = None,
    surfaces: Mapping[str, MeshSurfaces] | None = None,
    reach: Sequence[JointRange] = (),
) -> Behaviour:
    """The port model that `simulate` solves at that level, whatever is wrong with it; `reach`: how far joints go."""
    asked = asked_level(assembly, level)
    joints = simulated_joints(assembly, kinematics, asked)
    gears = are_gears_ideal(assembly, asked)
    return build(assembly, joints, mass, gears=gears, contacts=contacts, surfaces=surfaces, reach=reach)


def asked_level(assembly: Assembly, level: str | None) -> str | None:
    """The level asked for, by the caller or else by the manifest; None where the highest that is known is wanted."""
    return level or (assembly.simulation.level if assembly.simulation else None)


def simulated_joints(assembly: Assembly, kinematics: Kinematics, asked: str | None) -> Kinematics:
    """The joints that are simulated: those of geometry, or of the function where that level is asked for."""
    if asked != "functional":
        return kinematics
    from kinform.kinematics import functional

    return functional(assembly)


def are_gears_ideal(assembly: Assembly, asked: str | None) -> bool:
    """Whether drives and couplings act through ideal gears: where joints are those of the function."""
    return asked == "functional" or all(part.mesh is None for part in assembly.parts)


def refuse(reason: str, failures: Failures) -> Simulation:
    """Nothing is simulated, and why."""
    subject, why = failures[0]
    return nothing("refused", f"{reason}: {subject}: {why}", failures)


def nothing(status: SimulationStatus, reason: str, failures: Failures = ()) -> Simulation:
    """A simulation in which nothing ran."""
    none = np.zeros((0, 0))
    return Simulation(
        status=status,
        reason=reason,
        level="",
        time=np.zeros(0),
        body_names=(),
        p_WB=np.zeros((0, 0, 3)),
        q_WB=np.zeros((0, 0, 4)),
        joint_names=(),
        joint_types=(),
        joint_offset=np.zeros(1, dtype=np.int64),
        joint_position=none,
        joint_velocity=none,
        joint_effort=none,
        energy=np.zeros((0, 3)),
        residual=np.zeros(0),
        rank=np.zeros(0, dtype=np.int64),
        assumptions=(),
        failures=failures,
    )
