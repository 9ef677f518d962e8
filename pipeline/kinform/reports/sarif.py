"""SARIF 2.1.0 (OASIS), for code scanning: a result a finding, located at the line of the manifest that declares its
subject.

A rule that could not decide is a result of kind `open`; what became of every rule is in the properties of the run.
Findings that are accepted are results with a suppression that gives the reason. Where a baseline was compared, results
are new, unchanged (adopted) or absent (not found any more). The text is ASCII, so that no encoding of a terminal or a
pipe changes it.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import json_text
from kinform.model.findings import CheckReport, Finding, Ignored, RuleOutcome
from kinform.version import __version__

if TYPE_CHECKING:
    from kinform.consistency import Rule


SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """The log as text: one run."""
    index = {rule.code: k for k, rule in enumerate(report.rules)}
    manifest = design.assembly.source.file
    compared = report.gone is not None
    results = [
        _failed(finding, index, manifest, report.members_of(finding)) | ({"baselineState": "new"} if compared else {})
        for finding in report.findings
    ]
    results += [_accepted(item, index, manifest, compared) for item in report.ignored]
    results += [_absent(code, subject, index) for code, subject in report.gone or ()]
    results += [
        _open(rule, index, manifest) | ({"baselineState": "new"} if compared else {})
        for rule in report.rules
        if rule.outcome == "inconclusive"
    ]
    driver = {"name": "kinform", "version": __version__, "rules": _descriptors(report.rules)}
    verdict = verdict_of(report, fail_on)
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": results,
        "properties": {
            "assembly": design.assembly.name,
            "verdict": verdict.word,
            "verdictLine": verdict.line,
            "coverage": verdict.coverage,
            **({} if report.origin == "recorded" else {"origin": "unknown"}),
            "rules": [_present({"code": r.code, "outcome": r.outcome, "reason": r.reason}) for r in report.rules],
        },
    }
    return json_text(json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=1)) + "\n"


def _descriptors(outcomes: Sequence[RuleOutcome]) -> list[dict[str, Any]]:
    from kinform.consistency import RULES

    known = {rule.code: rule for rule in RULES}
    return [_descriptor(outcome, known.get(outcome.code)) for outcome in outcomes]


def _descriptor(outcome: RuleOutcome, rule: Rule | None) -> dict[str, Any]:
    head: dict[str, Any] = {"id": outcome.code, "name": outcome.rule}
    if rule is None:  # of results that another version wrote
        return head
    paragraphs = [" ".join(text.split()) for text in (rule.documentation or "").strip().split("\n\n")]
    return head | {
        "shortDescription": _message(paragraphs[0]),
        "help": _message("\n\n".join(paragraphs)),
        "defaultConfiguration": {"level": rule.severity},
    }


def _failed(
    finding: Finding, index: Mapping[str, int], manifest: str, members: Sequence[Finding] = ()
) -> dict[str, Any]:
    details = {
        "found": finding.found,
        "intended": finding.intended,
        "place": None if finding.place is None else list(finding.place),
        "remedy": finding.remedy,
        "witness": None if finding.witness is None else _present(dataclasses.asdict(finding.witness)),
        "cause": None if finding.cause is None else _present(dataclasses.asdict(finding.cause)),
        "members": [f"{m.code} {', '.join(m.subject)}: {m.message}" for m in members if finding.cause is not None],
    }
    return _present(
        {
            "ruleId": finding.code,
            "ruleIndex": index.get(finding.code),
            "level": finding.severity,
            "message": _message(f"{', '.join(finding.subject)}: {finding.message}"),
            "locations": locations(finding.file or manifest, finding.line, finding.subject),
            "partialFingerprints": {"codeAndSubject/v1": _key(finding)},
            "properties": _present(details),
        }
    )


def _accepted(item: Ignored, index: Mapping[str, int], manifest: str, compared: bool) -> dict[str, Any]:
    """A finding that decides nothing: who accepted it, and why."""
    reason = item.reason or f"adopted by the {item.by}"
    suppression = {"kind": "external", "status": "accepted", "justification": reason}
    state = "unchanged" if item.by == "baseline" else "new"
    more = {"suppressions": [suppression]} | ({"baselineState": state} if compared else {})
    return _failed(item.finding, index, manifest) | more


def _absent(code: str, subject: Sequence[str], index: Mapping[str, int]) -> dict[str, Any]:
    """What the baseline adopts and is not found any more."""
    return _present(
        {
            "ruleId": code,
            "ruleIndex": index.get(code),
            "kind": "pass",
            "level": "none",
            "message": _message(f"{', '.join(subject)}: no longer found"),
            "locations": locations("", None, subject),
            "partialFingerprints": {"codeAndSubject/v1": _hashed(code, subject)},
            "baselineState": "absent",
        }
    )


def _open(rule: RuleOutcome, index: Mapping[str, int], manifest: str) -> dict[str, Any]:
    return _present(
        {
            "ruleId": rule.code,
            "ruleIndex": index[rule.code],
            "kind": "open",
            "level": "none",
            "message": _message(f"{rule.rule} could not decide: {rule.reason}"),
            "locations": locations(manifest, None, ()),
        }
    )


def _message(text: str) -> dict[str, str]:
    """A message without placeholders: braces are doubled (3.11.5)."""
    return {"text": text.replace("{", "{{").replace("}", "}}")}


def locations(file: str, line: int | None, subject: Sequence[str]) -> list[dict[str, Any]]:
    """One location: the file (a relative URI) with its line, and the subjects by name."""
    physical: dict[str, Any] = {}
    if file:
        physical["artifactLocation"] = {"uri": quote(file.encode(errors="surrogateescape"), safe="/")}
        if line is not None:
            physical["region"] = {"startLine": line}
    logical = [{"name": name, "fullyQualifiedName": name, "kind": "object"} for name in subject]
    found = _present({"physicalLocation": physical, "logicalLocations": logical})
    return [found] if found else []


def _key(finding: Finding) -> str:
    """The same for the same inconsistency in another run: no numbers, no lines."""
    return _hashed(finding.code, finding.subject)


def _hashed(code: str, subject: Sequence[str]) -> str:
    return hashlib.sha256(json.dumps([code, *subject]).encode()).hexdigest()


def _present(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Without what is not known or empty."""
    return {key: value for key, value in fields.items() if value not in (None, "", [], {})}
