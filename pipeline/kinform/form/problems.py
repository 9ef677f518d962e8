"""Collects everything that is wrong with the input, so that all of it is reported at once."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from kinform.errors import InputError, Problem
from kinform.form.constants import CHOICES_COMPARED, CLOSE_NAMES, LISTED_NAMES, MEANT_NAMES, NAME_LENGTH, PROBLEMS_MOST
from kinform.foundation.words import counted


def in_quotes(name: object) -> str:
    """A name as messages show it: in double quotes, control characters escaped, cut where it is too long for a name."""
    text = str(name)
    if len(text) > NAME_LENGTH:
        text = text[: NAME_LENGTH - 1] + "…"
    return f'"{text if text.isprintable() else text.encode("unicode_escape").decode("ascii")}"'


def first_names(names: Iterable[str], limit: int = LISTED_NAMES) -> str:
    """Names in order, comma separated; beyond the limit only their number."""
    names = list(names)
    text = ", ".join(names[:limit])
    return f"{text} and {len(names) - limit} more" if len(names) > limit else text


def did_you_mean(name: str, names: Iterable[str], what: str) -> str:
    """A remedy for a name that is none of the `names`: the closest of them, else all."""
    choices = sorted(set(names))
    compared = choices if len(choices) <= CHOICES_COMPARED else [k for k in choices if k[:1] == name[:1]]
    close: list[str] = []
    if len(name) <= NAME_LENGTH:
        close = difflib.get_close_matches(name, compared[:CHOICES_COMPARED], n=MEANT_NAMES, cutoff=CLOSE_NAMES)
    folded = [k for k in choices if k.casefold() == name.casefold()]
    tails = [k for k in choices if k.rpartition("/")[2] == name]
    inside = [k for k in choices if len(name) > 1 and name.casefold() in k.casefold()]
    best = folded or close or tails or inside
    if best:
        return f"did you mean {' or '.join(in_quotes(b) for b in best[:MEANT_NAMES])}?"
    return f"{what}: {first_names(choices)}" if choices else f"there are no {what.removeprefix('the ')}"


class Problems:
    """A list of problems that raises itself."""

    def __init__(self) -> None:
        self._items: dict[Problem, None] = {}
        self._more = 0

    def __len__(self) -> int:
        return len(self._items)

    def add(self, message: str, file: str | None, line: int | None, remedy: str) -> None:
        """Note a problem; the same problem is kept once, and of very many only the first."""
        if len(self._items) >= PROBLEMS_MOST:
            self._more += 1
        else:
            self._items.setdefault(Problem(message=message, file=file, line=line, remedy=remedy))

    def raise_if_any(self) -> None:
        """Raise InputError with all problems, by file in the order of their first problem, then by line."""
        if not self._items:
            return
        order = {file: i for i, file in reversed(list(enumerate(p.file for p in self._items)))}
        told = sorted(self._items, key=lambda p: (order[p.file], p.line or 0))
        if self._more:
            told.append(
                Problem(f"{counted(self._more, 'more problem')} of this input", None, None, "repair these first")
            )
        raise InputError(told)
