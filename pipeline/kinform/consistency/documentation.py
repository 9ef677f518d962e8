"""The documentation of the rules: for one code in the terminal, for all in `docs/rules.md`."""

from __future__ import annotations

import difflib
import inspect
import re

from kinform.consistency import profiles
from kinform.consistency.glossary import GLOSSARY, meaning
from kinform.consistency.rule import Rule
from kinform.consistency.rules import RULES
from kinform.errors import KinformError

FAMILIES = (
    ("KF1", "Mesh, units, mass"),
    ("KF2", "Contact and joints"),
    ("KF3", "Mobility and redundancy"),
    ("KF4", "Function"),
    ("KF5", "Motion and forces"),
    ("KF9", "Inconclusive"),
)

INTRODUCTION = """\
# Rules

`kinform check` compares the form, the behaviour and the function of a design by these rules. Each rule
passes, fails, is inconclusive (something that it is about could not be decided), or is skipped (it does
not apply). Findings are errors, warnings or notes. Exit code of the gate: 1 with findings at or above
`--fail-on` (default error); else 2 when nothing was checked or a rule is inconclusive; else 0.

A stable rule keeps its code, its name and what it finds until the next major version. A rule in preview may
change with any version.

`kinform explain CODE` prints the text of one rule. This page is generated from the rules by
`python -m kinform.consistency docs/rules.md`.
"""


class UnknownRuleError(KinformError):
    """No rule has this code or name, and no word that is explained is this; lists the nearest ones."""

    def __init__(self, code: str, near: tuple[str, ...]):
        self.code, self.near = code, near
        hint = f"did you mean {', '.join(near)}?" if near else "`kinform explain` lists all rules and words"
        super().__init__(f"no rule has the code or name {code!r}, and no word of results is that: {hint}")


def explain(code: str) -> str:
    """Documentation of the rule with this code or name (case does not matter, nor blanks for hyphens); of the beginning
    of codes ("KF4") the list of its rules; what a word means that results are told in ("blocked"); UnknownRuleError
    otherwise."""
    wanted = code.strip().casefold()
    for rule in RULES:
        if wanted == rule.code.casefold() or "-".join(wanted.split()) == rule.name:
            return f"{rule.code} {rule.name} ({_standing(rule)})\n\n{_text(rule)}\n"
    word = meaning(code)
    if word is not None:
        return word
    family = [rule for rule in RULES if len(wanted) > 1 and rule.code.casefold().startswith(wanted)]
    if family:
        return "".join(f"{rule.code} {rule.name} ({_standing(rule)})\n" for rule in family)
    raise UnknownRuleError(code, _near(wanted))


def rules_markdown() -> str:
    """The text of `docs/rules.md`."""
    lines = [INTRODUCTION, "| code | name | severity | what is wrong |", "|---|---|---|---|"]
    for rule in RULES:
        lines.append(f"| [{rule.code}](#{_anchor(rule)}) | {rule.name} | {rule.severities} | {_summary(rule)} |")
    lines += ["", "## Profiles", "", inspect.cleandoc(profiles.__doc__ or ""), ""]
    lines += ["| rule | design | description |", "|---|---|---|"]
    for rule in RULES:
        if rule.code in profiles.DESCRIPTION:
            doubts = ", doubts too" if rule.code in profiles.SETTLED else ""
            severity = profiles.at_most(rule.code, rule.severity, "description")
            lines.append(f"| {rule.code} {rule.name} | {rule.severity} | {severity}{doubts} |")
    for prefix, title in FAMILIES:
        lines.append(f"\n## {prefix}: {title}")
        for rule in RULES:
            if rule.code.startswith(prefix):
                text = re.sub(r"^([A-Z][a-z ]+): ", r"**\1.** ", _text(rule), flags=re.MULTILINE)
                standing = f"Severity: {rule.severities}. Stability: {rule.stability}."
                lines.append(f"\n### {rule.code} {rule.name}\n\n{standing}\n\n{text}")
    return "\n".join(lines) + "\n"


def _standing(rule: Rule) -> str:
    """Severity, and that a rule is in preview."""
    return rule.severities if rule.stability == "stable" else f"{rule.severities}, {rule.stability}"


def _text(rule: Rule) -> str:
    return inspect.cleandoc(rule.documentation or "")


def _summary(rule: Rule) -> str:
    return " ".join(_text(rule).split("\n\n")[0].split())


def _anchor(rule: Rule) -> str:
    return f"{rule.code} {rule.name}".lower().replace(" ", "-")


def _near(wanted: str) -> tuple[str, ...]:
    names = {name: f"{rule.code} {rule.name}" for rule in RULES for name in (rule.code.casefold(), rule.name)}
    names |= {word: word for word in GLOSSARY}
    close = difflib.get_close_matches(wanted, names, n=5, cutoff=0.5)
    close += [name for name in names if len(wanted) > 2 and wanted in name]
    return tuple(dict.fromkeys(names[name] for name in close))[:5]
