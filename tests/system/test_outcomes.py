"""Every place that shows what became of a statement shows what the rules made of it: not checked is never met."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.places import manifests, stories

from kinform.catalog import entry_of
from kinform.consistency import RULES, check, margins, verdict_of
from kinform.consistency.comparisons.answers import ANSWERS, answer_counts
from kinform.consistency.requirements import RequirementRule
from kinform.model.coverage import STATEMENT_KINDS
from kinform.model.function import Requirement
from kinform.reports import summary
from kinform.reports.page.agreement import rows
from kinform.reports.page.intended import answer_rows
from kinform.reports.page.pull_request import page_summary
from kinform.study.work import measure

HEAVY = ("seeker_wrong_units", "scotch_yoke", "sarrus", "door_four_hinges", "stewart_platform", "ball_bearing")
"""Fixtures that take seconds each; others of their kind are quicker."""
REQUIREMENTS = ("requirement", "limit")
OF_KIND = {rule.kind: rule.code for rule in RULES if isinstance(rule, RequirementRule)}
EVERY = [
    pytest.param(m, id=f"{m.parent.name}-{m.stem}", marks=pytest.mark.slow if m.stem in HEAVY else [])
    for m in (*manifests(), *stories())
]


def said_met(design):
    """Statements that a place says are met, or agree: the place, the kinds that it speaks of, the name."""
    stated = {s.name for s in design.report.statements}
    for row in rows(design):
        if row.function and row.mark == "agrees" and row.name != "motion":
            if row.name == "mobility of the whole":
                yield "agreement", ("mobility",), design.assembly.name
            else:
                yield "agreement", STATEMENT_KINDS, row.name
        if row.behaviour == "met":
            yield "behaviour of a row", REQUIREMENTS, row.name
    for row in answer_rows(design):
        if row.answer == "agrees":
            yield "intended joints", ("joint",), row.name
    for one in summary(design, "joints")["intended"]:
        if one["answer"] == "agrees":
            yield "show joints", ("joint",), one["name"]
    for wanted in entry_of(design, "", "").requirements:
        if wanted.met:
            yield "catalog", REQUIREMENTS, wanted.name
        if measure(design, [("requirements", wanted.name)]) == (1.0,):
            yield "study", REQUIREMENTS, wanted.name
    text = page_summary(design)
    for line in text.splitlines():
        cells = line.replace("\\", "").split(" | ")
        if line.startswith("| ") and cells[-1].startswith("✓") and cells[0][2:].strip("`") in stated:
            yield "summary.md", STATEMENT_KINDS, cells[0][2:].strip("`")


@pytest.mark.parametrize("manifest", EVERY)
def test_no_place_says_more_than_the_rules(manifest, derive_design):
    design = derive_design(manifest)
    for place, kinds, name in said_met(design):
        said = [s for s in design.report.statements if s.name == name and s.kind in kinds]
        assert said and all(s.holds for s in said), (place, name)
    given = {s.name: s.outcome for s in design.report.statements if s.kind == "joint"}
    assert {row.name: row.answer for row in answer_rows(design) if given[row.name] in ANSWERS} == {
        name: outcome for name, outcome in given.items() if outcome in ANSWERS
    }
    assert answer_counts(given.values()) == design.report.answers
    whole = verdict_of(design.report)
    assert (whole.kind == "consistent") <= all(s.holds or s.outcome == "given" for s in design.report.statements)


@pytest.mark.parametrize("manifest", EVERY)
@pytest.mark.parametrize("outcome", ["undecided", "not checked"])
def test_what_was_not_decided_is_met_nowhere(manifest, outcome, derive_design):
    design = derive_design(manifest)
    statements = tuple(replace(s, outcome=outcome, reason="why") for s in design.report.statements)
    unknown = replace(design, report=replace(design.report, statements=statements, findings=()))
    assert list(said_met(unknown)) == []
    assert verdict_of(unknown.report).kind != "consistent"


@pytest.mark.parametrize("manifest", EVERY)
def test_a_statement_has_the_outcome_of_its_rules(manifest, derive_design):
    report = derive_design(manifest).report
    outcomes = {rule.code: rule.outcome for rule in report.rules}
    found = [*report.findings, *(item.finding for item in report.ignored)]
    about = {(f.code, f.subject[0]) for f in found if f.subject}
    for one in report.statements:
        if one.kind == "joint":
            wrong = any((code, one.name) in about for code in ("KF402", "KF403", "KF404"))
            assert (one.outcome == "contradicts") <= wrong
            assert (one.outcome == "agrees") <= (not wrong)
        elif one.kind == "range":
            assert (one.outcome == "violated") == (("KF412", one.name) in about)
            assert (one.outcome == "undecided") <= (("KF904", one.name) in about)
        elif one.kind == "mobility" and one.name == derive_design(manifest).assembly.name:
            words = {"passed": "met", "failed": "violated", "inconclusive": "undecided", "skipped": "not checked"}
            assert words.get(outcomes["KF301"], one.outcome) == one.outcome
        elif one.kind in ("requirement", "limit"):
            assert (one.outcome == "violated") == ((OF_KIND[one.of], one.name) in about)
            assert (one.outcome == "undecided") == (("KF902", one.name) in about)


def with_limit(design, joint):
    """The design with a limit of an effort that is asked about only where a simulation drives the joint."""
    values = {"name": "effort", "kind": "torque", "joint": joint, "max": 1.0, "when_run": True}
    limit = Requirement("effort", "torque", values, "m.toml", 1)
    function = replace(design.assembly.function, requirements=(*design.assembly.function.requirements, limit))
    return replace(design, assembly=replace(design.assembly, function=function))


def test_a_limit_that_no_simulation_asks_about_is_not_checked(derive_design):
    design = derive_design(next(m for m in manifests() if m.stem == "revolute_collars"))
    limited = with_limit(design, design.assembly.function.joints[0].name)
    limited = replace(limited, report=check(replace(limited, report=None)))
    (said,) = (s for s in limited.report.statements if s.kind == "limit")
    assert said.outcome == "not checked"
    assert "effort" not in {name for _, _, name in said_met(limited)}
    (row,) = (row for row in rows(limited) if row.name == "effort")
    assert row.mark == "not checked"
    assert margins(limited)["effort"] is None
    assert verdict_of(limited.report).kind == "no errors found" and verdict_of(design.report).kind == "consistent"
