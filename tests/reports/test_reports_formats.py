"""Findings for tools: golden files, read back by readers that know nothing of the writers."""

from __future__ import annotations

import html
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from markdown_it import MarkdownIt
from support import sarif_structure
from support.hostile import DESIGN, ERROR, NAMES, REPORT, RULES, named

from kinform.consistency import Rule, adopt, verdict_of, with_baseline
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.reports import FORMATS, render

GOLDEN = Path(__file__).parent / "golden"
FILES = {
    "brief": "findings.brief.txt", "concise": "findings.concise.txt", "full": "findings.full.txt",
    "github": "findings.github", "json": "findings.json",
    "junit": "findings.xml", "md": "findings.md", "sarif": "findings.sarif",
}  # fmt: skip
DOCUMENTED = Rule(
    "KF402", "joint-wrong-type", "error", "A joint is wrong.\n\nWhat to do: repair {it}.\n", lambda _: None
)


def test_every_format_has_a_golden_file():
    assert set(FILES) == set(FORMATS)


@pytest.mark.parametrize("format", sorted(FILES))
def test_a_report_is_its_golden_file(format, monkeypatch):
    monkeypatch.setattr("kinform.reports.sarif.__version__", "1.2.3")
    monkeypatch.setattr("kinform.consistency.RULES", (DOCUMENTED,))
    assert render(REPORT, DESIGN, format) == (GOLDEN / FILES[format]).read_text(encoding="utf-8")


def escaped(name):
    """How a name stands on one line: what cannot be printed and what begins a command are escaped as in Python."""
    return on_one_line(name).replace("::error::", r"\x3a:error::")


def on_one_line(name):
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in name)


# --- SARIF ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("report", [REPORT, named(), CheckReport((), ())], ids=["golden", "hostile", "empty"])
def test_sarif_is_as_the_standard_demands(report):
    sarif_structure.check(json.loads(render(report, DESIGN, "sarif")))


def test_sarif_keeps_every_name_and_its_results_have_stable_keys():
    text = render(named(), DESIGN, "sarif")
    assert text.isascii()
    results = json.loads(text)["runs"][0]["results"]
    logical = [result["locations"][0]["logicalLocations"][0]["name"] for result in results]
    assert tuple(logical) == NAMES
    keys = {result["partialFingerprints"]["codeAndSubject/v1"] for result in results}
    assert len(keys) == len(NAMES)


def test_sarif_tells_an_undecided_rule_and_what_became_of_all_rules():
    run = json.loads(render(REPORT, DESIGN, "sarif"))["runs"][0]
    (undecided,) = [result for result in run["results"] if result.get("kind") == "open"]
    assert undecided["ruleId"] == "KF904"
    assert next(rule.reason for rule in REPORT.rules if rule.code == "KF904") in undecided["message"]["text"]
    assert [rule["outcome"] for rule in run["properties"]["rules"]] == [rule.outcome for rule in REPORT.rules]


def test_a_rule_that_this_version_does_not_know_is_still_described():
    report = CheckReport((), (RuleOutcome("KF999", "from-the-future", "passed"),))
    log = json.loads(render(report, DESIGN, "sarif"))
    sarif_structure.check(log)
    assert log["runs"][0]["tool"]["driver"]["rules"] == [{"id": "KF999", "name": "from-the-future"}]


def adopting(report, *findings):
    """The report beside a baseline of these findings, and of one that is not found any more."""
    gone = Finding("KF101", "mesh-not-watertight", "error", ("old <b>",), "3 open edges")
    return with_baseline(report, adopt(CheckReport((*findings, gone), RULES)))[0]


def test_sarif_suppresses_what_is_accepted_with_the_reason():
    run = json.loads(render(REPORT, DESIGN, "sarif"))["runs"][0]
    (accepted,) = [result for result in run["results"] if "suppressions" in result]
    assert accepted["ruleId"] == "KF407"
    assert accepted["suppressions"] == [
        {"kind": "external", "status": "accepted", "justification": "glued, see {drawing} <3>"}
    ]
    assert not any("baselineState" in result for result in run["results"])


