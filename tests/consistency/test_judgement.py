"""The verdict claims what was verified, and says in one line what was not."""

from __future__ import annotations

import json
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.hostile import DESIGN

from kinform.consistency import verdict, verdict_of
from kinform.consistency.judgement import CODES, UNKNOWN
from kinform.model.coverage import STATEMENT_KINDS, STATEMENT_OUTCOMES, Coverage, Statement
from kinform.model.findings import CheckReport, Finding, Ignored, RuleOutcome
from kinform.reports import render

PASSED = RuleOutcome("KF402", "joint-wrong-type", "passed")
DOUBT = RuleOutcome("KF902", "requirement-not-checked", "inconclusive", "1 requirement not decided")
STATED = Coverage(stated=True, joints=3, joints_understood=3, contacts=3, contacts_understood=3)


def joints(*outcomes):
    return tuple(Statement("joint", f"j{k}", outcome) for k, outcome in enumerate(outcomes))


def report(*statements, coverage=STATED, findings=(), rules=(PASSED,), **more):
    return CheckReport(findings, rules, statements=statements, coverage=coverage, **more)


def finding(code, severity="error", *subject):
    return Finding(code, "some-rule", severity, subject or ("j0",), "it is wrong")


@pytest.mark.parametrize("kind", STATEMENT_KINDS)
@pytest.mark.parametrize("outcome", STATEMENT_OUTCOMES)
def test_consistent_is_only_what_states_something_and_has_all_of_it_decided(kind, outcome):
    alone = verdict_of(report(Statement(kind, "x", outcome)))
    beside = verdict_of(report(Statement(kind, "x", outcome), *joints("agrees")))
    holds = outcome in ("agrees", "not held", "met")
    assert alone.kind == ("consistent" if holds else "no errors found")
    assert beside.kind == ("consistent" if holds or outcome == "given" else "no errors found")
    assert alone.code == beside.code == 0


def test_nothing_stated_is_never_consistent():
    assert verdict_of(report(coverage=Coverage(stated=False))).kind == "no errors found"
    assert verdict_of(report(coverage=None)).kind == "no errors found"


def test_how_many_joints_are_decided_stands_in_the_verdict():
    told = verdict_of(report(*joints(*["agrees"] * 17, "undecided", "no contact", "undecided")))
    assert told.kind == "no errors found" and "17 of 20 joints" in told.line


def test_limits_that_nobody_looked_at_are_not_checked():
    limits = [Statement("limit", f"{of} {k}", "not checked", "why", of) for of in ("torque", "speed") for k in "ab"]
    told = verdict_of(report(*joints("agrees"), *limits))
    assert (told.kind, told.code) == ("no errors found", 0)
    assert "4 limits not checked" in told.line
    assert "2 effort limits and 2 speed limits not checked: why" in told.coverage


def test_what_is_accepted_is_not_called_consistent():
    wrong = finding("KF402", "error", "j0")
    ignored = Ignored(wrong, "manifest", "glued")
    told = verdict_of(report(*joints("contradicts", "agrees"), ignored=(ignored,)))
    assert told.code == 0 and told.kind == "no errors found"
    assert "accepted" in told.line and "1 finding ignored" in told.coverage


def test_failures_say_what_failed_and_how_many_joints_match():
    told = verdict_of(report(*joints("agrees", "contradicts"), findings=(finding("KF101"), finding("KF402"))))
    assert (told.kind, told.code) == ("inconsistent", 1)
    assert told.line.startswith("FAILED: 1 mesh error, 1 joint error") and "1 of 2 joints" in told.line


def test_settings_that_narrow_the_rules_are_said():
    rules = (PASSED, RuleOutcome("KF101", "mesh", "skipped", "not selected by [check]"))
    told = verdict_of(report(*joints("agrees"), coverage=replace(STATED, lowered=("KF201",)), rules=rules))
    assert "KF101" in told.coverage and "KF201 lowered to note" in told.coverage


OPEN = {
    "interpretations": replace(STATED, interpretations=("a~b",)),
    "several": replace(STATED, several=("a",)),
    "fused": replace(STATED, fused=("a~b",)),
}


@pytest.mark.parametrize("what", OPEN)
def test_strict_asks_for_what_geometry_leaves_open(what):
    lax = report(*joints("agrees"), coverage=OPEN[what])
    assert verdict(lax) == 0 and verdict_of(lax).open
    assert verdict(replace(lax, strict=True)) == 2
    assert verdict(replace(report(*joints("agrees")), strict=True)) == 0


def test_strict_asks_for_undecided_joints_and_for_the_origin():
    undecided = report(*joints("agrees", "undecided"))
    assert (verdict(undecided), verdict(replace(undecided, strict=True))) == (0, 2)
    strange = replace(report(*joints("agrees")), origin="unknown")
    assert UNKNOWN in verdict_of(strange).line
    assert (verdict(strange), verdict(replace(strange, strict=True))) == (0, 2)
    failing = replace(strange, strict=True, findings=(finding("KF402"),))
    assert verdict(failing) == 1


def test_limits_not_checked_are_fine_for_the_strict():
    limit = Statement("limit", "x", "not checked", "no simulation requested", "torque")
    assert verdict(replace(report(*joints("agrees"), limit), strict=True)) == 0


statements = st.builds(
    Statement,
    st.sampled_from(STATEMENT_KINDS),
    st.sampled_from(["j0", "j1", "r"]),
    st.sampled_from(STATEMENT_OUTCOMES),
    st.just("because"),
    st.sampled_from(["", "torque", "retained"]),
)
reports = st.builds(
    CheckReport,
    st.lists(st.sampled_from(["note", "warning", "error"]).map(lambda s: finding("KF402", s)), max_size=2).map(tuple),
    st.sampled_from([(PASSED,), (PASSED, DOUBT), ()]),
    statements=st.lists(statements, max_size=4).map(tuple),
    coverage=st.sampled_from([None, Coverage(stated=False), STATED, *OPEN.values()]),
    origin=st.sampled_from(["recorded", "unknown"]),
    strict=st.booleans(),
)


@given(reports, st.sampled_from(["error", "warning", "note"]))
def test_every_reader_says_the_same(told, fail_on):
    one = verdict_of(told, fail_on)
    assert one.code == CODES[one.kind] == verdict(told, fail_on)
    if one.kind == "consistent":
        assert told.coverage is not None and told.coverage.stated
        assert all(s.holds or s.outcome == "given" for s in told.statements)
    for format in ("concise", "github", "full", "brief", "md"):
        text = " ".join(render(told, DESIGN, format, fail_on=fail_on).replace("\\", "").split())
        assert one.line in text
        assert one.coverage in text
    found = json.loads(render(told, DESIGN, "json", fail_on=fail_on))
    assert (found["verdict"], found["verdict_line"], found["exit_code"]) == (one.word, one.line, one.code)
    assert found["coverage"]["line"] == one.coverage and found["coverage"]["open"] == list(one.open)
    log = json.loads(render(told, DESIGN, "sarif", fail_on=fail_on))["runs"][0]["properties"]
    assert (log["verdict"], log["verdictLine"], log["coverage"]) == (one.word, one.line, one.coverage)
    (suite,) = ElementTree.fromstring(render(told, DESIGN, "junit", fail_on=fail_on))
    named = {p.get("name"): p.get("value") for p in suite.iter("property")}
    assert named["verdict"] == one.line and named.get("coverage", "") == one.coverage
    counts = {tag: len(list(suite.iter(tag))) for tag in ("failure", "error")}
    assert one.code == (1 if counts["failure"] else 2 if counts["error"] else 0)
