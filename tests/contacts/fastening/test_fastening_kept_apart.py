"""Suggestions never join what the manifest keeps apart, by whatever chain; and axes are not inferred against it."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.assemblies import intended
from support.copies import derived as design_of
from support.places import FIXTURES
from support.solids import box, rod
from support.suggestions import found, made_of

from kinform import kinematics, stages
from kinform.consistency import check
from kinform.contacts import find
from kinform.kinematics.joints.bodies.kept_apart import Apart, contradicted
from kinform.model.contacts import Suggestion
from kinform.surfaces import recover

ELBOW = FIXTURES / "wild" / "elbow_in_groups" / "elbow_in_groups.toml"


def bodies(design):
    return sorted(body.parts for body in design.kinematics.bodies)


def changed(tmp_path, change):
    """The elbow with another manifest."""
    for file in ELBOW.parent.glob("*.stl"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    path = tmp_path / "elbow.toml"
    path.write_text(change(ELBOW.read_text()))
    return path


def without_groups(text):
    return re.sub(r"\[\[group\]\]\nname.*\nparts.*\n", "", text).replace('ground = "frame"', 'ground = "bracket"')


STATED = """
[[function.joint]]
name = "elbow"
between = ["servo", "lever"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
"""


def test_without_groups_suggestions_join_all(tmp_path):
    """The temptation is real: nothing but the groups stands against it."""
    whole = max(bodies(design_of(changed(tmp_path, without_groups))), key=len)
    assert {"bracket", "servo", "lever", "strap"} <= set(whole)


def test_a_stated_joint_keeps_the_chain_through_a_third_part_from_closing(tmp_path):
    design = design_of(changed(tmp_path, lambda text: without_groups(text) + STATED))
    assert ("strap",) in bodies(design)
    assert ("bracket", "servo") in bodies(design), "what leads nowhere else is applied"
    assert design.kinematics.body_of("lever") is not design.kinematics.body_of("servo")


def test_each_suggestion_that_was_refused_is_reported():
    design = stages.simulate(stages.mass(design_of(ELBOW)))
    notes = [f.subject for f in check(design).findings if f.code == "KF906"]
    assert sorted(notes) == [("lever", "servo"), ("lever", "strap"), ("servo", "strap")]


def hint(first, second):
    return Suggestion((min(first, second), max(first, second)), "holes", "", np.zeros(3), np.zeros(3))


def reached(start, pairs):
    """All that hangs together with a node."""
    known = {start}
    while grown := {b for a, b in (*pairs, *((b, a) for a, b in pairs)) if a in known} - known:
        known |= grown
    return known


pairs_of_six = st.lists(st.sampled_from(list(itertools.combinations("abcdef", 2))), unique=True)


@settings(max_examples=50, deadline=None)
@given(pairs_of_six, pairs_of_six)
def test_a_suggestion_is_refused_exactly_if_it_lies_on_a_way_between_two_that_are_kept_apart(suggested, kept):
    hints = [hint(*pair) for pair in suggested]
    refused = contradicted(hints, [Apart(pair, "") for pair in kept], lambda part: part)
    left = [pair for index, pair in enumerate(suggested) if index not in refused]
    assert all(b not in reached(a, left) for a, b in kept)
    for index in refused:
        a, b = suggested[index]
        assert any(on_a_way(a, b, p, q, suggested) for p, q in kept)


def on_a_way(a, b, p, q, pairs):
    """Whether a simple path from p to q uses the edge a–b, by trying all paths."""

    def paths(node, seen):
        if node == q:
            yield seen
            return
        for x, y in pairs:
            other = y if x == node else x if y == node else None
            if other is not None and other not in seen:
                yield from paths(other, (*seen, other))

    steps = [set(step) for path in paths(p, (p,)) for step in itertools.pairwise(path)]
    return {a, b} in steps


def horn_and_bracket():
    return {"horn": rod(12, 0, 4, 72) - rod(3, -1, 6), "bracket": box(-20, 20, -20, 20, -5, 0) - rod(4, -6, 1)}


@pytest.mark.parametrize("kind", ["fixed", "planar", "prismatic"])
def test_no_axis_is_inferred_where_something_else_is_stated(kind):
    _, plain = found(np.eye(4), infer=True, **horn_and_bracket())
    assert [joint.type for joint in plain.joints] == ["revolute"]
    _, derived = found(np.eye(4), infer=True, joints=[intended("x", "bracket", "horn", kind)], **horn_and_bracket())
    assert [(joint.type, joint.status) for joint in derived.joints] == [("planar", "determined")]


def test_an_axis_that_is_stated_too_is_inferred():
    _, derived = found(np.eye(4), infer=True, joints=[intended("x", "bracket", "horn")], **horn_and_bracket())
    assert [(joint.type, joint.status) for joint in derived.joints] == [("revolute", "inferred")]


def test_no_axis_is_inferred_inside_a_body_that_is_stated_in_two_steps():
    """Horn and bracket are each fixed to a plate beside them, which no contact shows."""
    solids = horn_and_bracket() | {"plate": box(40, 50, -20, 20, -5, 0)}
    joints = [intended("a", "horn", "plate", "fixed"), intended("b", "bracket", "plate", "fixed")]
    _, derived = found(np.eye(4), infer=True, joints=joints, **solids)
    assert [(joint.type, joint.status) for joint in derived.joints] == [("planar", "determined")]


def sled():
    """A tongue in the groove of a rail, and two hooks that are drawn at the ends of both."""
    rail = box(-30, 30, -10, 10, -10, 0) - box(-31, 31, -4, 4, -6, 1)
    tongue = box(-20, 20, -4, 4, -6, 6)
    right = box(20, 34, -4, 4, 1, 6) + box(30, 34, -4, 4, -8, 2)
    return {"rail": rail, "tongue": tongue, "hook_a": right.mirror((1, 0, 0)), "hook_b": right}


@pytest.mark.parametrize("stated", [True, False])
def test_nothing_is_joined_by_contact_that_follows_from_suggestions(stated):
    """With both hooks on the tongue it cannot slide: so the hooks are not the tongue's where it shall slide."""
    along = replace(intended("slide", "rail", "tongue", "prismatic"), axis=np.array([1.0, 0.0, 0.0]))
    joints = [along] if stated else []
    made = made_of(np.eye(4), infer=True, joints=joints, **sled())
    recovered = {p.mesh.digest: recover(p.mesh, made.tolerances) for p in made.parts}
    touching = find(made, recovered)
    chain = tuple(hint("tongue", name) for name in ("hook_a", "hook_b"))
    derived = kinematics.derive(made, recovered, replace(touching, suggestions=chain))
    assert (derived.body_of("rail") is derived.body_of("tongue")) is not stated
    assert (derived.body_of("hook_a") is derived.body_of("tongue")) is not stated
