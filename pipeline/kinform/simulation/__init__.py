"""Simulation: how the device moves, at the functional, kinematic or dynamic level.

Reads the port model of `kinform.behaviour`; importing it brings in neither scipy nor compiled kernels, and the solvers
only when something is solved.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from kinform.simulation.request import simulate
from kinform.simulation.settings import SolverSettings
from kinform.simulation.subject import port_model

if TYPE_CHECKING:
    from kinform.simulation.of_system import Course, simulate_system

__all__ = ["CODE_VERSION", "Course", "SolverSettings", "port_model", "simulate", "simulate_system"]

CODE_VERSION: int = 13

_SOLVED = ("Course", "simulate_system")


def __getattr__(name: str) -> Any:
    if name not in _SOLVED:
        raise AttributeError(f"module 'kinform.simulation' has no attribute {name!r}")
    return getattr(importlib.import_module("kinform.simulation.of_system"), name)
