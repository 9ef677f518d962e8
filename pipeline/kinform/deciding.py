"""Reuse inside the joints stage: decisions pair by pair, and what follows of all pairs where none differs.

A decision is found by the hash of all that it depends on and of the versions of the code, and only where its seal says
that it is what was kept. A new one is packed and unpacked before it is used, so that it is, to the last bit, what a later
run will find.
"""

from __future__ import annotations

from collections.abc import Callable

from kinform._version import __version__
from kinform.kinematics.parts import Answer, Decided, Question
from kinform.ledger import Ledger
from kinform.model.fingerprints import Fingerprints
from kinform.model.kinematics import Blocker, Joint, Kinematics
from kinform.results import fingerprints
from kinform.results._digest import digest
from kinform.results._packed import pack, seal, unpack

__all__ = ["Known"]

_CLASSES: dict[str, type] = {cls.__name__: cls for cls in (Answer, Blocker, Joint)}


class Known:
    """The `Answers` of an earlier run, if any, and all that were given in this one."""

    def __init__(self, ledger: Ledger | None):
        self._previous = None if ledger is None else ledger.previous
        self._marks = Fingerprints() if self._previous is None else self._previous.fingerprints
        self._code = (__version__, fingerprints.versions_of("joints"))
        self.decisions: dict[str, tuple[str, str]] = {}
        """Packed answers with their seals, by the hash of the question: of those that were asked for."""
        self.settled = ""
        """Hash of what the whole follows from."""

    def pair(self, question: Question, compute: Callable[[Question], Answer | None]) -> Answer | None:
        """As of `Answers`."""
        key = digest("pair", self._code, question)
        kept = self._marks.decisions.get(key)
        if kept is not None and kept[1] == seal(key, kept[0]):
            try:
                found: Answer | None = unpack(kept[0], _CLASSES)
                self.decisions[key] = kept
                return found
            except (ValueError, TypeError, LookupError):  # of other code after all
                pass
        text = pack(compute(question))
        self.decisions[key] = text, seal(key, text)
        answer: Answer | None = unpack(text, _CLASSES)
        return answer

    def whole(self, decided: Decided, compute: Callable[[Decided], Kinematics]) -> Kinematics:
        """As of `Answers`."""
        self.settled = digest("whole", self._code, decided)
        if self._previous is not None and self._marks.settled == self.settled:
            kinematics = self._previous.kinematics
            if kinematics is not None:
                return kinematics
        return compute(decided)
