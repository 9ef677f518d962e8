"""What `diff` and a lock say of designs that were made, derived and changed in one known way."""

from __future__ import annotations

import dataclasses
import json
import math
import re

import numpy as np
import pytest
from generators.solids import Solid, box, join
from support.manifests import manifest

from kinform import stages
from kinform.changes import compare, compare_designs, read_lock, render, snapshot, with_lock, write_lock
from kinform.consistency import verdict


def drawer(folder, stop=50.0, extra="", material='material = "steel"\n', long=25.0):
    """A slider of 45 × 20 × 8 mm (x, y, z) in a rail along x, between a stop at -50 mm and one at `stop`."""
    folder.mkdir()
    rail = [box(-60, 60, -15, 15, -5, 0), box(-60, 60, -15, -10, -1, 10), box(-60, 60, 10, 15, -1, 10)]
    ends = [box(-55, -50, -11, 11, -1, 10), box(stop, stop + 5, -11, 11, -1, 10)]
    parts = {"rail": join(*rail, *ends), "slider": box(-20, long, -10, 10, 0, 8)}
    return derived(manifest(folder, parts, extra, more=material))


def derived(path):
    """The design with its findings, ranges computed."""
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    return stages.check(stages.simulate(design, ranges=True))


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    return drawer(tmp_path_factory.mktemp("drawer") / "before")


@pytest.fixture(scope="module")
def shorter(tmp_path_factory):
    return drawer(tmp_path_factory.mktemp("drawer") / "shorter", stop=46.0)


def test_a_stop_that_was_moved_is_a_change_of_the_range(before, shorter):
    changes = compare(snapshot(before), snapshot(shorter)).changes
    (found,) = (change for change in changes if change.kind == "range")
    assert found.amount == pytest.approx(-4e-3, abs=4e-6)
    assert compare(snapshot(before), snapshot(before)).code == 0


def test_a_lock_keeps_the_range_and_says_where_it_differs(before, shorter):
    text = write_lock(snapshot(before))
    (joint,) = json.loads(text)["joints"]
    assert joint["range"]["mm"] == pytest.approx([-30.0, 25.0], abs=0.01)
    report = with_lock(shorter.report, shorter, read_lock(text, "b.json"))
    (found,) = (f for f in report.findings if f.code == "KF450" and f.subject == (joint["name"],))
    assert f'"name": "{joint["name"]}"' in text.splitlines()[found.line - 1]
    assert all(f.place is not None for f in report.findings if f.code == "KF450" and f.subject[0] in text)
    assert verdict(report) == 1
    unranged = dataclasses.replace(before, simulation=dataclasses.replace(before.simulation, ranges=None))
    (rule,) = (r for r in with_lock(before.report, unranged, read_lock(text, "b.json")).rules if r.code == "KF450")
    assert rule.outcome == "inconclusive"
    old = read_lock(write_lock(snapshot(unranged)), "o.json")
    (note,) = (f for f in with_lock(before.report, before, old).findings if f.code == "KF450")
    assert note.severity == "note"
    assert verdict(with_lock(before.report, before, old)) == verdict(before.report)


@pytest.mark.parametrize(
    ("settings", "outcome", "code"),
    [
        ("", "failed", 1),
        ('[check]\nseverity = {KF450 = "note"}\n', "passed", 0),
        ('[[check.ignore]]\ncode = "KF450"\nreason = "the stop is being moved"\n', "ignored", 0),
        ('[check]\nselect = ["KF1"]\n', "skipped", 0),
    ],
    ids=["", "severity", "ignore", "select"],
)
def test_the_manifest_controls_what_a_lock_says_as_any_other_rule(tmp_path, before, settings, outcome, code):
    lock = read_lock(write_lock(snapshot(before)), "b.json")
    design = drawer(tmp_path / "new", stop=46.0, extra=settings)
    report = with_lock(design.report, design, lock)
    assert next(rule.outcome for rule in report.rules if rule.code == "KF450") == outcome
    assert verdict(report) == code
    assert not [f for f in report.findings if f.code == "KF440"]


