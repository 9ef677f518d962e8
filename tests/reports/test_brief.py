"""What is told by default: on one screen, the worst nearest the prompt, and nothing left unsaid."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.hostile import DESIGN, REPORT
from support.places import FIXTURES

from kinform.consistency import verdict_of
from kinform.foundation.escapes import one_line
from kinform.foundation.words import shortened
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.reports import as_json, concise, full, github, render

LONG = "waveshare_mounting_plate_of_the_second_arm_v2"


def finding(code, severity, *subject, found="0.66 mm deep, 141.1 mm³"):
    return Finding(code, "parts-interpenetrate", severity, subject or ("housing", "shaft"), "they overlap", found)


def report(*findings, undecided=0, skipped=0):
    codes = sorted({f.code for f in findings})
    rules = [RuleOutcome(code, "parts-interpenetrate", "failed") for code in codes]
    rules += [RuleOutcome(f"KF8{k:02}", "not-known", "inconclusive", "nobody knows") for k in range(undecided)]
    rules += [RuleOutcome(f"KF7{k:02}", "not-asked", "skipped", "not asked") for k in range(skipped)]
    return CheckReport(tuple(sorted(findings, key=lambda f: f.code)), tuple(rules))


def brief(told, width=80):
    return render(told, DESIGN, "brief", width=width).splitlines()


def numbers(line):
    return [int(number) for number in re.findall(r"\d+", line)]


def heads(lines):
    return [m[1] for line in lines if (m := re.match(r"(error|not decided|warning|note): ", line))]


def test_the_verdict_comes_first_and_the_worst_last():
    told = report(
        finding("KF201", "error"), finding("KF202", "warning"), finding("KF304", "note"), undecided=1, skipped=3
    )
    lines = brief(told)
    assert lines[0].startswith(f"{DESIGN.assembly.name}: ")
    assert numbers(lines[1])[:3] == [1, 1, 1]  # errors, warnings, notes
    assert heads(lines) == ["note", "warning", "not decided", "error"]
    assert [numbers(line) for line in lines if line.startswith("skipped:")] == [[3]]


@pytest.mark.parametrize(("severity", "told"), [("note", False), ("warning", True)])
def test_redundancy_that_every_planar_loop_has_is_said_by_verbose_and_json_alone(severity, told):
    made = report(finding("KF303", severity, "loop"))
    for short in (brief(made), concise.render(made, DESIGN).splitlines(), github.render(made, DESIGN).splitlines()):
        assert any("KF303" in line for line in short) == told
    assert "KF303" in full.render(made, DESIGN)
    assert "KF303" in as_json.render(made, DESIGN)


def test_many_findings_of_one_rule_do_not_hide_another_and_the_rest_is_counted():
    told = report(
        *(finding("KF201", "error", f"part{k}", "plate") for k in range(30)),
        finding("KF499", "error", "lonely"),
        finding("KF204", "warning"),
    )
    lines = brief(told)
    assert any("KF499" in line and "lonely" in line for line in lines)
    assert sum("part" in line and "plate" in line for line in lines) == 6
    (rest,) = (line for line in lines if "(-v " in line)
    assert numbers(rest) == [25, 1, 204, 24, 201]


def test_notes_take_a_line_for_each_rule():
    lines = brief(report(*(finding("KF105", "note", f"part{k}") for k in range(6)), finding("KF107", "note", "jaw")))
    assert [line for line in lines if line.startswith("note: ")] == [
        "note: KF105 parts-interpenetrate: part0 and 5 more",
        "note: KF107 parts-interpenetrate: jaw",
    ]


@pytest.mark.parametrize("width", [60, 80, 120])
@given(
    names=st.lists(st.text("ab_~/", min_size=1, max_size=60), min_size=1, max_size=3),
    found=st.text("a b.,", max_size=90),
    severities=st.lists(st.sampled_from(["error", "warning", "note"]), min_size=1, max_size=14),
)
def test_no_line_is_wider_than_it_may_be(width, names, found, severities):
    told = report(
        *(finding(f"KF{200 + k % 7}", severity, *names, found=found) for k, severity in enumerate(severities))
    )
    assert max(map(len, brief(told, width))) <= width


def test_ten_rules_of_one_finding_each_fit_on_a_screen():
    told = report(*(finding(f"KF{210 + k}", "error", LONG, LONG + "2") for k in range(10)), skipped=40)
    assert len(brief(told)) <= 21


def test_a_name_is_shortened_in_its_middle_and_keeps_both_ends():
    short = shortened(LONG, 20)
    assert len(short) == 20 and short.startswith("waveshare") and short.endswith("_arm_v2") and "…" in short
    assert shortened("shaft", 20) == "shaft"


def test_what_was_assumed_is_said(derive_design):
    from support.places import FIXTURES

    design = derive_design(FIXTURES / "pairs/planar_block/planar_block.toml")
    bare = replace(design, assembly=replace(design.assembly, ground=None))
    ground = next(body.name for body in design.kinematics.bodies if body.ground)
    more = set(render(bare.report, bare, "brief").splitlines()) - set(
        render(design.report, design, "brief").splitlines()
    )
    assert any(ground in line for line in more)


def test_the_verdict_and_its_coverage_come_first():
    verdict = verdict_of(REPORT)
    text = " ".join(" ".join(render(REPORT, DESIGN, "brief").split()).split("; 5 rules")[:1])
    assert text.startswith(f"{DESIGN.assembly.name}: {verdict.line} {one_line(verdict.coverage)} 1 error")


def test_what_was_found_is_whole_before_names_and_before_more_findings():
    joint = "base_motor_holder_so101_v1~waveshare_mounting_plate_so101_v2"
    found = "2 of 9 patches (4.8 % of the contact) forbid it"
    warnings = [finding(f"KF20{k}", "warning", joint, found=found) for k in range(3, 9)]
    lines = brief(report(*(finding("KF201", "error", LONG, LONG) for _ in range(9)), *warnings))
    assert not any(line.endswith("…") for line in lines)
    tight = brief(report(*warnings))
    assert " ".join(" ".join(tight).split()).count(found) == 6


def test_many_joints_without_a_function_are_told_how_they_get_fewer(derive_design):
    design = derive_design(FIXTURES / "mechanisms" / "stewart_platform" / "stewart_platform.toml")
    function = replace(design.assembly.function, joints=(), complete=())
    bare = replace(design, assembly=replace(design.assembly, function=function))
    text = " ".join(render(report(), bare, "brief").split())
    many = len(design.kinematics.joints)
    (told,) = re.findall(rf"\b{many} joints between {len(design.assembly.parts)} parts", text)
    complete = replace(bare, assembly=replace(bare.assembly, function=replace(bare.assembly.function, complete=("",))))
    assert told not in " ".join(render(report(), complete, "brief").split())