def test_sarif_says_what_is_new_beside_a_baseline():
    log = json.loads(render(adopting(REPORT, ERROR), DESIGN, "sarif"))
    sarif_structure.check(log)
    states = [(r["ruleId"], r["baselineState"], "suppressions" in r) for r in log["runs"][0]["results"]]
    assert sorted(states) == [
        ("KF101", "absent", False), ("KF107", "new", False), ("KF402", "unchanged", True), ("KF407", "new", False),
        ("KF407", "new", True), ("KF904", "new", False),
    ]  # fmt: skip


@pytest.mark.parametrize(
    "report",
    [REPORT, named(), CheckReport((), ()), adopting(REPORT, ERROR)],
    ids=["golden", "hostile", "empty", "baseline"],
)
def test_sarif_has_no_error_for_the_multitool_of_its_authors(report, tmp_path):
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node")
    find = "process.stdout.write(require('@microsoft/sarif-multitool-linux'))"
    found = subprocess.run([node, "-e", find], capture_output=True, text=True, check=False)
    if found.returncode or not os.access(found.stdout, os.X_OK):
        pytest.skip("@microsoft/sarif-multitool-linux is not installed where node finds it (NODE_PATH)")
    (tmp_path / "log.sarif").write_text(render(report, DESIGN, "sarif"))
    command = [
        found.stdout,
        "validate",
        str(tmp_path / "log.sarif"),
        "--output",
        str(tmp_path / "v.sarif"),
        "--level",
        "Error",
    ]
    ran = subprocess.run([*command, "--kind", "Fail"], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout
    results = json.loads((tmp_path / "v.sarif").read_text(encoding="utf-8-sig"))["runs"][0].get("results", [])
    assert not [result for result in results if result.get("level") == "error"], ran.stdout


# --- JUnit ---------------------------------------------------------------------------------------------------------


def suite_of(report, **settings):
    whole = ElementTree.fromstring(render(report, DESIGN, "junit", **settings))
    assert whole.tag == "testsuites"
    (suite,) = whole
    (properties,) = suite.findall("properties")
    assert next(iter(suite)) is properties and {one.get("name") for one in properties} <= {"verdict", "coverage"}
    suite.remove(properties)
    cases = list(suite)
    assert {case.tag for case in cases} <= {"testcase"}
    assert all(set(case.attrib) >= {"classname", "name"} for case in cases)
    for count, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        assert int(suite.get(count)) == len(suite.findall(f"testcase/{tag}"))
    assert int(suite.get("tests")) == len(cases)
    assert whole.get("tests") == suite.get("tests")
    return suite


def test_junit_fails_what_fails_the_gate_and_errs_where_nothing_was_decided():
    def failures(fail_on):
        found = suite_of(REPORT, fail_on=fail_on).findall("testcase[failure]")
        return [case.get("classname") for case in found]

    assert failures("error") == ["kinform.KF402"]
    assert failures("warning") == ["kinform.KF402", "kinform.KF407"]
    assert failures("note") == ["kinform.KF107", "kinform.KF402", "kinform.KF407"]
    suite = suite_of(REPORT)
    assert [case.get("classname") for case in suite.findall("testcase[error]")] == ["kinform.KF904"]
    assert [case.get("classname") for case in suite.findall("testcase[skipped]")] == ["kinform.KF407", "kinform.KF501"]
    (note,) = (finding for finding in REPORT.findings if finding.code == "KF107")
    assert note.message in suite.find("testcase[@classname='kinform.KF107']/system-out").text


def test_junit_of_no_rules_is_not_a_pass():
    assert suite_of(CheckReport((), (RuleOutcome("KF101", "x", "skipped"),))).get("errors") == "1"


def test_junit_skips_what_is_accepted_with_the_reason():
    (case,) = suite_of(REPORT).findall("testcase[@name='contact-unintended: c|<i>, d']")
    assert case.find("skipped").get("message") == "ignored by the manifest: glued, see {drawing} <3>"


@pytest.mark.parametrize("report", [REPORT, named()], ids=["golden", "hostile"])
def test_another_reader_of_junit_counts_the_same(report, tmp_path):
    junitparser = pytest.importorskip("junitparser")
    (tmp_path / "r.xml").write_text(render(report, DESIGN, "junit"))
    whole = junitparser.JUnitXml.fromfile(str(tmp_path / "r.xml"))
    stated = (whole.tests, whole.failures, whole.errors)
    (suite,) = whole
    kinds = [type(result).__name__ for case in suite for result in case.result]
    assert stated == (len(list(suite)), kinds.count("Failure"), kinds.count("Error"))
    assert suite.skipped == kinds.count("Skipped")


def test_junit_keeps_every_name():
    text = render(named(), DESIGN, "junit")
    assert text.isascii()
    names = [case.get("name").removeprefix("part-touches-nothing: ") for case in suite_of(named())]
    assert names == [f"{name}, b".replace("\x07", "\\x07") for name in NAMES]


# --- GitHub --------------------------------------------------------------------------------------------------------


def command(line):
    """A workflow command as the runner reads it: name, properties, message."""
    name, rest = re.fullmatch(r"::(\w+) (.*)", line).groups()
    properties, message = rest.split("::", 1)
    found = dict(item.split("=", 1) for item in properties.split(","))

    def decoded(text):
        for code, character in (("%0D", "\r"), ("%0A", "\n"), ("%3A", ":"), ("%2C", ","), ("%25", "%")):
            text = text.replace(code, character)
        return text

    return name, {key: decoded(value) for key, value in found.items()}, decoded(message)


def test_github_has_an_annotation_a_finding_and_a_doubt():
    *lines, last = render(REPORT, DESIGN, "github").splitlines()
    found = [command(line) for line in lines]
    assert [name for name, _, _ in found] == ["notice", "error", "warning", "warning"]
    assert found[1][1] == {"file": "parts/arm 1.toml", "line": "12", "title": "KF402 joint-wrong-type: el\\nbow"}
    (error,) = (finding for finding in REPORT.findings if finding.code == "KF402")
    assert any(line.endswith(error.remedy) for line in found[1][2].splitlines())
    assert "KF904" in found[3][1]["title"]
    assert last.startswith(f"{verdict_of(REPORT).line}; {verdict_of(REPORT).coverage}; ")


def test_github_keeps_every_name_and_no_name_becomes_a_command():
    *lines, _ = render(named(), DESIGN, "github").splitlines()
    assert len(lines) == len(NAMES)
    for name, line in zip(NAMES, lines, strict=True):
        kind, properties, _ = command(line)
        assert kind == "error"
        assert properties["title"] == f"KF203 part-touches-nothing: {on_one_line(name)}, b"


# --- Markdown ------------------------------------------------------------------------------------------------------


def tokens(text):
    parsed = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"]).parse(text)
    return [token for block in parsed for token in [block, *(block.children or ())]]


def test_markdown_keeps_every_name_and_lets_none_become_markup():
    found = tokens(render(named(), DESIGN, "md"))
    spans = [token.content for token in found if token.type == "code_inline"]
    for name in NAMES:
        assert spans.count(escaped(name)) == 2, name
    # no markup from names
    assert not {"strong_open", "em_open", "s_open", "link_open", "image", "html_inline"} & {t.type for t in found}
    said = "".join(token.content for token in found if token.type in ("text", "code_inline"))
    assert all(escaped(name).strip() in said for name in NAMES)


def test_markdown_is_a_heading_a_table_and_what_was_not_decided():
    found = tokens(render(REPORT, DESIGN, "md"))
    assert sum(token.type == "tr_open" for token in found) == 1 + len(REPORT.findings)
    assert sum(token.type == "td_open" for token in found) == 5 * len(REPORT.findings)
    reason = next(rule.reason for rule in REPORT.rules if rule.code == "KF904")
    assert any(reason in token.content for token in found if token.type == "inline")


@pytest.mark.parametrize("format", ["full", "md", "json"])
def test_what_is_ignored_or_skipped_is_told_with_its_reason(format):
    text = html.unescape(" ".join(render(REPORT, DESIGN, format).replace("\\", "").split()))
    (ignored,) = REPORT.ignored
    (skipped,) = (rule for rule in REPORT.rules if rule.outcome == "skipped")
    assert ignored.reason in text and skipped.reason in text


# --- all -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("format", ["concise", "full"])
def test_text_for_people_keeps_every_name_on_one_line(format):
    text = render(named(), DESIGN, format)
    joined = " ".join(text.split())
    assert all(" ".join(escaped(name).split()) in joined for name in NAMES)
    assert all(line.isprintable() for line in text.splitlines())


def test_json_keeps_every_name():
    found = json.loads(render(named(), DESIGN, "json"))["findings"]
    assert tuple(finding["subject"][0] for finding in found) == NAMES
