"""Depths, gaps and ways of solids of which they are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly
from support.solids import block, part

from kinform.design import Design
from kinform.foundation.boundary import Boundary
from kinform.model.findings import Finding, Witness, between, free_way
from kinform.replays import replay
from kinform.replays.files import Files
from kinform.replays.geometric import Sides

APART = np.eye(4)
APART[2, 3] = 0.05
DESIGN = Design(assembly(part("low", block(40, 40, 20), np.eye(4)), part("high", block(10, 10, 20), APART)))
"""Two boxes, 30 mm apart along z."""


@pytest.fixture
def sides(tmp_path):
    return Sides(DESIGN, Files(tmp_path, Boundary(tmp_path / "m.toml")))


def state(sides, witness):
    return replay(Finding("KF000", "made-up", "error", ("a",), "wrong", witness=witness), sides).state


@pytest.mark.parametrize(("lifted", "gap"), [(0.0, 0.03), (-0.01, 0.02), (0.4, 0.43)])
def test_a_gap_is_measured(sides, lifted, gap):
    witness = between(["low"], ["high"], gap, moved=[0, 0, 0, 0, 0, lifted])
    assert state(sides, witness) == "holds"
    for factor in (0.9, 1.1):
        assert state(sides, replace(witness, gap=factor * gap)) == "does not hold"


def test_a_depth_and_a_volume_are_measured(sides):
    witness = between(["low"], ["high"], -0.003, moved=[0, 0, 0, 0, 0, -0.033], volume=0.01 * 0.01 * 0.003)
    assert state(sides, witness) == "holds"
    assert state(sides, replace(witness, gap=-0.001)) == "does not hold"
    assert state(sides, replace(witness, volume=2.0 * witness.volume)) == "does not hold"
    assert state(sides, replace(witness, moved=None)) == "does not hold"


def test_a_way_that_is_free_is_one_that_ends_outside_and_meets_nothing(sides):
    assert state(sides, free_way(["low"], ["high"], [0, 0, 1], 0.1)) == "holds"
    assert state(sides, free_way(["low"], ["high"], [0, 0, -1], 0.1)) == "does not hold"
    assert state(sides, free_way(["low"], ["high"], [0, 0, -1], 0.035)) == "does not hold"
    assert state(sides, free_way(["low"], ["high"], [1, 0, 0], 0.1, after=[0, 0, -0.05])) == "does not hold"


@pytest.mark.parametrize(
    "wrong",
    [
        Witness("geometric"),
        between(["low"], ["nobody"], 0.1),
        between([], [], 0.1),
        between(["low"] * 5000, ["high"] * 5000, 0.1),
        replace(between(["low"], ["high"], 0.03), moved=(np.nan,) * 6),
        replace(between(["low"], ["high"], 0.03), moved=(1e308,) * 6),
        replace(between(["low"], ["high"], 0.03), gap=np.inf),
        Witness("geometric", twist=(0.0,) * 6, step=(0.0, 1.0), first=("low",), second=("high",)),
        Witness("geometric", twist=(np.nan,) * 6, step=(-1.0, 1.0), depth=(1.0, 1.0), parts_back=("low", "high"),
                parts_ahead=("low", "high")),
    ],
)  # fmt: skip
def test_what_no_finder_gives_is_no_proof(sides, wrong):
    assert state(sides, wrong) != "holds"
