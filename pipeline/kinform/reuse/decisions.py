"""Reuse inside the joints stage: what single pairs, bodies and loops of them come out as.

A result is found by the hash of all that its step was given and of the versions of the code, and only where its seal says
that it is what was kept. A new one is packed and unpacked before it is used, so that it is, to the last bit, what a later
run will find.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from kinform.kinematics.pair.question import Answer
from kinform.kinematics.separation.releases import Leaving
from kinform.model.kinematics import Blocker, FiniteCertificate, Joint, Release
from kinform.reuse import fingerprints
from kinform.reuse.digest import digest
from kinform.reuse.ledger import Ledger
from kinform.reuse.packing import pack, seal, unpack
from kinform.reuse.processes import beside
from kinform.version import __version__

__all__ = ["Known"]

One = TypeVar("One")
Two = TypeVar("Two")

_CLASSES: dict[str, type] = {cls.__name__: cls for cls in (Blocker, FiniteCertificate, Joint, Leaving, Answer, Release)}


class Known:
    """Gives the `Answers` of an earlier run, if any, and remembers all that were given in this one."""

    def __init__(self, ledger: Ledger | None):
        previous = None if ledger is None else ledger.previous
        self._kept = {} if previous is None else previous.fingerprints.decisions
        self._code = (__version__, fingerprints.versions_of("joints"))
        self.decisions: dict[str, tuple[str, str]] = {}
        """Packed answers with their seals, by the hash of the question: of those that were asked for."""

    def __call__(self, step: str, given: Sequence[Any], compute: Callable[[], Any]) -> Any:
        """What the step gives for what it is given."""
        key = digest(step, self._code, *given)
        kept = self._kept.get(key)
        if kept is not None and kept[1] == seal(key, kept[0]):
            try:
                found = unpack(kept[0], _CLASSES)
                self.decisions[key] = kept
                return found
            except (ValueError, TypeError, LookupError):  # nothing that this code packed
                pass
        text = pack(compute())
        self.decisions[key] = text, seal(key, text)
        return unpack(text, _CLASSES)

    def beside(self, first: Callable[[], One], second: Callable[[], Two]) -> tuple[One, Two]:
        """What two computations give that may both ask, at the same time."""
        before = set(self.decisions)

        def told() -> tuple[Two, dict[str, tuple[str, str]]]:
            found = second()
            return found, {key: kept for key, kept in self.decisions.items() if key not in before}

        one, (two, decisions) = beside(first, told)
        self.decisions |= decisions
        return one, two
