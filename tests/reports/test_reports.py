"""Findings as text: written out by hand."""

from __future__ import annotations

import dataclasses
import json

import pytest
from support.assemblies import assembly, part

from kinform.consistency import verdict, verdict_of
from kinform.design import Design
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.reports import render

DESIGN = Design(assembly(part("a")))
ERROR = Finding(
    "KF402", "joint-wrong-type", "error", ("el\nbow",), "the joint is fixed, a revolute one is intended",
    "fixed", "revolute", (0.001, 0.0, -0.02), "m.toml", 12, "Give the shaft a clearance.",
)  # fmt: skip
NOTE = Finding("KF107", "mesh-several-shells", "note", ("a", "b"), "2 shells")
RULES = (
    RuleOutcome("KF107", "mesh-several-shells", "failed"),
    RuleOutcome("KF402", "joint-wrong-type", "failed"),
    RuleOutcome("KF501", "simulation-refused", "skipped", "no simulation is requested"),
    RuleOutcome("KF904", "range-not-checked", "inconclusive", "no rule checks ranges yet"),
)
REPORT = CheckReport((NOTE, ERROR), RULES)


def test_concise_has_a_line_a_finding_and_a_line_a_doubt():
    assert render(REPORT, DESIGN, "concise").splitlines() == [
        "m.toml: note KF107 a, b: 2 shells",
        "m.toml:12: error KF402 el\\nbow: the joint is fixed, a revolute one is intended",
        "m.toml: inconclusive KF904 range-not-checked: no rule checks ranges yet",
        f"test: {verdict_of(REPORT).line}; 1 error, 0 warnings, 1 note; 3 rules ran, 1 skipped, 1 inconclusive",
    ]


@pytest.mark.parametrize("format", ["full", "github", "junit", "md"])
def test_a_place_is_told_without_the_noise_of_its_computation(format):
    noisy = dataclasses.replace(ERROR, place=(6.6e-19, -1.04e-18, -0.002497))
    text = render(CheckReport((noisy,), RULES), DESIGN, format).replace("\\", "")
    assert "(0, 0, -2.497) mm" in text


def test_full_tells_everything_within_eighty_columns():
    text = render(REPORT, DESIGN, "full")
    assert text == (
        "error: KF402 joint-wrong-type: el\\nbow\n"
        "  the joint is fixed, a revolute one is intended\n"
        "  found:    fixed\n"
        "  intended: revolute\n"
        "  place:    (1, 0, -20) mm\n"
        "  at:       m.toml:12\n"
        "  remedy:   Give the shaft a clearance.\n"
        "\n"
        "note: KF107 mesh-several-shells: a, b\n"
        "  2 shells\n"
        "\n"
        "not decided:\n"
        "  KF904 range-not-checked: no rule checks ranges yet\n"
        "\n"
        "skipped:\n"
        "  no simulation is requested: KF501\n"
        "\n"
        f"test: {verdict_of(REPORT).line}\n"
        "1 error, 0 warnings, 1 note\n"
        "3 rules ran, 1 skipped, 1 inconclusive\n"
    )
    assert max(map(len, text.splitlines())) <= 80


def test_json_carries_findings_and_rules():
    found = json.loads(render(REPORT, DESIGN, "json"))
    assert found["schema"] == "kinform/findings/1"
    assert found["counts"] == {
        "error": 1, "warning": 0, "note": 1, "passed": 0, "failed": 2, "inconclusive": 1, "skipped": 1, "ignored": 0,
    }  # fmt: skip
    assert found["findings"][1]["subject"] == ["el\nbow"]
    assert found["findings"][1]["place"] == [0.001, 0.0, -0.02]


def test_nothing_checked_is_not_a_pass():
    empty = CheckReport((), (RuleOutcome("KF101", "x", "skipped"),))
    assert verdict(empty) == 2


def test_an_unknown_format_lists_the_known_ones():
    with pytest.raises(ValueError, match="sarif"):
        render(REPORT, DESIGN, "xml")