def test_an_ignore_of_the_lock_that_ignores_nothing_is_a_finding_where_a_lock_is_given(tmp_path, before):
    lock = read_lock(write_lock(snapshot(before)), "b.json")
    said = '[[check.ignore]]\ncode = "KF450"\nsubject = "nobody"\nreason = "long ago"\n'
    design = drawer(tmp_path / "new", extra=said)
    assert not [f for f in design.report.findings if f.code == "KF440"]
    report = with_lock(design.report, design, lock)
    (found,) = (f for f in report.findings if f.code == "KF440")
    assert found.subject == ("KF450", "nobody")
    assert next(rule.outcome for rule in report.rules if rule.code == "KF440") == "failed"


def test_a_block_that_is_turned_about_its_centre_of_mass_has_changed(tmp_path):
    # the block lies flat on the plate either way: same joint, mass, centre of mass, and principal moments
    plate = box(-60, 60, -60, 60, -5, 0)
    made = []
    for name, block in (("along", box(-30, 30, -10, 10, 0, 8)), ("across", box(-10, 10, -30, 30, 0, 8))):
        (tmp_path / name).mkdir()
        made.append(
            derived(manifest(tmp_path / name, {"plate": plate, "block": block}, "", more='material = "steel"\n'))
        )
    one, two = map(snapshot, made)
    assert [(c.kind, c.subject) for c in compare(one, two).changes] == [("inertia-axes", ("block",))]
    report = with_lock(made[1].report, made[1], read_lock(write_lock(one), "b.json"))
    assert [f.subject for f in report.findings if f.code == "KF450"] == [("block",)]


def test_the_cause_is_named_first_and_each_value_once(before, tmp_path):
    after = drawer(tmp_path / "longer", stop=46.0, long=27.0)
    found = compare_designs(before, after)
    assert {cause.part: cause.kind for cause in found.causes} == {"rail": "part-shape", "slider": "part-shape"}
    assert [sorted(cause.part for cause in group.causes) for group in found.groups if len(group.causes) == 1]
    (ends,) = (change for change in found.changes if change.kind == "range")
    assert ends.amount == pytest.approx(-6e-3, abs=6e-6)
    lines = render(found, "full").splitlines()
    assert lines[0].startswith("rail ")
    assert sum(re.search(r"\b25\b", line) is not None for line in lines) == 1
    shown = json.loads(render(found, "json"))
    every = sorted(k for group in shown["groups"] for k in group["changes"])
    assert every == list(range(len(shown["changes"])))


def test_a_part_that_moved_is_told_alike_by_its_pose_and_by_its_mesh(tmp_path):
    shaft, block = box(-5, 5, -5, 5, 0, 60), box(20, 60, -20, 20, 0, 60)
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    one = derived(manifest(tmp_path / "a", {"shaft": shaft, "block": block}, ""))
    by_mesh = derived(manifest(tmp_path / "b", {"shaft": shaft, "block": box(21, 61, -20, 20, 0, 60)}, ""))
    path = next((tmp_path / "a").glob("*.toml"))
    text = path.read_text()
    path.write_text(text.replace('name = "block"', 'name = "block"\nposition = [1, 0, 0]'))
    by_pose = derived(path)
    for after in (by_mesh, by_pose):
        (cause,) = compare_designs(one, after).causes
        assert (cause.kind, cause.part) == ("part-moved", "block")
        assert cause.X[:3, 3] == pytest.approx([1e-3, 0, 0])
    path.write_text(text.replace('name = "block"', 'name = "block"\nrpy = [0, 0, 2]'))
    (cause,) = compare_designs(one, derived(path)).causes
    assert np.trace(cause.X[:3, :3]) == pytest.approx(1.0 + 2.0 * math.cos(math.radians(2)))
    assert compare_designs(one, one).causes == ()


