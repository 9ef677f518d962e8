"""For people at a terminal: 80 columns, no colour, every finding with numbers, place and remedy."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import one_line
from kinform.foundation.words import counted
from kinform.model.findings import SEVERITIES, CheckReport, Finding
from kinform.reports.constants import WIDTH
from kinform.reports.phrases import accepted, place, rule_counts, severity_counts, skipped, where
from kinform.reports.proofs import proof


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """Findings, the most severe first, then what could not be decided, what is ignored or skipped and why, then the
    verdict."""
    order = {severity: k for k, severity in enumerate(reversed(SEVERITIES))}
    found = sorted(report.findings, key=lambda f: order[f.severity])
    blocks = [_finding(f, design.assembly.units, () if f.cause is None else report.members_of(f)) for f in found]
    undecided = [r for r in report.rules if r.outcome == "inconclusive"]
    if undecided:
        lines = ["not decided:"]
        for rule in undecided:
            lines += _wrapped(f"{rule.code} {rule.rule}: {one_line(rule.reason)}", "  ", "      ")
        blocks.append("\n".join(lines))
    for head, told in (("ignored:", accepted(report)), ("skipped:", skipped(report))):
        if told:
            blocks.append("\n".join([head, *(line for text in told for line in _wrapped(text, "  ", "      "))]))
    name = one_line(design.assembly.name)
    verdict = verdict_of(report, fail_on)
    told = [*_wrapped(f"{name}: {one_line(verdict.line)}", "", "  "), *_wrapped(one_line(verdict.coverage), "", "  ")]
    blocks.append("\n".join([*told, severity_counts(report), rule_counts(report)]))
    return "\n\n".join(blocks) + "\n"


def _finding(finding: Finding, units: str, members: Sequence[Finding]) -> str:
    subject = ", ".join(one_line(s) for s in finding.subject)
    lines = _wrapped(f"{finding.severity}: {finding.code} {finding.rule}: {subject}", "", "  ")
    lines += _wrapped(one_line(finding.message), "  ", "  ")
    facts = {
        "found": finding.found,
        "intended": finding.intended,
        "place": place(finding, units),
        "at": where(finding) or None,
        "proof": proof(finding, units),
    }
    for key, value in facts.items():
        if value is not None:
            lines += _wrapped(f"{key + ':':<10}{one_line(value)}", "  ", " " * 12)
    if finding.remedy:
        lines += _wrapped(f"{'remedy:':<10}{one_line(finding.remedy)}", "  ", " " * 12)
    if members:
        lines.append(f"  stands for {counted(len(members), 'finding')}:")
    for member in members:
        about = ", ".join(one_line(s) for s in member.subject)
        text = f"{member.severity}: {member.code} {about}: {one_line(member.found or member.message)}"
        lines += _wrapped(text, "    ", "      ")
    return "\n".join(lines)


def _wrapped(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=rest,
        break_long_words=False,
        break_on_hyphens=False,
    )
