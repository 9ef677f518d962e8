"""Runs of designs without looking for what their parts meet, which takes longer than the motion."""

from __future__ import annotations

from dataclasses import replace

from kinform import simulation
from kinform.design import Design


def moved(design: Design, level: str | None = None) -> Design:
    """The design with its simulation, and neither ranges of joints nor collisions."""
    made, joints, masses = design.assembly, design.kinematics, design.mass
    behaviour = simulation.port_model(
        made, joints, masses, level=level, contacts=design.contacts, surfaces=design.surfaces
    )
    run = simulation.simulate(made, joints, masses, level=level, behaviour=behaviour)
    return replace(design, simulation=run, behaviour=behaviour)
