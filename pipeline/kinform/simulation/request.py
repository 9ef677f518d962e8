"""Whether a simulation is asked for, and at which level.

This much is imported wherever one could be asked for; what simulates is imported only where one is.
"""

from __future__ import annotations

from dataclasses import replace

from kinform.behaviour import Behaviour
from kinform.foundation.progress import Progress, Say
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation, SimulationLevel
from kinform.simulation.settings import Conduct, SolverSettings
from kinform.simulation.subject import asked_level, nothing

LEVELS: tuple[SimulationLevel, ...] = ("functional", "kinematic", "dynamic")


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
    asked = asked_level(assembly, level)
    if asked is not None and asked not in LEVELS:
        raise ValueError(f'level "{asked}": expected one of {", ".join(LEVELS)}')
    wanted = next((one for one in LEVELS if one == asked), None)
    if assembly.simulation is None and level is None and not assembly.function.driven:
        return nothing("not requested", "there is neither [simulation] nor a drive")
    from kinform.simulation.assembly_simulation import simulate_assembly

    chosen = settings or replace(SolverSettings(), free=assembly.tolerances.free)
    return simulate_assembly(assembly, kinematics, mass, wanted, behaviour, Conduct(chosen, progress, say))
