"""The drawing of the kinematic graph: whole, legible, escaped, and the same each time."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from kinform.exports.graph.drawing import graph_dot, graph_svg
from kinform.exports.graph.layout import box_centres
from kinform.kinematics.joints.pair.joint import stated_joint
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.model.kinematics import Body, ConstraintMatrix, Freedom, Kinematics, Misfit, Mobility, Redundancy

SVG = "{http://www.w3.org/2000/svg}"
ODD = ['a"b', "<script>&", "back\\slash", "line\nbreak", "ein sehr langer Name – Ø"]


def kinematics(names, edges, *, statuses=(), drivers=(), held=()):
    """A graph of hinges; `names` sorted, the first is ground."""
    bodies = tuple(Body(name, (name,), k == 0) for k, name in enumerate(names))
    joints = []
    for n, (a, b) in enumerate(edges):
        form = JointForm("revolute", np.array([0.0, 0, 1]), np.zeros(3))
        joint = stated_joint((names[a], names[b]), form, "test", "test")
        joints.append(joint if n >= len(statuses) else type(joint)(**(vars(joint) | {"status": statuses[n]})))
    zero, none = np.zeros(0), np.zeros(0, dtype=np.int64)
    matrix = ConstraintMatrix((), zero, none, np.zeros(1, dtype=np.int64), none, none, np.zeros(3), 1.0)
    named = tuple(
        Freedom(joints[n].name, names[edges[n][1]], "turn", np.array([0.0, 0, 1]), np.zeros(3), 0.0, False, False, ())
        for n in drivers
    )
    redundancies = tuple(
        Redundancy("loop", "", rows, tuple(joints[n].name for n in members), (), (), np.zeros((0, 6)))
        for members, rows in held
    )
    empty = np.zeros((0, len(names), 6))
    mobility = Mobility(len(named), None, len(named), 0, 0, 0, empty, (), (), named=named, redundancies=redundancies)
    return Kinematics(bodies, tuple(joints), matrix, mobility, Misfit())


@cache
def four_bar_ring():
    return kinematics(
        ["base", "crank", "coupler", "rocker"], [(0, 1), (1, 2), (2, 3), (0, 3)], drivers=[0], held=[([0, 1, 2, 3], 3)]
    )


def texts(svg):
    return ["".join(item.itertext()) for item in ET.fromstring(svg).iter(f"{SVG}text")]


def test_every_body_and_joint_is_drawn_once():
    root = ET.fromstring(graph_svg(four_bar_ring()))
    labels = texts(graph_svg(four_bar_ring()))
    assert [labels.count(name) for name in ("base", "crank", "coupler", "rocker")] == [1] * 4
    assert len(list(root.iter(f"{SVG}circle"))) == len([t for t in labels if t == "R"]) == 4
    assert len([line for line in root.iter(f"{SVG}line") if line.get("class") == "joint"]) == 4


def test_ground_is_hatched_and_a_redundant_loop_is_numbered_with_its_rows():
    svg = graph_svg(four_bar_ring())
    assert svg.count('class="ground"') == 1
    (rows,) = (text.removeprefix("↻ 1:") for text in texts(svg) if text.startswith("↻ 1:"))
    assert "↻ 1" in texts(svg) and "3" in rows


def test_ambiguous_joints_are_dashed_and_blocked_ones_dotted_in_both_formats():
    drawn = kinematics(["a", "b", "c", "d"], [(0, 1), (1, 2), (2, 3)], statuses=["ambiguous", "blocked", "determined"])
    lines = [e for e in ET.fromstring(graph_svg(drawn)).iter(f"{SVG}line") if e.get("class") == "joint"]
    assert len({line.get("stroke-dasharray") for line in lines}) == 3
    assert [line.get("stroke-dasharray") is None for line in lines] == [False, False, True]
    dot = graph_dot(drawn)
    assert dot.count("style=dashed") == 1 and dot.count("style=dotted") == 1


def test_odd_names_stay_text():
    drawn = kinematics(ODD, [(k, k + 1) for k in range(4)])
    labels = texts(graph_svg(drawn))
    for name in ODD:
        assert name.replace("\n", "\\n") in labels
    statements = graph_dot(drawn).splitlines()
    assert len(statements) == 3 + 5 + 4
    for statement in statements[2:-1]:
        unquoted = re.sub(r'"(?:[^"\\]|\\.)*"', "", statement)
        assert re.fullmatch(r"[\s\w=,;\[\]-]*", unquoted), statement


def test_the_drawing_is_the_same_each_time():
    assert graph_svg(four_bar_ring()) == graph_svg(four_bar_ring())
    assert graph_dot(four_bar_ring()) == graph_dot(four_bar_ring())


def test_assemblies_without_joints_are_drawn():
    assert "no joints" in graph_svg(kinematics(["alone"], []))


@pytest.mark.parametrize("seed", range(4))
def test_boxes_do_not_overlap(seed):
    rng = np.random.default_rng(seed)
    nodes = 30
    edges = [(int(rng.integers(k)), k) for k in range(1, nodes)] + [(k, k + 7) for k in range(0, 20, 5)]
    sizes = np.stack([rng.uniform(40, 160, nodes), np.full(nodes, 30.0)], axis=1)
    at = box_centres(sizes, edges, 0, 105.0)
    for k in range(nodes):
        for n in range(k):
            assert (np.abs(at[k] - at[n]) >= 0.5 * (sizes[k] + sizes[n])).any()


def test_a_ring_is_drawn_round():
    nodes = 8
    at = box_centres(np.full((nodes, 2), 30.0), [(k, (k + 1) % nodes) for k in range(nodes)], 0, 105.0)
    radius = np.linalg.norm(at - at.mean(axis=0), axis=1)
    assert radius.min() > 0.8 * radius.max()


def test_parts_that_nothing_connects_are_drawn_beside():
    at = box_centres(np.full((4, 2), 30.0), [(0, 1), (2, 3)], 0, 105.0)
    assert at[2:, 0].min() > at[:2, 0].max() + 30.0


FOUR_BAR = Path(__file__).parents[3] / "fixtures" / "mechanisms" / "four_bar" / "four_bar.toml"


def test_the_summary_of_a_four_bar_names_its_freedom_and_its_redundancy(derive_design):
    from kinform.reports import summary

    found = summary(derive_design(FOUR_BAR), "mobility")
    (freedom,), (loop,) = found["named"], found["redundancies"]
    assert (freedom["body"] in freedom["text"], freedom["kind"]) == (True, "turn")
    assert np.abs(freedom["axis"]) == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    assert sorted(freedom["moves"]) == sorted(set(found["bodies"]) - {"base"})
    assert (loop["rows"], len(loop["wrenches"]), found["gruebler"]) == (3, 3, -2)
