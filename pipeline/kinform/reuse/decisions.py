"""Reuse inside the joints stage: what contact decides of single pairs, and which contacts of a block open together.

A result is found by the hash of all that its step was given and of the versions of the code, and only where its seal
says that it is what was kept. A new one is packed and unpacked before it is used, so that it is, to the last bit, what
a later run will find.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

from kinform.kinematics.joints.pair.question import Answer
from kinform.model.kinematics import Blocker, EndStop, Joint, Reading, Release
from kinform.reuse import fingerprints
from kinform.reuse.digest import digest
from kinform.reuse.ledger import Ledger
from kinform.reuse.packing import pack, seal, unpack
from kinform.version import __version__

CLASSES: dict[str, type] = {cls.__name__: cls for cls in (Answer, Blocker, EndStop, Joint, Reading, Release)}


class Decisions:
    """Gives the `Answers` of an earlier run, if any, and remembers all that were given in this one."""

    def __init__(self, ledger: Ledger):
        self._kept = ledger.fingerprints.decisions
        self._code = (__version__, fingerprints.versions_of("joints"))
        self.asked: dict[str, tuple[str, str]] = {}
        """Packed answers with their seals, by the hash of the question: of those that were asked for."""

    def __call__(self, step: str, questions: Sequence[Any], compute: Callable[[list[Any]], Sequence[Any]]) -> list[Any]:
        """What the step gives for each of the questions."""
        keys = [digest(step, self._code, question) for question in questions]
        answers: dict[str, Any] = {}
        for key in dict.fromkeys(keys):
            kept = self._kept.get(key)
            if kept is not None and kept[1] == seal(key, kept[0]):
                with suppress(ValueError, TypeError, LookupError):  # nothing that this code packed
                    answers[key], self.asked[key] = unpack(kept[0], CLASSES), kept
        new = {key: question for key, question in zip(keys, questions, strict=True) if key not in answers}
        for key, answer in zip(new, compute(list(new.values())) if new else (), strict=True):
            text = pack(answer)
            answers[key], self.asked[key] = unpack(text, CLASSES), (text, seal(key, text))
        return [answers[key] for key in keys]
