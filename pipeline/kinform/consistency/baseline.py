"""A baseline: today's findings, adopted, so that only new ones count.

Its entries are a code, a subject (parts, joint, or requirement) and how many findings share them: no message,
no place, no number, so that a dimension that moves a little makes no finding new. What could not be decided is
no finding and is never adopted; a finding that has become more severe is new, and so are all of a subject where
there are more than before.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from kinform.consistency.control import outcome_without
from kinform.errors import InputError, Problem
from kinform.foundation.escapes import json_text
from kinform.foundation.texts import parse_json
from kinform.frozen import dataclass
from kinform.model.findings import SEVERITIES, CheckReport, Finding, Ignored

SCHEMA = "kinform/baseline/1"

Key = tuple[str, tuple[str, ...]]


@dataclass(frozen=True)
class Baseline:
    """How many findings of each key and severity are adopted."""

    counts: dict[tuple[Key, str], int]

    @property
    def keys(self) -> frozenset[Key]:
        """Codes with subjects."""
        return frozenset(key for key, _ in self.counts)

    def text(self) -> str:
        """The file: sorted, one entry a line, the same bytes for the same findings."""
        entries = [
            {"code": code, "subject": list(subject), "severity": severity, "count": count}
            for ((code, subject), severity), count in sorted(self.counts.items())
        ]
        lines = ",\n  ".join(json_text(json.dumps(entry, ensure_ascii=False)) for entry in entries)
        body = f"[\n  {lines}\n ]" if entries else "[]"
        return f'{{\n "schema": "{SCHEMA}",\n "findings": {body}\n}}\n'


def adopt(report: CheckReport) -> Baseline:
    """The baseline of a report: its findings, those that an earlier baseline accepted included."""
    earlier = [item.finding for item in report.ignored if item.by == "baseline"]
    return Baseline(dict(Counter((_key(f), f.severity) for f in (*report.singles, *earlier) if _counts(f))))


def read_baseline(text: str, file: str) -> Baseline:
    """The baseline in a file's text. Raises InputError."""
    remedy = "write it anew: kinform check F.h5 --write-baseline B.json"
    try:
        document = parse_json(text)
    except ValueError as error:
        raise InputError([Problem(f"is not JSON: {error}", file, None, remedy)]) from None
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InputError([Problem(f"is no baseline: its schema is not {SCHEMA!r}", file, None, remedy)])
    counts: dict[tuple[Key, str], int] = {}
    entries = document.get("findings")
    for k, entry in enumerate(entries if isinstance(entries, list) else [None]):
        if not _valid(entry):
            message = f"entry {k + 1} is not an object of code, subject, severity and count"
            raise InputError([Problem(message, file, None, remedy)])
        counts[(entry["code"], tuple(entry["subject"])), entry["severity"]] = entry["count"]
    return Baseline(counts)


def with_baseline(report: CheckReport, baseline: Baseline) -> tuple[CheckReport, tuple[Key, ...]]:
    """The report without the findings that the baseline adopts, and the keys of it that are not found any more. A
    cause is adopted when all of its members are."""
    groups: dict[Key, list[Finding]] = {}
    for finding in report.singles:
        groups.setdefault(_key(finding), []).append(finding)
    adopted = {key for key, findings in groups.items() if _is_adopted(key, findings, baseline)}
    is_known = lambda f: _key(f) in adopted and _counts(f)
    kept = tuple(f for f in report.findings if not all(map(is_known, report.members_of(f))))
    left = [single for finding in kept for single in report.members_of(finding)]
    gone_for = [f for f in report.findings if all(map(is_known, report.members_of(f)))]
    ignored = [Ignored(single, "baseline") for finding in gone_for for single in report.members_of(finding)]
    rules = tuple(
        outcome_without(
            rule, [f for f in left if f.code == rule.code], [i for i in ignored if i.finding.code == rule.code]
        )
        for rule in report.rules
    )
    every = sorted((*report.ignored, *ignored), key=lambda item: (item.finding.code, item.finding.subject, item.by))
    gone = tuple(sorted(baseline.keys - groups.keys() - {_key(item.finding) for item in report.ignored}))
    members = tuple(single for single in left if single.cause is not None)
    return replace(report, findings=kept, rules=rules, ignored=tuple(every), gone=gone, members=members), gone


def _is_adopted(key: Key, findings: Iterable[Finding], baseline: Baseline) -> bool:
    """Whether there are no more findings of the key than before, at each severity and above."""
    here = Counter(f.severity for f in findings)
    more = 0
    for severity in reversed(SEVERITIES):
        more += here[severity] - baseline.counts.get((key, severity), 0)
        if more > 0:
            return False
    return True


def _key(finding: Finding) -> Key:
    return finding.code, finding.subject


def _counts(finding: Finding) -> bool:
    """Not the notes on what could not be decided: those say that something is not verified."""
    return finding.severity != "note" or not finding.code.startswith("KF9")


def _valid(entry: Any) -> bool:
    if not isinstance(entry, dict):
        return False
    subject, count = entry.get("subject"), entry.get("count")
    return (
        isinstance(entry.get("code"), str)
        and isinstance(subject, list)
        and all(isinstance(name, str) for name in subject)
        and entry.get("severity") in SEVERITIES
        and isinstance(count, int)
        and not isinstance(count, bool)
        and count > 0
    )
