"""Reports as other people's programs read them: the schema of SARIF, a reader of JUnit."""

from __future__ import annotations

import json

import pytest
from support.hostile import DESIGN, REPORT, named
from support.validators import npm, package

from kinform.model.findings import CheckReport
from kinform.reports import render


@pytest.fixture(scope="module")
def schema():
    """The standard's schema, from Microsoft's SARIF multitool."""
    path = npm("@microsoft/sarif-multitool-linux") / "sarif-2.1.0.json"
    return package("jsonschema").Draft202012Validator(json.loads(path.read_text(encoding="utf-8-sig")))


@pytest.mark.parametrize("report", [REPORT, named(), CheckReport((), ())], ids=["golden", "hostile", "empty"])
def test_sarif_keeps_the_schema_of_the_standard(report, schema):
    schema.validate(json.loads(render(report, DESIGN, "sarif")))


def test_the_schema_refuses_a_broken_twin(schema):
    log = json.loads(render(REPORT, DESIGN, "sarif"))
    log["runs"][0]["results"][0]["level"] = "terrible"
    assert [error.validator for error in schema.iter_errors(log)]


def test_junitparser_finds_what_became_of_every_rule_and_target():
    junit = package("junitparser")
    (suite,) = junit.JUnitXml.fromstring(render(REPORT, DESIGN, "junit").encode())
    assert (suite.tests, suite.failures, suite.errors, suite.skipped) == tuple(
        sum(wanted is None or isinstance(result, wanted) for case in suite for result in case.result or [None])
        for wanted in (None, junit.Failure, junit.Error, junit.Skipped)
    )
    assert suite.failures and suite.errors and suite.skipped
