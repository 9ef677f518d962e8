"""Simulation: how the device moves, at the functional, kinematic or dynamic level.

Reads the port model of `kinform.behaviour`; importing it brings in neither scipy nor compiled kernels, and the solvers
only when something is solved.

Sub-packages; each imports only those above it:

- `kernel`: single steps, as loops over numbers, compiled or not
- `mechanism`: a port model in joint coordinates
- `outcome`: reactions, balances, results
- `solver`: a run through time, from event to event
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes
from kinform.simulation.request import simulate
from kinform.simulation.settings import SolverSettings
from kinform.simulation.subject import port_model

if TYPE_CHECKING:
    from kinform.simulation.outcome.sensing import Probe
    from kinform.simulation.spectra import Spectrum, amplitude_spectrum, envelope
    from kinform.simulation.system_simulation import Course, simulate_system

__all__ = [
    "CODE_VERSION", "Course", "Probe", "SolverSettings", "Spectrum", "amplitude_spectrum", "envelope", "port_model",
    "simulate", "simulate_system",
]  # fmt: skip

CODE_VERSION: int = 36
"""Bumped when results of this package change for the same input."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "Course": "system_simulation", "Probe": "outcome.sensing", "simulate_system": "system_simulation",
        "Spectrum": "spectra", "amplitude_spectrum": "spectra", "envelope": "spectra",
    },
)  # fmt: skip
