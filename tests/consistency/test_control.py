"""`[check]` and baselines: what is selected, how severe it is, what is accepted, and nothing of it silently."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.mistakes import ignore
from support.places import FIXTURES

from kinform import form, results, stages
from kinform.consistency import adopt, check, read_baseline, verdict, verdict_of, with_baseline
from kinform.errors import InputError
from kinform.model.checks import CheckSettings
from kinform.model.contacts import Interference
from kinform.model.function import Requirement
from kinform.reports import FORMATS, render

HINGE = FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml"


@pytest.fixture
def hinge(derive_design):
    return derive_design(HINGE)


def wrong(design, depth=5e-3):
    """The design with two parts that overlap."""
    overlap = Interference(("block", "shaft"), 1e-9, depth, np.array([0.0, depth, 0]), False, "manifold")
    return replace(design, contacts=replace(design.contacts, interferences=(overlap,)))


def doubtful(design):
    """The design with a requirement that nothing decides."""
    asked = Requirement("peak", "torque", {"joint": "main", "limit": 1.0}, "m.toml", 9)
    function = replace(design.assembly.function, requirements=(asked,))
    return replace(design, assembly=replace(design.assembly, function=function))


def controlled(design, **settings):
    given = CheckSettings(file="m.toml", line=30, **settings)
    return replace(design, assembly=replace(design.assembly, check=given))


def outcome(report, code):
    return next(rule for rule in report.rules if rule.code == code)


def found(report):
    return [finding.code for finding in report.findings]


def test_only_selected_rules_run(hinge):
    report = check(controlled(wrong(hinge), select=("KF3", "joint-wrong-type")))
    ran = {rule.code for rule in report.rules if rule.outcome != "skipped"}
    assert {code[:3] for code in ran if code not in ("KF402", "KF440")} == {"KF3"}
    assert "KF402" in ran
    assert "KF201" not in found(report)
    assert outcome(report, "KF201").outcome == "skipped"


def test_rules_that_are_left_out_by_selection_are_told(hinge):
    report = check(controlled(hinge, select=("KF3",)))
    assert {"KF101", "KF201"} <= set(report.unselected)
    assert not any(code.startswith("KF3") for code in report.unselected)
    assert json.loads(render(report, hinge, "json"))["unselected"] == list(report.unselected)
    assert str(len(report.unselected)) in verdict_of(report).coverage
    assert all(s.outcome == "not checked" for s in report.statements if s.kind == "joint")
    everything = check(hinge)
    assert everything.unselected == ()
    assert "select" not in verdict_of(everything).coverage


def test_when_no_rule_runs_the_gate_does_not_pass(hinge):
    report = check(controlled(hinge, select=("KF77",)))
    assert report.ran == 0
    assert found(report) == ["KF440"]
    assert verdict(report) == 2
    nothing = check(controlled(hinge, select=("KF405",)))
    assert nothing.ran == 0
    assert verdict(nothing) == 2


def test_severities_are_overridden(hinge):
    design = wrong(hinge)
    assert verdict(check(design)) == 1
    softer = check(controlled(design, severity=(("KF201", "warning"),)))
    assert [f.severity for f in softer.findings if f.code == "KF201"] == ["warning"]
    assert verdict(softer) == 0
    assert verdict(softer, "warning") == 1
    by_name = check(controlled(design, severity=(("parts-interpenetrate", "note"),)))
    assert verdict(by_name, "warning") == 0


@pytest.mark.parametrize("subject", [None, "shaft"])
def test_an_ignored_finding_is_told_with_its_reason(hinge, subject):
    report = check(controlled(wrong(hinge), ignore=(ignore("KF201", subject, "pressed on purpose"),)))
    assert found(report) == []
    assert [(i.finding.code, i.by, i.reason) for i in report.ignored] == [("KF201", "manifest", "pressed on purpose")]
    assert outcome(report, "KF201").outcome == "ignored"
    assert verdict(report) == 0


def test_an_ignore_of_another_subject_ignores_nothing_and_is_found(hinge):
    report = check(controlled(wrong(hinge), ignore=(ignore("KF201", "lid"),)))
    assert "KF201" in found(report)
    (unused,) = (f for f in report.findings if f.code == "KF440")
    assert unused.subject == ("KF201", "lid")
    assert (unused.file, unused.line, unused.severity) == ("m.toml", 33, "warning")
    assert "KF440" in found(check(controlled(hinge, ignore=(ignore("KF201"),))))


@pytest.mark.parametrize(
    "settings", [{"select": ("KF1", "KF99")}, {"severity": (("KF999", "note"),)}, {"ignore": (ignore("KF999"),)}]
)
def test_a_code_that_does_not_exist_is_found(hinge, settings):
    assert "KF440" in found(check(controlled(hinge, **settings)))


def test_settings_that_have_an_effect_are_no_finding(hinge):
    design = controlled(
        wrong(hinge), select=("KF",), severity=(("KF201", "warning"),), ignore=(ignore("KF201", "block"),)
    )
    assert "KF440" not in found(check(design))
    assert outcome(check(hinge), "KF440").outcome == "skipped"


def test_what_is_not_decided_can_be_accepted_by_name_only(hinge):
    design = doubtful(hinge)
    assert verdict(check(design)) == 2
    by_subject = check(controlled(design, ignore=(ignore("KF902", "peak", "measured on the bench"),)))
    assert outcome(by_subject, "KF902").outcome == "ignored"
    assert verdict(by_subject) == 0
    assert verdict(check(controlled(design, ignore=(ignore("KF902", "other"),)))) == 2


def test_a_rule_of_which_something_else_is_undecided_stays_inconclusive(hinge):
    # an ignored finding does not settle what the rule could not decide at all
    design = replace(hinge, kinematics=None)
    report = check(controlled(design, ignore=(ignore("KF402", "main"),)))
    assert outcome(report, "KF402").outcome == "inconclusive"
    whole = check(controlled(design, ignore=(ignore("KF402"),)))
    assert outcome(whole, "KF402").outcome == "ignored"


def test_a_baseline_hides_what_it_adopted_whatever_the_numbers(hinge):
    baseline = read_baseline(adopt(check(wrong(hinge))).text(), "b.json")
    report, gone = with_baseline(check(wrong(hinge, depth=7e-3)), baseline)
    assert found(report) == []
    assert [i.by for i in report.ignored] == ["baseline"]
    assert not gone
    assert outcome(report, "KF201").outcome == "ignored"
    assert verdict(report) == 0


def test_a_baseline_has_no_number_but_counts(hinge):
    text = adopt(check(wrong(hinge))).text()
    (entry,) = json.loads(text)["findings"]
    assert entry == {"code": "KF201", "subject": ["block", "shaft"], "severity": "error", "count": 1}
    assert text == adopt(check(wrong(hinge, depth=6e-3))).text()


def test_what_is_new_worse_or_more_counts_beside_a_baseline(hinge):
    baseline = adopt(check(controlled(wrong(hinge), severity=(("KF201", "warning"),))))
    worse, _ = with_baseline(check(wrong(hinge)), baseline)
    assert verdict(worse) == 1
    twice = wrong(hinge)
    more = replace(twice, contacts=replace(twice.contacts, interferences=twice.contacts.interferences * 2))
    report, _ = with_baseline(check(more), adopt(check(twice)))
    assert found(report) == ["KF201", "KF201"]
    other, gone = with_baseline(check(hinge), adopt(check(twice)))
    assert gone == (("KF201", ("block", "shaft")),)
    assert verdict(other) == 0


def test_a_baseline_never_adopts_what_was_not_decided(hinge):
    report = check(doubtful(hinge))
    assert adopt(report).counts == {}
    assert verdict(with_baseline(report, adopt(report))[0]) == 2


def test_adopting_again_keeps_what_was_adopted(hinge):
    baseline = adopt(check(wrong(hinge)))
    report, _ = with_baseline(check(wrong(hinge)), baseline)
    assert adopt(report).text() == baseline.text()


@pytest.mark.parametrize(
    "text",
    ["", "[]", '{"schema": "kinform/findings/1"}', '{"schema": "kinform/baseline/1", "findings": [{"code": 1}]}',
             '{"schema": "kinform/baseline/1"}'],
)  # fmt: skip
def test_what_is_no_baseline_is_refused(text):
    with pytest.raises(InputError):
        read_baseline(text, "b.json")


CHECK = """
[check]
select = ["KF1", "KF2", "KF4"]
[check.severity]
KF201 = "warning"
[[check.ignore]]
code = "KF408"
subject = "shaft"
reason = "a dowel"
"""


def test_the_manifest_states_it_and_results_keep_it(tmp_path):
    folder = HINGE.parent
    for mesh in folder.glob("*.stl"):
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    text = HINGE.read_text() + CHECK
    (tmp_path / "m.toml").write_text(text)
    design = stages.import_(tmp_path / "m.toml")
    settings = design.assembly.check
    assert settings.select == ("KF1", "KF2", "KF4")
    assert settings.severity == (("KF201", "warning"),)
    (entry,) = settings.ignore
    assert (entry.code, entry.subject, entry.reason, entry.file) == ("KF408", "shaft", "a dowel", "m.toml")
    assert text.splitlines()[entry.line - 1] in ("[[check.ignore]]", 'code = "KF408"')
    checked = wrong(stages.check(stages.simulate(stages.mass(stages.joints(stages.contacts(design))))))
    checked = replace(checked, report=check(controlled(checked, ignore=(ignore("KF201"),))))
    results.write(checked, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5")
    assert again.assembly.check == settings
    assert again.report == checked.report


@pytest.mark.parametrize("line", ['code = "KF408"', 'code = "KF408"\nreason = " "', 'reason = "x"'])
def test_an_ignore_needs_a_code_and_a_reason(tmp_path, line):
    (tmp_path / "m.toml").write_text(f'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n[[part]]\nname = "p"\n'
                                     f"[[check.ignore]]\n{line}\n")  # fmt: skip
    with pytest.raises(InputError):
        form.load(tmp_path / "m.toml")


@pytest.mark.parametrize(
    ("select", "exit_code"),
    [(("KF4",), 2), (("KF425", "KF1"), 2), (("torque-exceeded", "KF1"), 2), (("KF428", "KF1"), 0), (("KF1",), 0)],
)
def test_what_a_selected_rule_could_not_decide_is_told_though_its_doubts_are_not_selected(hinge, select, exit_code):
    report = check(controlled(doubtful(hinge), select=select))
    assert ("KF902" in found(report)) == (exit_code == 2)
    assert verdict(report) == exit_code


def test_what_the_manifest_ignores_is_not_gone_from_the_baseline(hinge):
    adopted = adopt(check(wrong(hinge)))
    _, gone = with_baseline(check(controlled(wrong(hinge), ignore=(ignore("KF201"),))), adopted)
    assert gone == ()
    _, gone = with_baseline(check(hinge), adopted)
    assert [code for code, _ in gone] == ["KF201"]


@pytest.mark.parametrize("format", sorted(set(FORMATS) - {"junit"}))
def test_a_report_speaks_of_another_verdict_where_the_exit_code_is_another(hinge, format):
    warned = controlled(wrong(hinge), severity=(("KF201", "warning"),), select=("KF201",))
    warned = replace(warned, report=check(warned))
    levels = ("note", "warning", "error")
    assert [verdict(warned.report, level) for level in levels] == [1, 1, 0]
    note, warning, error = (render(warned.report, warned, format, fail_on=level) for level in levels)
    assert note == warning != error
