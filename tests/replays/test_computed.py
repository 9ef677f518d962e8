"""Equations beside closed forms, and numbers that no finder gives."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly
from support.solids import block, part

from kinform.design import Design
from kinform.foundation.boundary import Boundary
from kinform.model.findings import Finding, computed
from kinform.replays import replay
from kinform.replays.computed import EQUATIONS
from kinform.replays.files import Files
from kinform.replays.geometric import Sides

CUBE = assembly(part("cube", block(20, 20, 20), np.eye(4)))


@pytest.fixture
def sides(tmp_path):
    return Sides(Design(CUBE), Files(tmp_path, Boundary(tmp_path / "m.toml")))


def outcome(sides, witness):
    return replay(Finding("KF000", "made-up", "error", ("a",), "wrong", witness=witness), sides)


WEIGHTS = {"densities": [1000.0], "masses": [0.0], "centres": [0.0] * 3, "inertias": [0.0] * 9}


@pytest.mark.parametrize(
    ("equation", "residual", "inputs", "parts"),
    [
        ("angle of directions", math.pi / 6, {"found": [1, 0, 0], "meant": [-math.sqrt(3), 1, 0]}, ()),
        ("distance of points", 5.0, {"found": [3, 0, 0], "meant": [0, 4, 0]}, ()),
        ("lead of a twist", 0.001, {"twist": [0, 0, 1, 0, 0, 0.002 / (2 * math.pi)], "meant": 0.003}, ()),
        ("impossible inertia", 1 / 3, {"inertia": np.diag([1.0, 1.0, 3.0])}, ()),
        ("mass of shapes", 0.003, WEIGHTS | {"most": 0.005}, ("cube",)),
        ("inertia about a line", 0.008 * 0.0004 / 6 - 1e-7, WEIGHTS | {"axis": [0, 0, 1], "most": 1e-7}, ("cube",)),
        ("imbalance about a line", 0.008 * 0.1, WEIGHTS | {"axis": [0, 0, 1], "point": [0.1, 0, 5]}, ("cube",)),
        ("density of the hull", 1e6, {"mass": 8.0}, ("cube",)),
        ("freedoms of twists", 1.0, {"twists": [[1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 1], [2, 0, 0, 0, 0, 1]]}, ()),
        ("share of a curve", 2.0, {"speeds": [0, 10], "efforts": [4, 0], "speed": 10, "effort": 4}, ()),
        ("work of weights", 2.0, {
            "gravity": [0, 0, -10], "masses": [1], "centres": [[0.2, 0, 0]], "motions": [[0, 1, 0, 0, 0, 0]],
            "loads": [[0] * 6], "springs": 0}, ()),
    ],
)  # fmt: skip
def test_a_closed_form_is_recomputed(sides, equation, residual, inputs, parts):
    witness = computed(equation, residual, 1e-12, parts=parts, **inputs)
    assert outcome(sides, witness).state == "holds"
    assert outcome(sides, replace(witness, residual=1.01 * residual)).state == "does not hold"


@pytest.mark.parametrize("equation", sorted(EQUATIONS))
@pytest.mark.parametrize(
    "inputs",
    [
        None,
        {},
        dict.fromkeys(("found", "meant", "points", "normals", "bodies", "masses", "times"), ()),
        dict.fromkeys(("found", "mass", "edge"), (math.nan, math.inf)),
        dict.fromkeys(("found", "meant", "twist", "edge", "screws", "facet", "inertia", "links"), (0.0,) * 6),
        dict.fromkeys(("found", "meant", "mass", "terms", "spans", "axis", "output", "column"), (1e308,) * 3),
        {"terms": (1.0,) * 200_000},
    ],
)
def test_numbers_that_no_finder_gives_are_no_proof(sides, equation, inputs):
    witness = replace(computed(equation, 1.0, 0.5, parts=["cube", "nobody"]), inputs=inputs)
    assert outcome(sides, witness).state != "holds"


def test_an_unknown_equation_is_not_replayed(sides):
    witness = replace(computed("distance of points", 1.0, 0.5), equation="__import__")
    assert outcome(sides, witness).state == "not replayed"


def test_freedoms_of_a_planar_four_bar_are_counted_without_loops(sides):
    points = [(0.0, 0, 0), (0.0, 0.1, 0), (0.3, 0.2, 0), (0.3, 0, 0)]
    twists = [[0, 0, 1, y, -x, 0] for x, y, _ in points]
    inputs = {
        "bodies": 4, "ground": 0, "edges": [(0, 1), (1, 2), (2, 3), (3, 0)], "counts": [1] * 4, "twists": twists,
        "idle": 0, "lost": 0, "ends": (1, 1), "meant": 2,
    }  # fmt: skip
    assert outcome(sides, computed("freedoms of a graph", 1.0, 0.0, **inputs)).state == "holds"
    assert outcome(sides, computed("freedoms of a graph", 2.0, 0.0, **inputs)).state == "does not hold"
