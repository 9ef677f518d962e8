"""Simulation: how the device moves, at the functional, kinematic or dynamic level.

Reads the port model of `kinform.behaviour`; importing it brings in neither scipy nor compiled kernels, and the solvers
only when something is solved.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from kinform.simulation.modelled import modelled
from kinform.simulation.simulate import simulate
from kinform.simulation.solver.settings import SolverSettings

if TYPE_CHECKING:
    from kinform.simulation.solver.solution import Course, simulate_system

__all__ = ["CODE_VERSION", "Course", "SolverSettings", "modelled", "simulate", "simulate_system"]

CODE_VERSION: int = 8

_SOLVING = ("Course", "simulate_system")


def __getattr__(name: str) -> Any:
    if name not in _SOLVING:
        raise AttributeError(f"module 'kinform.simulation' has no attribute {name!r}")
    return getattr(importlib.import_module("kinform.simulation.solver.solution"), name)
