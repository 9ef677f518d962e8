"""Runs every rule on a design."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from kinform.consistency.causes.grouping import by_cause
from kinform.consistency.comparisons.answers import answer_counts
from kinform.consistency.context import Context
from kinform.consistency.control import Applied, apply, idle_ignore, is_selected, means, unused_entries
from kinform.consistency.coverage import coverage, statements
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.places import with_place
from kinform.consistency.requirements import RequirementRule
from kinform.consistency.rule import Rule
from kinform.consistency.rules import RULES
from kinform.consistency.rules.kf440_setting_without_effect import RULE as CONTROL
from kinform.consistency.rules.kf450_behaviour_differs_from_lock import RULE as LOCKED
from kinform.design import Design
from kinform.model.checks import CheckSettings
from kinform.model.findings import NOT_SELECTED, CheckReport, Finding, RuleOutcome
from kinform.requirements.answer import Margin


def check(design: Design) -> CheckReport:
    """Findings (sorted by code, subject, message) and the outcome of every rule, of what is known so far.

    Stages that a rule needs and that have not been run leave the rule inconclusive, never passed.
    """
    settings = design.assembly.check
    context = _judging(design)
    applied = {rule.code: _run(rule, context) for rule in RULES if rule is not CONTROL}
    used = [entry for run in applied.values() for entry in run.used]
    # these two speak later: of the other rules, and where a lock is given
    used += [entry for entry in settings.ignore if means(CONTROL, entry.code) or means(LOCKED, entry.code)]
    alone = all(run.outcome.outcome in ("skipped", "ignored") for run in applied.values())
    unused = tuple(unused_entries(RULES, settings, used))
    applied[CONTROL.code] = apply(CONTROL, CONTROL.outcome(replace(context, unused_settings=unused)), settings)
    rules = [applied[rule.code].outcome for rule in RULES]
    if alone:
        # a rule about the rules verifies nothing of the design
        nothing = RuleOutcome(CONTROL.code, CONTROL.name, "skipped", "no other rule ran")
        rules = [nothing if rule.code == CONTROL.code else rule for rule in rules]
    stated = statements(context, applied)
    told, members = by_cause(context, [f for run in applied.values() for f in run.findings], _again)
    return CheckReport(
        findings=tuple(sorted(told, key=_order)),
        rules=tuple(rules),
        ignored=tuple(sorted((i for run in applied.values() for i in run.ignored), key=lambda i: _order(i.finding))),
        answers=answer_counts([s.outcome for s in stated if s.kind == "joint"]),
        statements=stated,
        coverage=coverage(context, applied, RULES),
        members=tuple(sorted(members, key=_order)),
    )


def _again(design: Design, codes: Collection[str]) -> dict[str, Applied]:
    """What these rules say of another design, under `[check]`."""
    context = _judging(design)
    return {rule.code: _run(rule, context) for rule in RULES if rule.code in codes}


def margins(design: Design) -> dict[str, Margin | None]:
    """Of each stated requirement, by name, how far it is met or violated; None where that is not asked, undecided,
    or no number."""
    found = _judging(design).answers
    stated = design.assembly.function.requirements
    return {r.name: found[r].margin if r in found and found[r].state != "undecided" else None for r in stated}


def _judging(design: Design) -> Context:
    """The design with what answers its requirements."""
    settings = design.assembly.check
    judges = {r.kind: r.judge for r in RULES if isinstance(r, RequirementRule) and _judged(r, settings)}
    return Context(replace(design, kinematics=design.ranged), judges)


def amended(report: CheckReport, design: Design, outcome: Outcome) -> CheckReport:
    """The report with what a lock says (KF450) in place of what it said before, under `[check]` as all rules are."""
    settings = design.assembly.check
    context = Context(replace(design, kinematics=design.ranged))
    applied = _run(replace(LOCKED, check=lambda _: outcome), context)
    idle = [entry for entry in settings.ignore if means(LOCKED, entry.code) and entry not in applied.used]
    about = CONTROL.outcome(replace(context, unused_settings=tuple(map(idle_ignore, idle)))) if idle else decided()
    control = apply(CONTROL, about, settings)
    before = next(rule for rule in report.rules if rule.code == CONTROL.code)
    rules = {rule.code: rule for rule in report.rules} | {LOCKED.code: applied.outcome}
    if control.findings:
        rules[CONTROL.code] = replace(control.outcome, reason=before.reason)
    kept = [f for f in report.findings if f.code != LOCKED.code]
    ignored = [i for i in report.ignored if i.finding.code != LOCKED.code]
    return replace(
        report,
        findings=tuple(sorted((*kept, *applied.findings, *control.findings), key=_order)),
        rules=tuple(rules[code] for code in sorted(rules)),
        ignored=tuple(sorted((*ignored, *applied.ignored, *control.ignored), key=lambda i: _order(i.finding))),
    )


def _asked(rule: Rule, settings: CheckSettings) -> bool:
    """Whether the rule is selected, or one that it speaks for."""
    codes = (rule.code, *rule.speaks_for)
    return any(is_selected(other, settings) for other in RULES if other.code in codes)


def _judged(rule: Rule, settings: CheckSettings) -> bool:
    """Whether the rule is selected, or one that speaks for it."""
    return any(is_selected(other, settings) for other in RULES if rule.code in (other.code, *other.speaks_for))


def _run(rule: Rule, context: Context) -> Applied:
    """The rule under the settings of the manifest."""
    settings = context.assembly.check
    outcome = rule.outcome(context) if _asked(rule, settings) else skipped(NOT_SELECTED)
    findings = tuple(with_place(context, finding) for finding in outcome.findings)
    return apply(rule, replace(outcome, findings=findings), settings)


def _order(finding: Finding) -> tuple[object, ...]:
    place = finding.place or (0.0, 0.0, 0.0)
    return (finding.code, finding.subject, finding.message, place, finding.file or "", finding.line or 0)
