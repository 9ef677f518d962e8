"""Names in messages: quoting, shortened lists, and suggestions for misspelt names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from contextvars import ContextVar

NAME_SHOWN = 255
"""Characters of a name that a message shows: the longest name that file systems allow."""
CLOSE_NAMES = 0.6
"""Least similarity of a suggested name: the default of `difflib.get_close_matches`."""
CHOICES_COMPARED = 500
"""Most known names that a wrong one is compared with: each takes 10 µs, all of them 5 ms."""
MEANT_NAMES = 2
"""Most names that are suggested. Chosen, not measured."""
LISTED_NAMES = 12
"""Most known names that are listed where none is close. Chosen, not measured."""
COMPARISONS_MOST = 50_000
"""Names that the wrong ones of one reading are compared with: half a second in all. Hundreds of names that are wrong
have one cause."""
_comparisons_left: ContextVar[int | None] = ContextVar("comparisons_left", default=None)


def bound_comparisons() -> None:
    """Let `did_you_mean` compare so many names from now on, and no more: at the start of reading a file."""
    _comparisons_left.set(COMPARISONS_MOST)


def in_quotes(name: object) -> str:
    """A name as messages show it: in double quotes, control characters escaped, cut where it is too long for a name."""
    text = str(name)
    if len(text) > NAME_SHOWN:
        text = text[: NAME_SHOWN - 1] + "…"
    return f'"{text if text.isprintable() else text.encode("unicode_escape").decode("ascii")}"'


def first_names(names: Iterable[str], limit: int = LISTED_NAMES) -> str:
    """Names in order, comma separated; beyond the limit only their number."""
    names = list(names)
    text = ", ".join(names[:limit])
    return f"{text} and {len(names) - limit} more" if len(names) > limit else text


def did_you_mean(name: str, names: Iterable[str], what: str) -> str:
    """A remedy for a name that is none of the `names`: the closest of them, else all. Where a reading has compared too
    many already (`bound_comparisons`) it names none."""
    left = _comparisons_left.get()
    if left is not None and left <= 0:
        return f"name one of {what}"
    choices = sorted(set(names))
    compared = choices if len(choices) <= CHOICES_COMPARED else [k for k in choices if k[:1] == name[:1]]
    if left is not None:
        _comparisons_left.set(left - len(compared[:CHOICES_COMPARED]) - len(choices))
    close: list[str] = []
    if len(name) <= NAME_SHOWN:
        close = difflib.get_close_matches(name, compared[:CHOICES_COMPARED], n=MEANT_NAMES, cutoff=CLOSE_NAMES)
    folded = [k for k in choices if k.casefold() == name.casefold()]
    tails = [k for k in choices if k.rpartition("/")[2] == name]
    inside = [k for k in choices if len(name) > 1 and name.casefold() in k.casefold()]
    best = folded or close or tails or inside
    if best:
        return f"did you mean {' or '.join(in_quotes(b) for b in best[:MEANT_NAMES])}?"
    return f"{what}: {first_names(choices)}" if choices else f"there are no {what.removeprefix('the ')}"
