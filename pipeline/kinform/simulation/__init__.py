"""Simulation: how the device moves, at the functional, kinematic or dynamic level.

Reads the port model of `kinform.behaviour`; importing it brings in neither scipy nor compiled kernels.
"""

from __future__ import annotations

from kinform.simulation.settings import SolverSettings
from kinform.simulation.simulate import modelled, simulate
from kinform.simulation.solve import Course, simulate_system

__all__ = ["CODE_VERSION", "Course", "SolverSettings", "modelled", "simulate", "simulate_system"]

CODE_VERSION: int = 8
