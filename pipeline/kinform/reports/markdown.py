"""Markdown (GitHub's and GitLab's dialect), for comments on a change and for summaries of a job.

Names stand in code spans, where no dialect reads them as markup, mentions or references; all other text that
comes from the design is escaped.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import one_line
from kinform.model.findings import SEVERITIES, CheckReport, Finding
from kinform.reports.phrases import accepted, details, rule_counts, severity_counts, skipped, where


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """Verdict, a table of findings (the most severe first), their details, the rules that could not decide, and what is
    ignored or skipped."""
    verdict = verdict_of(report, fail_on)
    blocks = [
        f"### kinform: {code(design.assembly.name)} – {escaped(verdict.line)}",
        *([escaped(verdict.coverage)] if verdict.coverage else []),
        f"{severity_counts(report)}; {rule_counts(report)}",
    ]
    found = sorted(report.findings, key=lambda finding: -SEVERITIES.index(finding.severity))
    if found:
        rows = [
            (
                f.severity,
                f"{f.code} {f.rule}",
                ", ".join(map(cell_code, f.subject)),
                escaped(f.message),
                cell_code(where(f)) if f.file is not None else "",
            )
            for f in found
        ]
        blocks.append(table(("severity", "rule", "subject", "what is wrong", "at"), rows))
        told = [_details(finding, design.assembly.units) for finding in found]
        if any(told):
            lines = "\n".join(text for text in told if text)
            blocks.append(f"<details><summary>Details and remedies</summary>\n\n{lines}\n\n</details>")
    undecided = [rule for rule in report.rules if rule.outcome == "inconclusive"]
    if undecided:
        blocks.append(
            "Not decided:\n\n" + "\n".join(f"- {rule.code} {rule.rule}: {escaped(rule.reason)}" for rule in undecided)
        )
    for head, told in (("Ignored", accepted(report)), ("Skipped", skipped(report))):
        if told:
            lines = "\n".join(f"- {escaped(text)}" for text in told)
            blocks.append(f"<details><summary>{head}</summary>\n\n{lines}\n\n</details>")
    return "\n\n".join(blocks) + "\n"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; cells are Markdown without line breaks, pipes escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def code(text: str) -> str:
    """The text in a code span, on one line."""
    text = one_line(text)
    fence = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    pad = " " if not text.strip() or text[0] in "` " or text[-1] in "` " else ""
    return f"{fence}{pad}{text}{pad}{fence}"


def cell_code(text: str) -> str:
    """As `code`, in a table, where pipes end a cell even in code spans."""
    return code(text).replace("|", "\\|")


def escaped(text: str) -> str:
    """The text on one line, with every character that Markdown could read as markup escaped. Words in which a host
    would find a mention, a reference or a link stand in code spans: hosts look for these when escapes are gone."""
    return "".join(
        code(piece) if _REFERENCE.search(piece) else _MARKUP.sub(_escape, piece)
        for piece in _WORDS.split(one_line(text))
    )


_WORDS = re.compile(r"([ |]+)")
"""What ends a word: a pipe too, which code spans in a table cannot hold."""
_REFERENCE = re.compile(r"[@#]|://|www\.|\b(?:mailto|xmpp):|\bGH-\d|(?:^|\W)[!&$%^~]\w", re.IGNORECASE)
"""Mentions, issues, commits, merge requests, epics, snippets, milestones, alerts, labels and links of GitHub and
GitLab."""
_MARKUP = re.compile(r"[\\`*_{}\[\]<>+!|~&$()]")
_NAMED = {"<": "&lt;", ">": "&gt;", "&": "&amp;"}
"""Characters of HTML, whose escapes by a stroke are not safe everywhere."""


def _escape(match: re.Match[str]) -> str:
    return _NAMED.get(match[0], "\\" + match[0])


def _details(finding: Finding, units: str) -> str:
    found = details(finding, units)
    if not found:
        return ""
    lines = [f"- {finding.code} {', '.join(map(code, finding.subject))}"]
    return "\n".join([*lines, *(f"  - {key}: {escaped(value)}" for key, value in found.items())])
