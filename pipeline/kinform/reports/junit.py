"""JUnit XML, for the test views of CI: a test case a rule, of a rule with findings a case a finding.

Findings at or above the severity that fails the gate are failures; lesser ones are told by cases that pass. A rule that
could not decide is an error, one that does not apply is skipped, and so is a finding that is accepted, with the reason;
so failures are exit code 1 and errors alone exit code 2. The text is ASCII with character references; what XML 1.0
cannot carry is escaped as in Python.
"""

from __future__ import annotations

from collections import Counter
from xml.etree import ElementTree

from kinform.consistency import verdict_of
from kinform.consistency.judgement import UNKNOWN
from kinform.design import Design
from kinform.foundation.escapes import xml_legal, xml_text
from kinform.model.findings import SEVERITIES, CheckReport, Finding, Ignored, RuleOutcome
from kinform.reports.phrases import details


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """The document: one suite; `fail_on` is the least severity that is a failure."""
    failing = SEVERITIES[SEVERITIES.index(fail_on) :]
    suite = ElementTree.Element("testsuite", name=xml_legal(design.assembly.name))
    for rule in report.rules:
        own = [finding for finding in report.findings if finding.code == rule.code]
        accepted = [item for item in report.ignored if item.finding.code == rule.code]
        for finding in own:
            _case_of_finding(suite, finding, design.assembly.units, finding.severity in failing)
        for item in accepted:
            _case_of_accepted(suite, item)
        if not (own or accepted) or rule.outcome == "inconclusive":
            _case_of_rule(suite, rule, report)
    known = {rule.code for rule in report.rules}
    for finding in report.findings:
        if finding.code not in known:
            _case_of_finding(suite, finding, design.assembly.units, finding.severity in failing)
    verdict = verdict_of(report, fail_on)
    if report.ran == 0:
        case = ElementTree.SubElement(suite, "testcase", classname="kinform", name="rules ran")
        ElementTree.SubElement(case, "error", type="inconclusive", message=xml_legal(verdict.line))
    for left_open in verdict.open:
        if report.strict or left_open == UNKNOWN:
            name = "origin of results" if left_open == UNKNOWN else "left open"
            case = ElementTree.SubElement(suite, "testcase", classname="kinform", name=name)
            kind = {"type": "strict"} if report.strict else {}
            ElementTree.SubElement(case, "error" if report.strict else "skipped", kind, message=xml_legal(left_open))
    found = Counter(child.tag for case in suite for child in case)
    counts = {"tests": len(suite), "failures": found["failure"], "errors": found["error"], "skipped": found["skipped"]}
    whole = ElementTree.Element("testsuites", name="kinform")
    whole.append(suite)
    properties = ElementTree.Element("properties")
    for label, value in (("verdict", verdict.line), ("coverage", verdict.coverage)):
        if value:
            ElementTree.SubElement(properties, "property", name=label, value=xml_legal(value))
    suite.insert(0, properties)
    for element in (whole, suite):
        for name, count in counts.items():
            if element is suite or name != "skipped":
                element.set(name, str(count))
    return text_of(whole)


def text_of(whole: ElementTree.Element) -> str:
    """The document of this root, as text."""
    ElementTree.indent(whole, " ")
    text: str = ElementTree.tostring(whole, "unicode")
    head = '<?xml version="1.0" encoding="UTF-8"?>\n'
    return head + xml_text(text).encode("ascii", "xmlcharrefreplace").decode("ascii") + "\n"


def _case_of_finding(suite: ElementTree.Element, finding: Finding, units: str, fails: bool) -> None:
    subject = ", ".join(finding.subject)
    case = _case(suite, finding.code, f"{finding.rule}: {subject}")
    if finding.file is not None:
        case.set("file", xml_legal(finding.file))
    if finding.line is not None:
        case.set("line", str(finding.line))
    lines = [
        f"{finding.severity}: {finding.message}",
        *(f"{key}: {value}" for key, value in details(finding, units).items()),
    ]
    if fails:
        told = ElementTree.SubElement(case, "failure", type=finding.severity, message=xml_legal(finding.message))
    else:
        told = ElementTree.SubElement(case, "system-out")
    told.text = xml_legal("\n".join(lines))


def _case_of_accepted(suite: ElementTree.Element, item: Ignored) -> None:
    finding = item.finding
    case = _case(suite, finding.code, f"{finding.rule}: {', '.join(finding.subject)}")
    message = f"ignored by the {item.by}: {item.reason or finding.message}"
    ElementTree.SubElement(case, "skipped", message=xml_legal(message))


def _case_of_rule(suite: ElementTree.Element, rule: RuleOutcome, report: CheckReport) -> None:
    case = _case(suite, rule.code, rule.rule)
    if any(member.code == rule.code for member in report.members):
        stated = [f for f in report.findings if f.cause and any(m.code == rule.code for m in report.members_of(f))]
        text = "; ".join(f"{finding.code} {', '.join(finding.subject)}" for finding in stated)
        ElementTree.SubElement(case, "system-out").text = xml_legal(f"what this rule found follows from {text}")
    if rule.outcome == "inconclusive":
        ElementTree.SubElement(case, "error", type="inconclusive", message=xml_legal(rule.reason))
    elif rule.outcome != "passed" and rule.outcome != "failed":  # skipped
        ElementTree.SubElement(case, "skipped", message=xml_legal(rule.reason))


def _case(suite: ElementTree.Element, code: str, name: str) -> ElementTree.Element:
    return ElementTree.SubElement(suite, "testcase", classname=f"kinform.{code}", name=xml_legal(name))
