"""Simulation of the port model: functional, kinematic, dynamic."""

from kinform.simulation.simulate import simulate

__all__ = ["CODE_VERSION", "simulate"]

CODE_VERSION: int = 1
