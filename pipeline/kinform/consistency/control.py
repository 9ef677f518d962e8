"""Applies `[check]`: which rules run, how severe their findings are, what is ignored, and what had no effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from kinform.consistency.context import Unused
from kinform.consistency.outcome import Outcome
from kinform.consistency.profiles import SETTLED, at_most
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.model.checks import CheckSettings, Ignore
from kinform.model.findings import Finding, Ignored, RuleOutcome

DOUBT = "KF9"
"""Rules that have one finding for each thing that could not be decided."""


@dataclass(frozen=True)
class Applied:
    """One rule under `[check]`: its findings that count, those that are ignored, its outcome."""

    judged: Outcome
    """What the rule said, whatever `[check]` makes of it."""
    outcome: RuleOutcome
    findings: tuple[Finding, ...]
    ignored: tuple[Ignored, ...]
    used: tuple[Ignore, ...]
    """Entries that had an effect."""


def is_selected(rule: Rule, settings: CheckSettings) -> bool:
    """Whether the rule is to run."""
    return not settings.select or any(_selects(rule, word) for word in settings.select)


def apply(rule: Rule, outcome: Outcome, settings: CheckSettings) -> Applied:
    """The rule's outcome with other severities, and without what is ignored."""
    judged, levels = outcome, [level for word, level in settings.severity if means(rule, word)]
    if settings.profile == "description" and outcome.kind == "inconclusive" and rule.code in SETTLED:
        outcome = replace(outcome, kind="decided")
    severities = [levels[-1] if levels else at_most(rule.code, f.severity, settings.profile) for f in outcome.findings]
    findings = [replace(f, severity=severity) for f, severity in zip(outcome.findings, severities, strict=True)]
    entries = [entry for entry in settings.ignore if means(rule, entry.code)]
    kept, ignored, used = [], [], []
    for finding in findings:
        entry = next((e for e in entries if e.subject is None or e.subject in finding.subject), None)
        if entry is None:
            kept.append(finding)
        else:
            ignored.append(Ignored(finding, "manifest", entry.reason))
            used.append(entry)
    outcome = replace(outcome, findings=tuple(kept))
    whole = next((entry for entry in entries if entry.subject is None), None)
    if outcome.kind == "inconclusive" and whole is not None and whole not in used:
        used.append(whole)
    settled = whole is not None or (rule.code.startswith(DOUBT) and bool(ignored) and not kept)
    told = _outcome_under(rule, outcome, ignored, settled, whole)
    return Applied(judged, told, tuple(kept), tuple(ignored), tuple(used))


def outcome_without(rule: RuleOutcome, left: Sequence[Finding], ignored: Sequence[Ignored]) -> RuleOutcome:
    """The outcome of a decided rule of which these findings are left and these ignored."""
    if rule.outcome != "failed" or not ignored or any(f.severity != "note" for f in left):
        return rule
    return replace(rule, outcome="passed" if left else "ignored", reason=_reasons(ignored))


def unused_entries(rules: Sequence[Rule], settings: CheckSettings, used: Sequence[Ignore]) -> Iterator[Unused]:
    """Entries of `[check]` that had no effect."""
    for word in settings.select:
        if not any(_selects(rule, word) for rule in rules):
            yield Unused(word, f"[check] selects {word!r}, and no rule has this code or name")
    for word, _ in settings.severity:
        if not any(means(rule, word) for rule in rules):
            yield Unused(word, f"[check.severity] names {word!r}, and no rule has this code or name")
    for entry in settings.ignore:
        if not any(means(rule, entry.code) for rule in rules):
            message = f"[[check.ignore]] names {entry.code!r}, and no rule has this code or name"
            yield Unused(entry.code, message, entry)
        elif entry not in used:
            yield idle_ignore(entry)


def idle_ignore(entry: Ignore) -> Unused:
    """An ignore that ignored nothing."""
    about = "" if entry.subject is None else f" of {entry.subject!r}"
    return Unused(entry.code, f"[[check.ignore]] of {entry.code}{about} ignores nothing", entry)


def _outcome_under(
    rule: Rule, outcome: Outcome, ignored: Sequence[Ignored], settled: bool, whole: Ignore | None
) -> RuleOutcome:
    """What became of the rule; `settled`: what it could not decide is accepted too."""
    if outcome.kind == "inconclusive" and settled:
        reason = f"{outcome.reason}; ignored: {whole.reason if whole is not None else ignored[0].reason}"
        return RuleOutcome(rule.code, rule.name, "ignored", reason)
    reason = outcome.reason
    if ignored:
        reason = "; ".join(filter(None, [reason, _reasons(ignored)]))
    if outcome.kind == "decided" and ignored and not outcome.findings:
        return RuleOutcome(rule.code, rule.name, "ignored", reason)
    return RuleOutcome(rule.code, rule.name, outcome.name, reason)


def _reasons(ignored: Sequence[Ignored]) -> str:
    reasons = dict.fromkeys(item.reason or f"by the {item.by}" for item in ignored)
    return f"{counted(len(ignored), 'finding')} ignored: {'; '.join(reasons)}"


def means(rule: Rule, word: str) -> bool:
    """Whether a word of `[check]` is the code or the name of a rule."""
    return word.casefold() in (rule.code.casefold(), rule.name)


def _selects(rule: Rule, word: str) -> bool:
    return means(rule, word) or (word[:2].casefold() == "kf" and rule.code.casefold().startswith(word.casefold()))
