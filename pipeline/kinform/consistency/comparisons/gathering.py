"""Many findings of one kind as one: the worst, with the names of the others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.model.findings import Finding

ALIKE_MOST = 3
"""Findings of one kind that are told one by one; more are one finding, of the worst. Chosen, not measured."""
NAMED_MOST = 4
"""Subjects of such a finding that are named: as `words.quoted` does."""


@dataclass(frozen=True)
class Ranked:
    """A finding, of which kind it is, and how bad, to be compared within its kind."""

    kind: str
    badness: float
    finding: Finding


def gathered(ranked: Iterable[Ranked], noun: str) -> Iterator[Finding]:
    """The findings, the worst of each kind first; of more than a few of one kind only the worst, which names the
    others' first subjects as "link" or whatever `noun` is."""
    kinds: dict[tuple[str, str], list[Ranked]] = {}
    for item in ranked:
        kinds.setdefault((item.kind, item.finding.severity), []).append(item)
    for items in kinds.values():
        items.sort(key=lambda item: -item.badness)
        if len(items) <= ALIKE_MOST:
            yield from (item.finding for item in items)
            continue
        worst, others = items[0].finding, [item.finding.subject[0] for item in items[1:]]
        text = f"{worst.message}; likewise {counted(len(others), noun)} more: {quoted(others)}"
        yield replace(worst, subject=(*worst.subject, *others), message=text)