def test_what_follows_from_a_part_is_told_of_it_by_whatever_name_the_function_has(tmp_path):
    guide = (
        '[[group]]\nname = "carriage"\nparts = ["slider", "knob"]\n[function]\nmobility = 1\n[[function.joint]]\n'
        'name = "guide"\nbetween = ["rail", "carriage"]\ntype = "prismatic"\naxis = [1, 0, 0]\n'
    )
    rail = join(box(-60, 60, -15, 15, -5, 0), box(-60, 60, -15, -10, -1, 10), box(-60, 60, 10, 15, -1, 10))
    parts = {"rail": rail, "slider": box(-20, 25, -10, 10, 0, 8), "knob": box(-5, 5, -5, 5, 8, 20)}
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    one = derived(manifest(tmp_path / "a", parts, guide))
    narrow = {**parts, "slider": box(-20, 25, -6, 6, 0, 8)}
    found = compare_designs(one, derived(manifest(tmp_path / "b", narrow, guide)))
    assert {change.subject[0] for change in found.changes} >= {"KF301", "KF414", "carriage~rail"}
    assert all(group.causes for group in found.groups)
    del parts["knob"]
    (tmp_path / "c").mkdir()
    bare = derived(manifest(tmp_path / "c", parts, guide.replace(', "knob"', "")))
    found = compare_designs(one, bare)
    (group,) = (g for g in found.groups if any(c.kind == "body-parts" for c in g.changes))
    assert [(cause.kind, cause.part) for cause in group.causes] == [("part-gone", "knob")]


def test_equal_parts_with_other_names_in_their_places_are_renamed(tmp_path):
    block = box(0, 60, 0, 20, 0, 10)
    made = []
    for k, names in enumerate((("pin_1", "pin_2"), ("dowel_a", "dowel_b"))):
        folder = tmp_path / str(k)
        folder.mkdir()
        pins = {name: box(10 + 30 * i, 16 + 30 * i, 5, 11, 10, 25) for i, name in enumerate(names)}
        path = manifest(folder, {"block": block, **pins}, "")
        one = path.read_text().replace(f"{names[1]}.stl", f'{names[0]}.stl"\nposition = [30, 0, 0]\n#')
        path.write_text(one)
        made.append(derived(path))
    found = compare_designs(*made)
    assert {(c.before, c.after) for c in found.changes if c.kind == "part-renamed"} == {
        ("pin_1", "dowel_a"), ("pin_2", "dowel_b"),
    }  # fmt: skip
    assert found.causes == () and {c.kind for c in found.changes} == {"part-renamed"}


def test_other_facets_are_no_other_shape_and_another_frame_no_motion(tmp_path):
    coarse = box(-20, 25, -10, 10, 0, 8)
    fine = join(box(-20, 3, -10, 10, 0, 8), box(3, 25, -10, 10, 0, 8), box(1, 5, -3, 3, 2, 5))
    longer = box(-20, 27, -10, 10, 0, 8)
    seen = {}
    for name, solid, place in (
        ("was", coarse, ""),
        ("fine", Solid(fine.manifold.refine(2), fine.volume), ""),
        ("longer elsewhere", longer.at(-100.0, 0.0, 0.0), "position = [100, 0, 0]\n"),
        ("longer and moved", longer, "position = [100, 0, 0]\n"),
    ):
        (tmp_path / name).mkdir()
        seen[name] = derived(manifest(tmp_path / name, {"block": solid}, "", more=place))
    told = {
        name: [cause.kind for cause in compare_designs(seen["was"], design).causes] for name, design in seen.items()
    }
    assert told["was"] == []
    assert told["fine"] == ["part-facets"]
    assert told["longer elsewhere"] == ["part-shape"]
    assert told["longer and moved"] == ["part-moved", "part-shape"]
