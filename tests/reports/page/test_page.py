"""The page without a browser: what it says, what it embeds, that nothing in a name does anything."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from support.markup import NASTY, read
from support.places import FIXTURES

from kinform import results, run, stages
from kinform.consistency.comparisons.answers import answers
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.reports.page import Scene, facts, page_html, page_summary
from kinform.reports.page.agreement import ORDER, rows
from kinform.reports.page.intended import answer_rows

pytestmark = pytest.mark.usefixtures("small_pictures")

SEEKER = FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml"
AXIS_OFF = FIXTURES / "broken" / "seeker_axis_off" / "seeker_axis_off.toml"
OVERLAPS = FIXTURES / "broken" / "seeker_gimbal_overlaps" / "seeker_gimbal_overlaps.toml"


def test_names_are_text_and_nothing_else(nasty, page_of):
    found = read(page_of(nasty))
    assert [tag for tag, _ in found.elements].count("script") == 3
    assert not {"i", "b", "x"} & {tag for tag, _ in found.elements}
    assert [tag for tag, _ in found.elements].count("h1") == 1
    assert not any(key.startswith("on") for _, attributes in found.elements for key in attributes)
    assert all((a.get("src") or "data:").startswith("data:") for _, a in found.elements)
    assert NASTY in [part["name"] for part in found.scene["parts"]]
    assert any(NASTY in text for text in found.texts)
    assert any("</script><i>because</i> --> ]]>" in text for text in found.texts)
    assert all(row.mark != "agrees" for row in rows(nasty) if "joint" in row.name)


def test_the_summary_for_pull_requests_shows_names_as_they_are(nasty):
    text = page_summary(nasty)
    assert not re.search(r"<\w", text)
    for line in text.splitlines():
        if line.startswith("|"):
            assert len(re.findall(r"(?<!\\)\|", line)) == 6, line


def test_a_heading_of_the_summary_says_what_it_is_about(derive_design):
    design = derive_design(OVERLAPS)
    headings = [line for line in page_summary(design).splitlines() if line.startswith("## ") and " KF" in line]
    told = facts.findings(design)
    assert len(headings) == len(told) > 0
    for heading, finding in zip(headings, told, strict=True):
        assert finding.code in heading
        assert heading.replace("\\", "").endswith(f": {finding.subject}")


def test_nothing_comes_from_elsewhere_and_one_program_may_run(derive_design, page_of):
    text = page_of(derive_design(SEEKER))
    assert not re.search(r"https?://|@import|url\((?!#)", text)
    found = read(text)
    (policy,) = (a["content"] for tag, a in found.elements if a.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'")
    assert "script-src 'sha256-" in policy


def test_the_same_design_gives_the_same_bytes_also_from_its_file(derive_design, page_of, tmp_path):
    design = derive_design(OVERLAPS)
    results.write(design, tmp_path / "a.h5")
    text = page_of(design)
    assert text == page_html(results.read(tmp_path / "a.h5"))
    assert len(text.encode()) < 500_000


def test_equal_meshes_are_embedded_once(derive_design, page_of):
    design = derive_design(SEEKER)
    scene = read(page_of(design)).scene
    of = {part["name"]: part["mesh"] for part in scene["parts"]}
    assert of["yaw_motor/rotor"] == of["pitch_motor/rotor"] != of["yaw_motor/stator"]
    assert len(scene["meshes"]) == len({part.mesh.digest for part in design.assembly.parts}) < len(of)


def test_a_consistent_design_agrees_in_every_row_that_states_something(derive_design):
    table = rows(derive_design(SEEKER))
    assert {row.name for row in table} >= {"mobility of the whole", "yaw", "pitch", "motion"}
    assert {row.mark for row in table if row.function} == {"agrees"}
    assert not any(row.findings for row in table)


def test_a_requirement_says_what_is_asked_and_what_was_found(colliding):
    table = {row.name: row for row in rows(colliding)}
    assert all(name in table["room to move"].function for name in ("clear", "housing", "outer_gimbal"))
    assert (table["room to move"].behaviour, table["room to move"].mark) == ("collision", "disagrees")
    assert all(word in table["payload in balance"].function for word in ("balance", "payload", "pitch", "0.0002"))
    assert table["payload in balance"].behaviour == "met"
    assert "18°" in table["field of view"].function


def test_joints_list_the_ranges_that_were_found_and_what_stops_them(colliding):
    (yaw, _) = facts.joints(colliding)
    said = dict(yaw.facts)["range"]
    assert re.search(r"-31\.\d", said) and "housing" in said and "outer_gimbal" in said
    assert dict(facts.joints(replace(colliding, simulation=None))[0].facts)["range"] == "not looked for"


def test_the_moment_of_a_collision_is_where_its_parts_touch(colliding):
    scene = Scene(colliding)
    (found,) = colliding.simulation.collisions
    (run, *_) = scene.movements
    (mark,) = run.marks
    assert (mark.time, mark.parts) == (found.time, found.parts)
    codes = [finding.code for finding in colliding.report.findings]
    focus = scene.focuses[codes.index("KF505")]
    assert (focus.movement, focus.time, focus.meeting) == (0, found.time, found.parts)
    # both ways to the first contact, along the run and along the joint, lead to the same pose
    other = scene.focuses[codes.index("KF412")]
    yaw = [scene.movements[k].at(t)["gimbal"] for k, t in ((0, found.time), (other.movement, other.time))]
    assert np.abs(yaw[0] - yaw[1]).max() < 2e-3
    # along the upright edge that touches, either may name any place
    assert (np.abs(focus.place - other.place) < [1e-3, 1e-3, 5e-3]).all()


def test_a_disagreement_is_marked_where_it_is_and_nowhere_else(derive_design):
    marks = {row.name: row.mark for row in rows(derive_design(AXIS_OFF)) if row.function}
    assert marks.pop("pitch") == "disagrees"
    assert set(marks.values()) == {"agrees"}


def test_what_no_rule_could_decide_never_agrees(tmp_path):
    source = FIXTURES / "pairs" / "revolute_collars"
    for mesh in source.glob("*.stl"):
        shutil.copy(mesh, tmp_path)
    text = (source / "revolute_collars.toml").read_text() + "range = [-30, 30]\n"
    (tmp_path / "m.toml").write_text(text)
    design = stages.joints(stages.contacts(stages.import_(tmp_path / "m.toml")))
    report = stages.check(stages.simulate(stages.mass(design))).report
    open_range = RuleOutcome("KF904", "range-not-checked", "inconclusive", "1 range not checked")
    note = Finding("KF904", "range-not-checked", "note", ("main",), "the range of joint 'main' is not checked yet")
    others = tuple(rule for rule in report.rules if rule.code != "KF904")
    held = tuple(replace(s, outcome="agrees" if s.kind == "joint" else "met") for s in report.statements)
    closed = CheckReport((), tuple(replace(rule, outcome="passed") for rule in others), statements=held)
    unknown = tuple(replace(s, outcome="undecided") if s.kind == "range" else s for s in held)
    undecided = CheckReport((note,), (*closed.rules, open_range), statements=unknown)
    (mark,) = (row.mark for row in rows(replace(design, report=closed)) if row.name == "main")
    assert mark == "agrees"
    (mark,) = (row.mark for row in rows(replace(design, report=undecided)) if row.name == "main")
    assert mark == "not decided"


def test_every_serious_finding_has_a_row(derive_design):
    for manifest in (AXIS_OFF, OVERLAPS):
        design = derive_design(manifest)
        table = rows(design)
        named = {k for row in table if row.mark in ("disagrees", "doubtful") for k in row.findings}
        assert named >= {k for k, f in enumerate(design.report.findings) if f.severity != "note"}
    assert any(row.name == "housing, outer_gimbal" for row in table)


def test_without_the_rules_nothing_agrees_and_the_page_says_so(derive_design):
    design = replace(derive_design(SEEKER), report=None)
    assert not any(row.mark == "agrees" for row in rows(design))
    assert facts.verdict_of(design).kind == "unverified"


@pytest.mark.parametrize("stage", ["import", "contacts"])
def test_a_page_is_made_of_what_is_known_so_far(stage):
    design = stages.import_(FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml")
    if stage == "contacts":
        design = stages.contacts(design)
    found = read(page_html(design))
    assert len(found.scene["parts"]) == len(design.assembly.parts)
    assert found.scene["joints"] == []


def test_a_function_without_geometry_has_a_page():
    design = stages.joints(
        stages.contacts(stages.import_(FIXTURES / "functional" / "stick_four_bar" / "stick_four_bar.toml"))
    )
    design = stages.check(stages.simulate(stages.mass(design)))
    scene = read(page_html(design)).scene
    assert scene["meshes"] == []
    assert len(scene["joints"]) == 4
    assert np.ptp([scene["low"], scene["high"]], axis=0).max() > 0


def test_the_overlap_that_is_drawn_is_the_one_that_was_measured(derive_design):
    design = derive_design(OVERLAPS)
    (shape,), (item,) = Scene(design).overlaps, design.contacts.interferences
    a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(item.volume, rel=1e-6)


def test_a_range_that_is_too_short_stands_beside_the_one_that_is_stated(colliding):
    row = next(row for row in rows(colliding) if row.name == "yaw")
    assert row.mark == "disagrees"
    assert re.search(r"-31\.\d+°", row.behaviour), row.behaviour
    assert re.search(r"-35°.* 35°", row.function), row.function


def test_what_disagrees_comes_first_and_tables_and_notes_are_folded(colliding):
    text = page_html(colliding)
    marks = re.findall(r'<tr class="([a-z-]+)">\s*<th scope="row">', text.partition('id="agreement"')[2])
    table = marks[: len(rows(colliding))]
    assert table[0] == "disagrees"
    assert table == sorted(table, key=lambda mark: ORDER.index(mark.replace("-", " ")))
    folds = re.findall(r'<details class="fold[^"]*" id="([a-z-]+)"( open)?>', text)
    assert {"agreement", "intended", "bodies", "joints", "rules"} <= {name for name, _ in folds}
    assert not any(is_open for _, is_open in folds)


def test_backticks_are_set_as_code_and_markup_within_stays_text(derive_design):
    design = derive_design(SEEKER)
    finding = Finding("KF301", "mobility-differs", "error", ("seeker",), "see `kinform show <b>` and a lone ` here")
    text = page_html(replace(design, report=CheckReport((finding,), design.report.rules)))
    assert "see <code>kinform show &lt;b&gt;</code> and a lone ` here" in text


def test_bodies_stand_with_their_colour_and_intended_joints_with_their_answer(derive_design):
    design = derive_design(AXIS_OFF)
    text = page_html(design)
    bodies = text.partition('id="panel-parts"')[2].partition("</details>")[0]
    scene = Scene(design)
    for body, colour in zip(scene.bodies, scene.colours, strict=True):
        assert re.search(
            f'style="background:{colour}"></span><button type="button" data-body="\\d+">{body.name}<', bodies
        )
    told = {answer.name: answer.answer for answer in answers(design)}
    assert {row.name: row.answer for row in answer_rows(design)} == told
    assert answer_rows(design)[0].answer == "contradicts"


def test_sliders_go_in_the_designers_sense(derive_design):
    design = derive_design(FIXTURES / "mechanisms" / "slider_crank" / "slider_crank.toml")
    function = design.assembly.function
    joints = tuple(one if one.axis is None else replace(one, axis=-one.axis) for one in function.joints)
    turned = replace(design, assembly=replace(design.assembly, function=replace(function, joints=joints)))
    one, other = ([m for m in Scene(d).movements if m.kind == "freedom"] for d in (design, turned))
    assert len(one) == len(other) > 0
    for before, after in zip(one, other, strict=True):
        assert after.ends == (-before.ends[1], -before.ends[0])
        assert np.all(np.diff(after.time) > 0.0)
        for t in (-0.7, 0.0, 0.4):
            poses, same = before.at(t), after.at(-t)
            assert all(np.abs(poses[name] - same[name]).max() < 1e-12 for name in poses)


def test_only_what_was_compared_with_a_function_is_ticked(derive_design):
    design = derive_design(SEEKER)
    assert (facts.verdict_of(design).kind, facts.verdict_of(design).sign) == ("consistent", "✓")
    nothing = replace(design.report, statements=(), coverage=replace(design.report.coverage, stated=False))
    told = facts.verdict_of(replace(design, report=nothing))
    assert (told.kind, told.sign) == ("unverified", "–")


def test_counts_of_rows_are_told_as_a_person_would(derive_design, page_of):
    found = read(page_of(derive_design(SEEKER)))
    text = " ".join(found.texts)
    assert re.search(r"\b\d+ agree\b", text)
    assert not re.search(r"\b(?!1 )\d+ (agrees|disagrees|contradicts)\b", text)


def test_a_rule_whose_findings_are_ignored_is_on_the_page(tmp_path):
    (tmp_path / "m.toml").write_text(
        'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n[[part]]\nname = "a"\n[[part]]\nname = "b"\n'
        '[function]\nmobility = 0\n[[check.ignore]]\ncode = "KF301"\nreason = "r"\n'
    )
    design = run(tmp_path / "m.toml").design
    assert "ignored" in {rule.outcome for rule in facts.rules(design)}
    assert "KF301" in page_html(design)
