"""What `kinform explain` and docs/rules.md say of rules."""

from __future__ import annotations

import ast
import inspect
import re
from dataclasses import replace

from kinform.consistency import documentation, explain, rules_markdown
from kinform.consistency.comparisons import plausibility
from kinform.model.findings import SEVERITIES


def test_a_rule_in_preview_says_so_wherever_it_is_listed(monkeypatch):
    first, *others = documentation.RULES
    monkeypatch.setattr(documentation, "RULES", (replace(first, stability="preview"), *others))
    assert explain(first.code).splitlines()[0] == f"{first.code} {first.name} ({first.severities}, preview)"
    assert rules_markdown().count("Stability: preview.") == 1
    assert rules_markdown().count("Stability: stable.") == len(others)


def test_a_rule_lists_every_severity_that_its_findings_have():
    """Those that stand in its code; KF110 takes the severity of what it doubts."""
    for rule in documentation.RULES:
        tree = ast.parse(inspect.getsource(inspect.getmodule(rule.check)))
        of_calls = {
            one.value
            for call in ast.walk(tree)
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and call.func.attr == "at"
            for one in ast.walk(call)
            if isinstance(one, ast.Constant) and one.value in SEVERITIES
        }
        assert of_calls <= {rule.severity, *rule.also}, rule.code
        assert rule.severities in explain(rule.code).splitlines()[0]
    (sizes,) = (rule for rule in documentation.RULES if rule.code == "KF110")
    doubted = set(re.findall(r'Doubt\(\s*"(\w+)"', inspect.getsource(plausibility)))
    assert doubted == {sizes.severity, *sizes.also}


def test_the_beginning_of_codes_lists_their_rules():
    lines = explain("KF43").splitlines()
    assert [line.split()[0] for line in lines] == [r.code for r in documentation.RULES if r.code.startswith("KF43")]
