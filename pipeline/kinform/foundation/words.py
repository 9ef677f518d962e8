"""Numbers, names and places in an engineer's words; they cost no import, so that a run with nothing to do stays
quick."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from kinform.foundation.units import METRES_PER_UNIT

GREAT_MOMENT, FINE_MOMENT = 1.0, 1e-3
"""kg·m²: moments of inertia are shown in kg·m² where one is greater than the first, in kg·mm² where one is greater than
the second, else in g·mm²; so they have no exponents. A choice."""


def number(value: float, digits: int = 4) -> str:
    """The value with so many significant digits, without an exponent where that reads well."""
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-6 <= abs(value) < 1e9:
        text = f"{float(text):.12f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def length_unit(size: float, units: str) -> str:
    """The unit that shows a length of this size (m) in an assembly of these units."""
    if units in ("in", "ft"):
        return "ft" if units == "ft" and size >= 3.0 else "in"
    if units == "um" and size < 1e-3:
        return "um"
    return "m" if size >= 1.0 else "mm"


def length(value: float, units: str, digits: int = 4) -> str:
    """A length (m) with a unit that suits the assembly: "0.25 mm"."""
    unit = length_unit(abs(value), units)
    return f"{number(value / METRES_PER_UNIT[unit], digits)} {unit}"


def place(point: Iterable[float], units: str) -> str:
    """A point (m) as "(12.3, 0, -4) mm"."""
    values = [float(v) for v in point]
    unit = length_unit(max(abs(v) for v in values), units)
    rounded = (number(round(v / METRES_PER_UNIT[unit], 4), 6) for v in values)
    return f"({', '.join(rounded)}) {unit}"


def area(value: float, units: str) -> str:
    """An area (m²): "12.5 mm²"."""
    unit = length_unit(math.sqrt(abs(value)), units)
    return f"{number(value / METRES_PER_UNIT[unit] ** 2)} {unit}²"


def volume(value: float, units: str) -> str:
    """A volume (m³): "3.2 mm³"."""
    unit = length_unit(abs(value) ** (1.0 / 3.0), units)
    return f"{number(value / METRES_PER_UNIT[unit] ** 3)} {unit}³"


def mass(value: float, digits: int = 4) -> str:
    """A mass (kg): "12.5 g"."""
    return f"{number(1e3 * value, digits)} g" if abs(value) < 1.0 else f"{number(value, digits)} kg"


def moment_unit(most: float) -> tuple[str, float]:
    """The unit in which moments of inertia up to this one (kg·m²) read well, and how many of it are one kg·m²."""
    if most > GREAT_MOMENT:
        return "kg·m²", 1.0
    return ("kg·mm²", 1e6) if most > FINE_MOMENT else ("g·mm²", 1e9)


def angle(value: float, digits: int = 3) -> str:
    """An angle (rad) in degrees: "0.5°"."""
    return f"{number(math.degrees(value), digits)}°"


def rate(value: float, slides: bool, per_slides: bool, units: str) -> str:
    """A rate of one joint value by another (rad or m) as manifests have them, in degrees and lengths: "0.02 mm/°"."""
    own, per = (METRES_PER_UNIT[units] if slide else math.radians(1.0) for slide in (slides, per_slides))
    unit = "" if slides == per_slides else f" {units}/°" if slides else f" °/{units}"
    return f"{number(value * per / own, 6)}{unit}"


def direction(vector: Iterable[float]) -> str:
    """A direction as "(0, 0.942, 0.3351)": to four decimals, 0.006°; finer is rounding of meshes."""
    return f"({', '.join(number(round(float(v), 4) + 0.0) for v in vector)})"


def axis(direction: Iterable[float]) -> str:
    """A direction (3,) as x, -z, or its components."""
    values = [round(float(v), 4) + 0.0 for v in direction]
    for k, name in enumerate("xyz"):
        if abs(values[k]) == 1.0 and values.count(0.0) == 2:
            return name if values[k] > 0.0 else f"-{name}"
    return "(" + ", ".join(f"{v:g}" for v in values) + ")"


def telling(shown: Callable[[float, int], str], *values: float) -> Callable[[float], str]:
    """`shown` with as many significant digits, four at least, as tell the values apart: nothing is said to be "5 mm,
    required is at most 5 mm"."""
    different = len(set(values))
    digits = next((n for n in range(4, 13) if len({shown(value, n) for value in values}) >= different), 12)
    return lambda value: shown(value, digits)


def quoted(names: Iterable[str], limit: int = 4) -> str:
    """Names in quotes, with commas; beyond the limit "and 3 more"."""
    return few([f"'{name}'" for name in names], limit)


def few(words: Sequence[str], limit: int = 4) -> str:
    """Words with commas; beyond the limit "and 3 more"."""
    if len(words) > limit + 1:
        return ", ".join(words[:limit]) + f" and {len(words) - limit} more"
    return listed(words)


def by_cause(reasons: Iterable[tuple[str, str]]) -> str:
    """Pairs of what and why, each why once: "arm and hand: its mass is not known; slide: no law"."""
    return "; ".join(alike(f"{subject}: {why}" for subject, why in reasons))


def alike(sentences: Iterable[str]) -> list[str]:
    """Sentences "what: why", each why once, in the order of the first of each: "arm and hand: its mass is not known";
    others as they are."""
    subjects: dict[tuple[str, str], dict[str, None]] = {}
    for sentence in sentences:
        what, colon, why = sentence.partition(": ")
        subjects.setdefault((colon, why if colon else what), {})[what] = None
    return [f"{few(list(names))}{colon}{why}" if colon else why for (colon, why), names in subjects.items()]


def listed(words: Sequence[str]) -> str:
    """ "a", "a and b", "a, b and c"."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1] if words else ""]))


def shortened(name: str, room: int) -> str:
    """The name in so many characters at most, three at least: both ends, and "…" for its middle."""
    if len(name) <= room:
        return name
    kept = max(room - 1, 2)
    return f"{name[: kept - kept // 2]}…{name[-(kept // 2) :]}"


def shortened_ends(name: str, room: int) -> str:
    """The name shortened in its middle; that of a joint between two bodies in both of theirs."""
    first, between, second = name.partition("~")
    # both bodies keep three characters at least
    if not between or len(name) <= room or room < 9:
        return shortened(name, room)
    start = shortened(first, room - 1 - min((room - 1) // 2, len(second)))
    return f"{start}~{shortened(second, room - 1 - len(start))}"


def counted(count: int, noun: str, plural: str | None = None) -> str:
    """ "1 facet", "2 facets"."""
    return f"{count} {noun if count == 1 else plural or noun + 's'}"
