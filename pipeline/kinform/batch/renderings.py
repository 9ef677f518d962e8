"""All designs of a batch in one text: for tools that take the findings of one design, those of all."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from kinform import results
from kinform.batch.record import Row
from kinform.consistency import verdict_of
from kinform.consistency.judgement import CODES, UNKNOWN
from kinform.design import Design
from kinform.errors import KinformError, Problem
from kinform.foundation.escapes import json_text, lines, one_line, xml_legal
from kinform.foundation.words import counted, number
from kinform.model.findings import SEVERITIES, CheckReport
from kinform.reports import TEXTS, as_json, concise, github, junit, markdown, sarif
from kinform.reports.from_here import seen_from_here
from kinform.version import __version__

SCHEMA = "kinform/batch/1"


def render(rows: Sequence[Row], folder: Path, format: str, fail_on: str = "error") -> str:
    """The rows in that format, ending in a newline; findings are read from the results below `folder`, and files are
    named as seen from here. ValueError for an unknown format."""
    if format not in FORMATS:
        raise ValueError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}")
    text = FORMATS[format](_Whole(rows, folder, fail_on))
    return lines(text) if format in TEXTS else text


@dataclasses.dataclass(frozen=True)
class _Whole:
    """What a renderer is given."""

    rows: Sequence[Row]
    folder: Path
    fail_on: str

    def designs(self) -> Iterator[tuple[Row, Design | None]]:
        """Each row with what findings are told with; None where there are no results, and the row says why."""
        for row in self.rows:
            if row.failure:
                yield row, None
                continue
            try:
                gist = results.read_gist(self.folder / row.results, recorded=row.recorded)
            except KinformError as error:
                gone = Problem(str(error).splitlines()[0])
                yield dataclasses.replace(row, failure="input", problems=(gone,)), None
                continue
            report = dataclasses.replace(_report(gist), strict=row.strict)
            yield row, seen_from_here(dataclasses.replace(gist, report=report), Path(row.source).parent)


def totals(rows: Sequence[Row], fail_on: str = "error") -> dict[str, int]:
    """How many designs have each kind of verdict; and for how many of them nothing was done."""
    kinds = [row.kind(fail_on) for row in rows]
    unchanged = sum(row.unchanged and row.recorded for row in rows)
    return {kind: kinds.count(kind) for kind in CODES} | {"unchanged": unchanged}


def summary_line(rows: Sequence[Row], fail_on: str = "error") -> str:
    """ "25 designs: 20 consistent, 3 no errors found, 0 inconsistent, 2 not verified; 20 unchanged"; how many are
    trusted; and what manifests set aside."""
    told = totals(rows, fail_on)
    unchanged = told.pop("unchanged")
    counts = ", ".join(f"{many} {word}" for word, many in told.items())
    unknown = sum(not row.failure and not row.recorded for row in rows)
    trusted = f"; {unknown} with {UNKNOWN}" if unknown else ""
    return f"{counted(len(rows), 'design')}: {counts}; {unchanged} unchanged{trusted}{_by_manifests(rows)}"


def _by_manifests(rows: Sequence[Row]) -> str:
    """ "; by [check]: 2 findings ignored, 65 rules left out": what makes a design consistent that would not be."""
    ignored, left_out = sum(row.ignored for row in rows), sum(row.unselected for row in rows)
    told = [f"{counted(ignored, 'finding')} ignored"] if ignored else []
    told += [f"{counted(left_out, 'rule')} left out"] if left_out else []
    return f"; by [check]: {', '.join(told)}" if told else ""


def exit_code(rows: Sequence[Row], fail_on: str = "error") -> int:
    """As of `run` for the whole: 1 where a design has findings, else 2 where one is not verified, else 0."""
    codes = {row.code(fail_on) for row in rows}
    return 1 if 1 in codes else 2 if 2 in codes or not codes else 0


def _json(whole: _Whole) -> str:
    designs = []
    for row, gist in whole.designs():
        verdict = row.verdict(whole.fail_on) if gist is None else verdict_of(_report(gist), whole.fail_on).word
        designs.append({
            "design": row.name, "source": row.source, "results": row.results if gist is not None else None,
            "verdict": verdict, "exit_code": row.code(whole.fail_on), "mobility": row.mobility,
            "counts": {severity: row.counts.get(severity, 0) for severity in reversed(SEVERITIES)},
            "inconclusive": row.inconclusive, "ignored": row.ignored, "coverage": row.coverage,
            "seconds": row.seconds, "unchanged": row.unchanged, "tries": row.tries,
            "failure": row.failure or None, "problems": [dataclasses.asdict(p) for p in row.problems],
            "notes": list(row.notes),
            "findings": None if gist is None else as_json.document(_report(gist), gist, whole.fail_on),
        })  # fmt: skip
    told = totals(whole.rows, whole.fail_on)
    head = {"schema": SCHEMA, "kinform": __version__, "exit_code": exit_code(whole.rows, whole.fail_on)}
    return json_text(json.dumps(head | {"totals": told, "designs": designs}, indent=1, ensure_ascii=False)) + "\n"


def _report(gist: Design) -> CheckReport:
    assert gist.report is not None
    return gist.report


def _sarif(whole: _Whole) -> str:
    """One run with the results of all: hosts take few runs, and one of a tool. What has no results is a notification of
    the tool, as the standard has it."""
    rules: dict[str, dict[str, Any]] = {}
    found: list[dict[str, Any]] = []
    notifications: list[dict[str, Any]] = []
    outcomes: list[dict[str, Any]] = []
    for row, gist in whole.designs():
        outcomes.append({"design": row.name, "verdict": row.verdict(whole.fail_on)})
        if gist is None:
            notifications += [_notification(row, problem) for problem in row.problems]
            continue
        run = json.loads(sarif.render(_report(gist), gist, whole.fail_on))["runs"][0]
        for rule in run["tool"]["driver"]["rules"]:
            rules.setdefault(rule["id"], rule)
        found += [result | {"partialFingerprints": _in_design(result, row)} for result in run["results"]]
    order = {code: k for k, code in enumerate(sorted(rules))}
    for result in found:
        if result.get("ruleId") in order:
            result["ruleIndex"] = order[result["ruleId"]]
    invocation: dict[str, Any] = {"executionSuccessful": not notifications}
    if notifications:
        invocation["toolExecutionNotifications"] = notifications
    driver = {"name": "kinform", "version": __version__, "rules": [rules[code] for code in sorted(rules)]}
    one = {
        "tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "invocations": [invocation], "results": found,
        "properties": {"designs": outcomes},
    }  # fmt: skip
    return json_text(json.dumps({"$schema": sarif.SCHEMA, "version": "2.1.0", "runs": [one]}, indent=1)) + "\n"


def _in_design(result: Mapping[str, Any], row: Row) -> dict[str, str]:
    """Fingerprints that tell the same finding in two designs apart."""
    given = result.get("partialFingerprints", {})
    return {key: hashlib.sha256(f"{row.name}\0{value}".encode()).hexdigest() for key, value in given.items()}


def _notification(row: Row, problem: Problem) -> dict[str, Any]:
    text = f"{row.name}: {row.failure}: {problem.message}"
    return {
        "level": "error",
        "message": {"text": text.replace("{", "{{").replace("}", "}}")},
        "locations": sarif.locations(Path(_where(row, problem)).as_posix(), problem.line, ()),
    }


def _where(row: Row, problem: Problem) -> str:
    """The file of a problem as seen from here; that of the design where it names none, or one beside the design."""
    if problem.file is None:
        return row.source
    beside = Path(row.source).parent / problem.file
    return str(beside) if beside.exists() and not Path(problem.file).is_absolute() else problem.file


def _junit(whole: _Whole) -> str:
    """A test suite a design."""
    top = ElementTree.Element("testsuites", name="kinform")
    for row, gist in whole.designs():
        if gist is None:
            suite = ElementTree.SubElement(top, "testsuite", name=xml_legal(row.name), tests="1", failures="0",
                                           errors="1", skipped="0")  # fmt: skip
            case = ElementTree.SubElement(suite, "testcase", classname="kinform", name=xml_legal(row.failure))
            message = "; ".join(problem.message for problem in row.problems)
            told = ElementTree.SubElement(case, "error", type=row.failure, message=xml_legal(message))
            told.text = xml_legal("\n".join(map(str, row.problems)))
        else:
            suite = ElementTree.fromstring(junit.render(_report(gist), gist, whole.fail_on))[0]
            suite.set("name", xml_legal(row.name))
            top.append(suite)
        suite.set("time", f"{row.seconds:.3f}")
    for name in ("tests", "failures", "errors"):
        top.set(name, str(sum(int(suite.get(name, "0")) for suite in top)))
    return junit.text_of(top)


def _md(whole: _Whole) -> str:
    """One table, then what is not consistent, design by design."""
    lines, details = [], []
    for row, gist in whole.designs():
        verdict = markdown.escaped(row.verdict(whole.fail_on))
        cells = (markdown.cell_code(row.name), verdict, *_counts(row), _seconds(row))
        lines.append(cells)
        if gist is None:
            told = "\n".join(f"- {markdown.escaped(str(p).replace(chr(10), ' '))}" for p in row.problems)
            details.append(f"### {markdown.code(row.name)} – not verified: {row.failure}\n\n{told}")
        elif row.code(whole.fail_on):
            details.append(markdown.render(_report(gist), gist, whole.fail_on).rstrip())
    head = ("design", "verdict", *reversed(SEVERITIES), "undecided", "ignored", "seconds")
    blocks = [f"## kinform: {summary_line(whole.rows, whole.fail_on)}", markdown.table(head, lines), *details]
    return "\n\n".join(blocks) + "\n"


def _github(whole: _Whole) -> str:
    lines = []
    for row, gist in whole.designs():
        if gist is None:
            lines += [
                github.command("error", _where(row, p), p.line, f"{row.name}: {row.failure}", str(p.message))
                for p in row.problems
            ]
        else:
            lines.append(github.render(_report(gist), gist, whole.fail_on).rstrip("\n"))
    return "\n".join([*lines, summary_line(whole.rows, whole.fail_on)]) + "\n"


def _concise(whole: _Whole) -> str:
    lines = []
    for row, gist in whole.designs():
        if gist is None:
            lines += [f"{one_line(_where(row, p))}: {row.failure}: {one_line(p.message)}" for p in row.problems]
        else:
            lines.append(concise.render(_report(gist), gist, whole.fail_on).rstrip("\n"))
    return "\n".join([*lines, summary_line(whole.rows, whole.fail_on)]) + "\n"


def _counts(row: Row) -> tuple[str, ...]:
    if row.failure:
        return ("",) * (len(SEVERITIES) + 2)
    counts = [row.counts.get(severity, 0) for severity in reversed(SEVERITIES)]
    return tuple(map(str, (*counts, row.inconclusive, row.ignored)))


def _seconds(row: Row) -> str:
    return ("unchanged" if row.recorded else "trusted") if row.unchanged else number(row.seconds, 3)


def table_row(row: Row, fail_on: str = "error") -> tuple[str, ...]:
    """Design, verdict, errors, warnings, notes, undecided rules, ignored findings, seconds; as texts."""
    return (row.name, row.verdict(fail_on), *_counts(row), _seconds(row))


FORMATS: Mapping[str, Callable[[_Whole], str]] = {
    "concise": _concise, "github": _github, "json": _json, "junit": _junit, "md": _md, "sarif": _sarif,
}  # fmt: skip
"""By format: what renders it."""
