"""The answer to an intended joint is what the rules say."""

from __future__ import annotations

import pytest
from support.places import FIXTURES

from kinform.consistency.comparisons.answers import answers

CONTRADICTING = {"KF402", "KF403", "KF404", "KF405"}
DESIGNS = sorted(path for path in FIXTURES.rglob("*.toml") if "[[function.joint]]" in path.read_text())


@pytest.mark.parametrize("path", DESIGNS, ids=lambda path: path.stem)
def test_a_joint_is_contradicted_where_a_rule_says_so_and_nowhere_else(derive_design, path):
    design = derive_design(path)
    found = {f.subject[0] for f in design.report.findings if f.code in CONTRADICTING and f.severity == "error"}
    assert {one.name for one in answers(design) if one.answer == "contradicts"} == found
