"""Paths to values: `part.crank.position.0` in a manifest, `simulation.joints.guide.highest` in what is shown.

Steps are divided by dots; one with dots in it stands in quotes. In a list of tables a step is the name of one (of
joints also the designer's name), in any list a number, from 0. In what is shown a last step `count`, `min`, `max`,
`sum` or `mean` of a list is that of its values.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from kinform.foundation.name_hints import did_you_mean

_INSTEAD = {"density": "material", "material": "density", "rpy": "quaternion", "quaternion": "rpy"}
"""Keys that say the same in two ways."""
_STEP = re.compile(r'"((?:[^"\\]|\\.)*)"|\'([^\']*)\'|([^."\']+)')
_WORDS: Mapping[str, Callable[[Any], float]] = {
    "count": len,
    "min": min,
    "max": max,
    "sum": sum,
    "mean": lambda v: sum(v) / len(v),
}


def steps_of(text: str) -> tuple[str, ...]:
    """The steps of a path. Raises ValueError where it is none."""
    out, at = [], 0
    while True:
        match = _STEP.match(text, at)
        if match is None:
            raise ValueError(f"{text!r} is no path, such as part.crank.position.0")
        out.append(next(group for group in match.groups() if group is not None))
        at = match.end()
        if at == len(text):
            return tuple(out)
        if text[at] != ".":
            raise ValueError(f"{text!r} is no path: a dot is missing after {text[:at]!r}")
        at += 1


def changed(tables: Any, steps: Sequence[str], value: Any) -> Any:
    """The tables with another value at a path; only the last step may be new, and takes the place of what says the same
    otherwise (a density that of a material). Raises KeyError that says what is missing."""
    if not steps:
        return value
    key, rest = steps[0], steps[1:]
    if isinstance(tables, Mapping):
        if key not in tables and rest:
            raise KeyError(_missing(key, tables))
        left = {k: v for k, v in tables.items() if rest or k != _INSTEAD.get(key)}
        return {**left, key: changed(tables.get(key), rest, value)}
    if isinstance(tables, Sequence) and not isinstance(tables, str):
        k = _index(tables, key)
        return [*tables[:k], changed(tables[k], rest, value), *tables[k + 1 :]]
    raise KeyError(f"nothing is below the value {tables!r}: {key!r} leads nowhere")


def looked_up(values: Any, steps: Sequence[str]) -> Any:
    """The value at a path. Raises KeyError that says what is missing."""
    for n, key in enumerate(steps):
        if isinstance(values, Mapping):
            if key not in values:
                raise KeyError(_missing(key, values))
            values = values[key]
        elif isinstance(values, Sequence) and not isinstance(values, str):
            if key in _WORDS and n == len(steps) - 1 and not any(_named(item, key) for item in values):
                if key != "count" and (not values or any(not isinstance(item, int | float) for item in values)):
                    return None
                return _WORDS[key](values)
            values = values[_index(values, key)]
        elif values is None:  # not known, and so is what would be below it
            return None
        else:
            raise KeyError(f"nothing is below the value {values!r}: {key!r} leads nowhere")
    return values


def _index(items: Sequence[Any], key: str) -> int:
    for k, item in enumerate(items):
        if _named(item, key):
            return k
    if re.fullmatch(r"-?\d+", key) and -len(items) <= int(key) < len(items):
        return int(key) % len(items)
    names = {name: None for item in items for name in _names(item)}
    raise KeyError(_missing(key, names) if names else f"there is no number {key}: the list has {len(items)}")


def _named(item: Any, key: str) -> bool:
    return key in _names(item)


def _names(item: Any) -> list[str]:
    """What a table in a list can be called."""
    if not isinstance(item, Mapping):
        return []
    return [item[key] for key in ("name", "intended_name") if isinstance(item.get(key), str)]


def _missing(key: str, known: Mapping[str, Any]) -> str:
    return f"there is no {key!r}: {did_you_mean(key, known, 'there are')}"
