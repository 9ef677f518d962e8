"""Replays of witnesses, one line a finding, and for programs as JSON."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence

from kinform.foundation.escapes import json_text, one_line
from kinform.foundation.words import counted
from kinform.replays import Replayed
from kinform.replays.outcome import STATES

SCHEMA = "kinform/witnesses/1"


def render(replayed: Sequence[Replayed], assembly: str) -> str:
    """A line a finding, then how many hold."""
    lines = [_line(item) for item in replayed]
    counts = Counter(item.outcome.state for item in replayed)
    told = ", ".join(
        f"{counts[state]} {_ONE[state] if counts[state] == 1 else _MANY[state]}" for state in STATES if counts[state]
    )
    lines.append(f"{one_line(assembly)}: {counted(len(replayed), 'witness', 'witnesses')}{f': {told}' if told else ''}")
    return "\n".join(lines) + "\n"


def as_json(replayed: Sequence[Replayed], assembly: str) -> str:
    """The same, for programs."""
    counts = Counter(item.outcome.state for item in replayed)
    whole = {
        "schema": SCHEMA,
        "assembly": assembly,
        "counts": {state: counts[state] for state in STATES},
        "witnesses": [
            {
                "code": item.finding.code,
                "rule": item.finding.rule,
                "severity": item.finding.severity,
                "subject": list(item.finding.subject),
                "kind": None if item.finding.witness is None else item.finding.witness.kind,
                "outcome": item.outcome.state,
                "reason": item.outcome.reason,
            }
            for item in replayed
        ],
    }
    return json_text(json.dumps(whole, indent=1, ensure_ascii=False)) + "\n"


def _line(item: Replayed) -> str:
    finding, outcome = item.finding, item.outcome
    subject = ", ".join(map(one_line, finding.subject[:4])) + (", …" if len(finding.subject) > 4 else "")
    head = f"{outcome.state}: {finding.code} {one_line(finding.rule)}: {subject}"
    return f"{head}: {one_line(outcome.reason)}"


_ONE = {"holds": "holds", "does not hold": "does not hold", "not replayed": "could not be replayed"}
_MANY = {"holds": "hold", "does not hold": "do not hold", "not replayed": "could not be replayed"}
