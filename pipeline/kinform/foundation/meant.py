"""Names in messages: as they are shown, a few of many, and which was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

NAME_SHOWN = 255
"""Characters of a name that a message shows."""
CLOSE_NAMES = 0.6
"""Likeness (of difflib, its default) from which on a known name is probably the one that was meant."""
CHOICES_COMPARED = 500
"""Known names that a wrong one is compared with: each takes ten microseconds."""
MEANT_NAMES = 2
"""Names that are proposed, at most."""
LISTED_NAMES = 12
"""Known names that are listed where none is close."""


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
    """A remedy for a name that is none of the `names`: the closest of them, else all."""
    choices = sorted(set(names))
    compared = choices if len(choices) <= CHOICES_COMPARED else [k for k in choices if k[:1] == name[:1]]
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
