"""What `kinform explain` and docs/rules.md say of rules."""

from __future__ import annotations

from dataclasses import replace

from kinform.consistency import documentation, explain, rules_markdown


def test_a_rule_in_preview_says_so_wherever_it_is_listed(monkeypatch):
    first, *others = documentation.RULES
    monkeypatch.setattr(documentation, "RULES", (replace(first, stability="preview"), *others))
    assert explain(first.code).splitlines()[0] == f"{first.code} {first.name} ({first.severity}, preview)"
    assert rules_markdown().count("Stability: preview.") == 1
    assert rules_markdown().count("Stability: stable.") == len(others)


def test_the_beginning_of_codes_lists_their_rules():
    lines = explain("KF43").splitlines()
    assert [line.split()[0] for line in lines] == [r.code for r in documentation.RULES if r.code.startswith("KF43")]
