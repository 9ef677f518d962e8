"""What a newcomer's manifests meet: loose pins that carry a driven joint, screw jacks with a stated coupling."""

from __future__ import annotations

from pathlib import Path

import pytest
from generators.solids import bore, box, cut, join, rod
from support.manifests import manifest, stated_joint

from kinform import stages
from kinform.consistency import check
from kinform.errors import InputError
from kinform.foundation.words import length
from kinform.model.findings import Finding
from kinform.reports.phrases import place


def checked(path: Path):
    """The report on what the meshes say."""
    return check(stages.joints(stages.contacts(stages.import_(path))))


def test_a_drive_through_a_loose_pin_is_undecided_not_wrong(tmp_path):
    bars = {
        name: cut(box(-10, 60, -10, 10, z, z + 6), bore(3.05, z, z + 6, 48))
        for name, z in (("base", 0.0), ("arm", 6.1))
    }
    pin = join(rod(5, -2.05, -0.05, 48), rod(3, -0.05, 12.15, 48), rod(5, 12.15, 14.15, 48))
    path = manifest(
        tmp_path, bars | {"pin": pin},
        f"""
[function]
mobility = 1
{stated_joint("swing", ("base", "arm"), "revolute")}
[[function.drive]]
joint = "swing"
kind = "effort"
law = {{type = "constant", value = 1}}
""",
    )  # fmt: skip
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    report = stages.check(stages.simulate(design, ranges=False)).report
    assert not [f for f in report.findings if f.code in ("KF401", "KF402", "KF409")]
    assert [f.subject for f in report.findings if f.code == "KF501"] == [("swing",)]
    (rule,) = (rule for rule in report.rules if rule.code == "KF409")
    assert rule.outcome == "inconclusive"


@pytest.mark.parametrize(("ratio", "code"), [(2 / 360, None), (-2 / 360, "KF411"), (4 / 360, "KF411")])
def test_the_coupling_of_a_screw_with_what_it_lifts(tmp_path, ratio, code):
    """Left-handed, 2 mm a turn: as the nut turns back against the spindle, the table rises 2 mm."""
    column = box(40, 48, -6, 6, 0, 90)
    parts = {
        "base": join(cut(box(-30, 60, -20, 20, -20, 0), bore(5.05, -20, 0, 64)), column),
        "spindle": join(rod(5, -30, 30, 64), rod(8, 30, 40, 64), rod(4, 40, 50.1, 64), rod(6, 50.1, 53, 64)),
        "table": cut(
            box(-20, 60, -20, 20, 40.05, 50), bore(4.05, 40.05, 50, 64), box(39.95, 48.05, -6.05, 6.05, 39, 51)
        ),
    }
    path = manifest(
        tmp_path, parts,
        f"""
[[assume]]
between = ["base", "spindle"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = -2
reason = "not modelled"
{stated_joint("thread", ("spindle", "base"), "screw")}pitch = -2
{stated_joint("lift", ("base", "table"), "prismatic")}
[[function.coupling]]
joints = ["lift", "thread"]
ratio = {ratio!r}
""",
    )  # fmt: skip
    report = checked(path)
    assert [f.code for f in report.findings if f.code in ("KF411", "KF903")] == ([code] if code else [])


def test_places_are_free_of_rounding_errors():
    finding = Finding("KF000", "a-rule", "note", ("part",), "text", place=(0.0766, -2.4e-19, 0.013))
    assert place(finding, "mm") == "(76.6, 0, 13) mm"


@pytest.mark.parametrize("units", ["um", "mm", "cm", "m", "in", "ft"])
@pytest.mark.parametrize("scale", [1e-5, 1e-2, 2.0])
def test_a_place_has_the_unit_in_which_messages_show_such_a_length(units, scale):
    finding = Finding("KF000", "a-rule", "note", ("part",), "text", place=(scale, 0.0, 0.0))
    told = place(finding, units)
    assert told is not None
    value, unit = length(scale, units, 6).split()
    assert told.split(") ")[1] == unit
    size = {"um": 1e-6, "mm": 1e-3, "m": 1.0, "in": 0.0254, "ft": 0.3048}[unit]
    for shown in (float(value), float(told[1:].split(",")[0])):
        assert shown * size == pytest.approx(scale, abs=1e-4 * size)


def test_a_step_that_would_fill_the_memory_is_refused_with_its_line(tmp_path):
    path = manifest(tmp_path, {"block": box(0, 1, 0, 1, 0, 1)}, "[simulation]\nduration = 2\nstep = 1e-9\n")
    with pytest.raises(InputError) as caught:
        stages.import_(path)
    (problem,) = caught.value.problems
    assert problem.line == 10


@pytest.mark.parametrize(("part", "outcome"), [("slider", "passed"), ("rail", "inconclusive")])
def test_a_load_on_the_ground_is_not_verified(tmp_path, part, outcome):
    rail = join(box(-60, 60, -15, 15, -5, 0), box(-60, 60, -15, -10, -1, 10), box(-60, 60, 10, 15, -1, 10))
    text = f'[function]\nload = [{{part = "{part}", force = [1, 0, 0]}}]\n[simulation]\nduration = 0.01\n'
    parts = {"rail": rail, "slider": box(-20, 25, -10, 10, 0, 8)}
    path = manifest(tmp_path, parts, text, more='material = "steel"\n', ground="rail")
    design = stages.mass(stages.joints(stages.contacts(stages.import_(path))))
    design = stages.check(stages.simulate(design))
    assert design.simulation.level == "dynamic"
    assert next(rule.outcome for rule in design.report.rules if rule.code == "KF905") == outcome
    found = [f for f in design.report.findings if f.code == "KF905"]
    assert [f.found for f in found] == (["without effect"] if part == "rail" else [])
    assert all(f.place is not None and "load" in path.read_text().splitlines()[f.line - 1] for f in found)


def test_a_load_on_a_group_is_carried_as_one_on_its_parts(tmp_path):
    rail = join(box(-60, 60, -15, 15, -5, 0), box(-60, 60, -15, -10, -1, 10), box(-60, 60, 10, 15, -1, 10))
    parts = {"rail": rail, "slider": box(-20, 25, -10, 10, 0, 8), "lid": box(-20, 25, -10, 10, 8, 12)}
    group = '[[group]]\nname = "carriage"\nparts = ["slider", "lid"]\n'
    moved = {}
    for named in ("carriage", "slider"):
        (tmp_path / named).mkdir()
        text = f'{group}[function]\nload = [{{part = "{named}", force = [1, 0, 0]}}]\n[simulation]\nduration = 0.1\n'
        path = manifest(tmp_path / named, parts, text, more='material = "steel"\n', ground="rail")
        design = stages.simulate(stages.mass(stages.joints(stages.contacts(stages.import_(path)))))
        assert design.simulation.level == "dynamic"
        moved[named] = design.simulation.joint_position[-1, 0]
    # a frictionless slide: 1 N on both together for 0.1 s
    mass = sum(p.mass for p in design.mass.parts if p.name != "rail")
    assert abs(moved["carriage"]) == pytest.approx(0.5 / mass * 0.1**2, rel=1e-6)
    assert moved["carriage"] == pytest.approx(moved["slider"], rel=1e-9)
