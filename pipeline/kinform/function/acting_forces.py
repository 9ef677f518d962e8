"""What is stated that acts by forces: without dynamics it does nothing."""

from __future__ import annotations

from kinform.model.assembly import Assembly
from kinform.model.function import Function


def acting_by_force(function: Function) -> list[str]:
    """Drives, loads and springs of which a motion without forces knows nothing, in words."""
    out = sorted({f"{drive.kind} on {drive.joint}" for drive in function.drives if drive.kind != "motion"})
    out += sorted({f"load on {load.part}" for load in function.loads})
    return out + sorted({spring.name for spring in function.springs})


def needing_forces(assembly: Assembly) -> list[str]:
    """The same with what else only dynamics can answer: initial velocities, and losses of gears."""
    started = () if assembly.simulation is None else assembly.simulation.initial
    out = acting_by_force(assembly.function)
    out += [f"initial velocity of {value.joint}" for value in started if value.velocity != 0.0]
    return out + [f"efficiency of {' and '.join(c.joints)}" for c in assembly.function.couplings if c.lossy]
