"""A report whose names try to be markup, commands and several lines."""

from __future__ import annotations

import dataclasses

from kinform.design import Design
from kinform.model.assembly import Source
from kinform.model.coverage import Coverage, Statement
from kinform.model.findings import CheckReport, Finding, Ignored, RuleOutcome, Witness
from support.assemblies import assembly, part

NAMES = (
    "[m6]",
    "two words",
    "\"double\" and 'single'",
    "<b>tag</b> & co",
    "Ø 3 – né 螺",
    "el\nbow",
    "back`tick ``two``",
    "a|b",
    "back\\|slash",
    "*bold* _under_ ~~gone~~",
    "::error::x%0A",
    "@everyone #12",
    "bell\x07",
    "]]> <!--",
    "emoji 🔩",
    " lead and trail ",
    "-",
)

DESIGN = Design(
    dataclasses.replace(assembly(part("a")), name="arm, left: 100 %", source=Source("parts/arm 1.toml")),
)
ERROR = Finding(
    "KF402", "joint-wrong-type", "error", ("el\nbow",), "the joint is fixed, a revolute one is intended",
    "fixed", "revolute", (0.001, 0.0, -0.02), "parts/arm 1.toml", 12, "Give the shaft a clearance.",
    Witness(
        "geometric", (0.0, 0.0, 1.0, 0.0, -0.01, 0.0), (-0.125, 0.25), (0.0005, 0.001), (0.001, 0.0, -0.02),
        (0.002, 0.0, -0.02), ("a", "b|c"), ("a", "b|c"),
    ),
)  # fmt: skip
WARNING = Finding(
    "KF407", "contact-unintended", "warning", ("a~<b>",), '"a" and "<b>" touch', file="parts/arm 1.toml"
)  # fmt: skip
NOTE = Finding("KF107", "mesh-several-shells", "note", ("a", "b|c"), "2 shells")
RULES = (
    RuleOutcome("KF101", "mesh-not-watertight", "passed"),
    RuleOutcome("KF107", "mesh-several-shells", "passed"),
    RuleOutcome("KF402", "joint-wrong-type", "failed"),
    RuleOutcome("KF407", "contact-unintended", "failed"),
    RuleOutcome("KF501", "simulation-refused", "skipped", "no simulation is requested"),
    RuleOutcome("KF904", "range-not-checked", "inconclusive", "no rule checks ranges yet"),
)
ACCEPTED = Ignored(
    Finding("KF407", "contact-unintended", "warning", ("c|<i>", "d"), "'c|<i>' and 'd' touch", file="parts/arm 1.toml",
            line=3),
    "manifest",
    "glued, see {drawing} <3>",
)  # fmt: skip
STATEMENTS = (
    Statement("joint", "el\nbow", "contradicts"),
    Statement("joint", "wr|ist", "undecided", "joint 'wr|ist' is ambiguous"),
    Statement("limit", "wr|ist", "not checked", "no simulation requested", "torque"),
)
COVERAGE = Coverage(
    stated=True, joints=3, joints_understood=2, contacts=4, contacts_understood=3, interpretations=("a~<b>",),
    several=("a", "b|c"), fused=("c|<i>~d",), lowered=("KF406",),
)  # fmt: skip
REPORT = CheckReport((NOTE, ERROR, WARNING), RULES, (ACCEPTED,), statements=STATEMENTS, coverage=COVERAGE)


def named(names: tuple[str, ...] = NAMES) -> CheckReport:
    """A report with a finding a name, whose message says the name too."""
    findings = tuple(
        Finding("KF203", "part-touches-nothing", "error", (name, "b"), f"{name} touches nothing", remedy=f"See {name}.")
        for name in names
    )
    return CheckReport(findings, (RuleOutcome("KF203", "part-touches-nothing", "failed"),))
