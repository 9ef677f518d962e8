"""`[[friction]]` of all manifests of a design: one friction for each pair of materials, in whichever file it stands."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.form.problems import Problems
from kinform.foundation.meant import in_quotes
from kinform.model.function import MaterialFriction


def one_for_each_pair(stated: Iterable[MaterialFriction], problems: Problems) -> tuple[MaterialFriction, ...]:
    """What is stated; a problem where two files say different things of one pair, with both places."""
    first: dict[tuple[str, ...], MaterialFriction] = {}
    out = tuple(stated)
    for one in out:
        pair = tuple(sorted(one.materials))
        other = first.setdefault(pair, one)
        if other.file != one.file and _numbers(other) != _numbers(one):
            named = " and ".join(in_quotes(name) for name in pair)
            wrong = f"the friction of {named} is {_told(one)}; at {other.file}:{other.line} it is {_told(other)}"
            remedy = "state one friction for a pair of materials of the whole design, or call one of them otherwise"
            problems.add(wrong, one.file, one.line, remedy)
    return out


def _numbers(one: MaterialFriction) -> tuple[float, float]:
    return one.coefficient, one.static


def _told(one: MaterialFriction) -> str:
    return f"{one.coefficient:g} in motion and {one.static:g} at rest"
