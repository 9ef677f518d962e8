"""The compiled kernel closes loops by its own numbers: to the same poses as `mechanism.closing`."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import qr
from support.places import manifests
from support.port_models import DOWN, bricard, four_bars

from kinform.behaviour import flat
from kinform.behaviour.from_design import build
from kinform.mechanism.rank import factor, rank_of
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.closure import Loops, closed
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.dynamics import Dynamics

AWAY = 0.2
"""rad, or lengths: how far from the start, along its freedoms."""
OFF = 0.01
"""rad, and lengths: by how much coordinates are put off there before the loops are closed."""
MADE = {"bricard": bricard, "four-bars": lambda: four_bars(3)}
FIXTURES = [
    "four_bar", "bennett", "watt_six_bar", "stephenson_six_bar", "slider_crank", "cardan_shaft", "bricard_rectangular",
    "stewart_platform",
]  # fmt: skip


@pytest.fixture(params=[*MADE, *FIXTURES])
def dynamics(request, derive_design):
    """A mechanism with loops, as the kernel has it, in which nothing is driven."""
    if request.param in MADE:
        system = flat(MADE[request.param]().system())
    else:
        (manifest,) = [path for path in manifests() if path.stem == request.param]
        design = derive_design(manifest)
        system = flat(build(design.assembly, design.kinematics, design.mass).system)
        if any(getattr(body, "mass", 1.0) is None for body in system.bodies):
            pytest.skip("its masses are not known")
    mechanism, _ = assemble(system)
    rank = rank_of(mechanism.closure_at(mechanism.start), mechanism.scale)
    return Dynamics(mechanism, system, DOWN, Actuation(mechanism, system, with_mass=True).passive(), rank)


def test_the_kernel_and_close_find_the_same_poses(dynamics):
    """The kernel's corrections are the least by mass, those of `close` the least by coordinates: they agree where as
    many coordinates are held as the loops leave free."""
    mechanism, rng = dynamics.mechanism, np.random.default_rng(0)
    unit = np.ones((4, 4))
    unit[:3, 3] = mechanism.length
    every = np.arange(mechanism.rates)
    free = factor(mechanism.closure_at(mechanism.start), mechanism.scale, dynamics.rank).null
    for _ in range(5):
        way = free @ rng.normal(size=free.shape[1]) / mechanism.scale
        off = AWAY * way / np.abs(way).max() + OFF * rng.normal(size=mechanism.rates)
        off = mechanism.advance(mechanism.start, mechanism.scale * off)
        dynamics.place(off, np.zeros(mechanism.rates))
        q, _ = dynamics.project(0.0, off, np.zeros(mechanism.rates), 1e-13)
        assert np.abs(mechanism.gap(mechanism.poses(q), q)).max() < 1e-9
        rows = Loops(mechanism, every).equations(q[None]).jacobian[0]
        _, _, order = qr(rows, pivoting=True)
        dependent = np.sort(order[: dynamics.rank])
        beside = np.zeros(mechanism.rates)
        beside[dependent] = OFF * mechanism.scale[dependent] * rng.normal(size=len(dependent))
        found = closed(mechanism, mechanism.advance(q, beside), dependent, dynamics.rank)
        assert found.closed[0]
        # turns of a ball do not commute: of one that turns about two axes the third is held to second order
        within = OFF**2 if mechanism.balls else 1e-7
        assert np.abs((mechanism.poses(found.q[0]) - mechanism.poses(q)) / unit).max() < within
