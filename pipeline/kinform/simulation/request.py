"""What is asked of a simulation, and whether there is anything to simulate.

This much is imported wherever a simulation could be asked for; what simulates is imported only where it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.behaviour import Behaviour, build
from kinform.foundation.progress import Progress, Say
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation
from kinform.simulation.settings import Conduct, SolverSettings

__all__ = ["LEVELS", "Failures", "are_gears_ideal", "port_model", "refuse", "simulate", "simulated_joints"]

Failures = tuple[tuple[str, str], ...]
"""(subject, why)."""

LEVELS = ("functional", "kinematic", "dynamic")


def simulate(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    *,
    level: str | None = None,
    progress: Progress | None = None,
    settings: SolverSettings | None = None,
    say: Say | None = None,
    behaviour: Behaviour | None = None,
) -> Simulation:
    """Poses, joint values, efforts and energy over time, SI and radians.

    `level` goes before that of the manifest; with neither the highest that is known is taken. What
    cannot be simulated is refused with the reasons in `failures`, and a run that cannot go on keeps
    what it has; neither raises. `say` is told what takes long besides; `behaviour` is what `port_model` made of the
    same values, where that is known already. ValueError for a level that does not exist.
    """
    asked = _asked(assembly, level)
    if asked is not None and asked not in LEVELS:
        raise ValueError(f'level "{asked}": expected one of {", ".join(LEVELS)}')
    if assembly.simulation is None and level is None and not assembly.function.drives:
        return _nothing("not requested", "there is neither [simulation] nor a drive")
    from kinform.simulation.of_assembly import simulate_assembly

    chosen = settings or replace(SolverSettings(), free=assembly.tolerances.free)
    return simulate_assembly(assembly, kinematics, mass, asked, behaviour, Conduct(chosen, progress, say))


def port_model(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, *, level: str | None = None
) -> Behaviour:
    """The port model that `simulate` solves at that level, whatever is wrong with it."""
    asked = _asked(assembly, level)
    joints = simulated_joints(assembly, kinematics, asked)
    return build(assembly, joints, mass, gears=are_gears_ideal(assembly, asked))


def _asked(assembly: Assembly, level: str | None) -> str | None:
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
    return _nothing("refused", f"{reason}: {subject}: {why}", failures)


def _nothing(status: str, reason: str, failures: Failures = ()) -> Simulation:
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
