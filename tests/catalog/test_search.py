"""Designs that do the same as another one."""

from __future__ import annotations

import dataclasses
import json
import math
import random
import shutil

import numpy as np
import pytest
from support.command_line import ran_here
from support.places import FIXTURES

from kinform import catalog, results
from kinform.catalog.entry import CatalogJoint, Entry, graph_of


def entry(path: str, joints: list[CatalogJoint], size: float = 1.0, graph: str = "g") -> Entry:
    return Entry(path, "0" * 64, path, "m", (), 3, 2, None, 2, 0, 0, None, (size, size, size), None, tuple(joints), (),
                 graph)  # fmt: skip


def joint(name: str, axis, point) -> CatalogJoint:
    unit = tuple(float(v) for v in np.array(axis) / np.linalg.norm(axis))
    return CatalogJoint(
        name, "revolute", "determined", 1, unit, tuple(map(float, point)), None, None, None, None, None, None
    )


def test_a_graph_is_the_same_however_bodies_are_numbered():
    edges = [("revolute", 0, 1), ("prismatic", 1, 2), ("revolute", 2, 3), ("revolute", 3, 0), ("spherical", 3, 4)]
    grounds = [True, False, False, False, False]
    whole = graph_of(grounds, edges)
    for seed in range(20):
        order = list(range(5))
        random.Random(seed).shuffle(order)
        moved = [(kind, *sorted((order[a], order[b]))) for kind, a, b in edges]
        assert graph_of([grounds[order.index(k)] for k in range(5)], moved) == whole
    assert graph_of([False, True, False, False, False], edges) != whole
    assert graph_of(grounds, [("prismatic", 0, 1), *edges[1:]]) != whole
    assert graph_of(grounds, [*edges[:4], ("spherical", 2, 4)]) != whole


def test_copies_are_alike_however_they_are_placed_and_large():
    first = [joint("a", (0, 0, 1), (0, 0, 0)), joint("b", (0, 1, 1), (0.3, 0.2, 0)), joint("c", (0, 0, 1), (0.5, 0, 0))]
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    moved = [joint(j.name, turn @ j.axis, turn @ np.array(j.point) + (5, 6, 7)) for j in reversed(first)]
    assert catalog.distance(entry("x", first), entry("y", moved)) == pytest.approx(0.0, abs=1e-5)
    twice = [joint(j.name, j.axis, 2 * np.array(j.point)) for j in first]
    assert catalog.distance(entry("x", first), entry("y", twice, 2.0)) == pytest.approx(1.0, abs=1e-5)


def test_axes_that_turn_away_are_less_alike():
    def apart(degrees: float) -> float:
        turned = [math.sin(math.radians(degrees)), 0.0, math.cos(math.radians(degrees))]
        start = [joint("a", (0, 0, 1), (0, 0, 0)), joint("b", (0, 0, 1), (0, 1, 0))]
        return catalog.distance(entry("x", start), entry("y", [start[0], joint("b", turned, (0, 1, 0))]))

    assert apart(0.0) == 0.0 and 0.0 < apart(5.0) < apart(30.0) < apart(80.0)


def test_the_command_names_the_nearest_first(tmp_path, derive_design):
    designs = tmp_path / "designs"
    designs.mkdir()
    for name, manifest in {
        "hinge": "pairs/revolute_collars/revolute_collars.toml",
        "cone": "pairs/revolute_cone/revolute_cone.toml",
        "block": "pairs/planar_block/planar_block.toml",
    }.items():
        results.write(derive_design(FIXTURES / manifest), designs / f"{name}.h5")
    shutil.copy(designs / "hinge.h5", tmp_path / "mine.h5")
    assert ran_here("catalog", "add", "designs", "-q", cwd=tmp_path).returncode == 0
    ran = ran_here("catalog", "find", "--like", "mine.h5", "--format", "json", cwd=tmp_path)
    found = [one["path"] for one in json.loads(ran.stdout)["designs"]]
    assert found[0] == "designs/hinge.h5" and "designs/block.h5" not in found
    ran = ran_here("catalog", "find", "--like", "mine.h5", "--mobility", "1", cwd=tmp_path)
    assert ran.returncode == 2 and "alone" in ran.stderr


def test_a_catalog_gives_back_what_was_written(tmp_path):
    one = entry("a", [joint("a", (0, 0, 1), (0, 0, 0))])
    catalog.write(catalog.Catalog((), (one, dataclasses.replace(one, path="b", graph="h"))), tmp_path / "c.sqlite")
    assert catalog.read(tmp_path / "c.sqlite").entries[1].graph == "h"
    assert [e.path for _, e in catalog.like(tmp_path / "c.sqlite", one)[0]] == ["a"]


def test_what_is_no_results_of_joints_is_told_with_the_command_that_makes_them(tmp_path):
    catalog.write(catalog.Catalog(), tmp_path / "catalog.sqlite")
    (tmp_path / "arm.urdf").write_text('<robot name="r"><link name="arm"/></robot>')
    ran = ran_here("catalog", "find", "--like", "arm.urdf", cwd=tmp_path)
    assert ran.returncode == 2 and "kinform run arm.urdf -o arm.h5" in ran.stderr
    assert ran_here("import", "arm.urdf", "-o", "arm.h5", cwd=tmp_path).returncode == 0
    ran = ran_here("catalog", "find", "--like", "arm.h5", cwd=tmp_path)
    assert ran.returncode == 2 and "arm.h5: error: " in ran.stderr and "kinform joints" in ran.stderr
