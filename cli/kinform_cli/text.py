"""Numbers, lengths, directions and remarks as people read them, and values for machines."""

from __future__ import annotations

import json
import math
import re
import shlex
import textwrap
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from kinform.foundation import words
from kinform.foundation.escapes import json_text
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass

if TYPE_CHECKING:
    from kinform.design import Design
    from kinform.model.assembly import Assembly

FINE = 1e-5
"""Share of the largest part to which places are written: 0.001 mm in 100 mm. Chosen, not measured; the JSON has every
digit."""
NO_LENGTH = 1e-9
"""Metres below which a length is written as zero: nobody makes a billionth of a metre."""
FEW, MANY = 0.01, 1e4
"""A quantity is written in thousandths of its unit below, in thousands from there on: else it has leading zeros, or
five digits before the point."""
LARGE = 10.0
"""m: diagonal of a part from which on places are told in m; a choice."""


NONE = "–"
"""What stands where there is no value."""


def command(*words: object) -> str:
    """The words as a command line that a shell reads as they are, whatever blanks are in them."""
    return shlex.join(map(str, words))


def wrapped(text: str, width: int) -> str:
    """The text with no line longer than `width`, unless one word is; what goes on keeps the margin of its line. Lines
    that follow each other in a paragraph are joined where one was too long."""
    return "\n\n".join(_paragraph(part, width) for part in text.rstrip("\n").split("\n\n")) + "\n"


def hanging(text: str, width: int) -> str:
    """The text with no line longer than `width`, unless one word is; what goes on is indented by two blanks more."""
    lines = []
    for line in text.split("\n"):
        margin = " " * (len(line) - len(line.lstrip()) + 2)
        lines += textwrap.wrap(
            line, width, subsequent_indent=margin, break_long_words=False, break_on_hyphens=False,
            replace_whitespace=False,
        ) or [""]  # fmt: skip
    return "\n".join(lines)


def _paragraph(text: str, width: int) -> str:
    lines = text.split("\n")
    if max(map(len, lines)) <= width:
        return text
    joined: list[str] = []
    for line in lines:
        if joined and not line.startswith((" ", "-", "*", "|")) and not re.match(r"[A-Z][A-Za-z ]+: ", line):
            joined[-1] += " " + line
        else:
            joined.append(line)
    out = []
    for line in joined:
        margin = " " * (len(line) - len(line.lstrip()))
        out += textwrap.wrap(line, width, subsequent_indent=margin, break_long_words=False, break_on_hyphens=False)
    return "\n".join(out)


def number(value: float | None) -> str:
    """Four significant digits, no trailing zeros; a dash for what is unknown."""
    if value is None or math.isnan(value):
        return NONE
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    return words.number(value + 0.0)


def singular(value: float) -> str:
    """A singular value, zero where it is rounding."""
    return number(0.0 if abs(value) < SOLVED else value)


def scaled(unit: str, most: float) -> tuple[str, float]:
    """The unit with the prefix in which a value so large reads well, and how many of it are one of the unit: ("mN·m",
    1000.0)."""
    size = abs(most)
    if not math.isfinite(size) or size == 0.0 or FEW <= size < MANY:
        return unit, 1.0
    if size >= MANY:
        return f"k{unit}", 1e-3
    return (f"m{unit}", 1e3) if size >= 1e-3 * FEW else (f"µ{unit}", 1e6)


def quantity(value: float, unit: str) -> str:
    """The value with its unit: "1.515 mN·m"."""
    shown, factor = scaled(unit, value)
    return f"{number(factor * value)} {shown}"


def _rounded(value: float, decimals: int) -> str:
    text = f"{value:.{max(decimals, 0)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def degrees(radians: float) -> str:
    """An angle in degrees, to four decimals."""
    return f"{_rounded(math.degrees(radians), 4)}°" if math.isfinite(radians) else number(radians)


def vector(direction: Iterable[float] | None) -> str:
    """A direction: x, y or z where it is one to four decimals, else its components."""
    if direction is None:
        return NONE
    rounded = [round(float(component), 4) + 0.0 for component in direction]
    for name, unit in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        if rounded == unit:
            return name
    return ", ".join(f"{component:g}" for component in rounded)


@dataclass(frozen=True)
class Lengths:
    """Lengths without the name of their unit, as findings tell them: in mm where the assembly has metric units, places
    of very large ones in m; else in the unit of the assembly."""

    unit: str
    metres: float
    """A unit of places."""
    small: str
    """The unit of gaps, areas and volumes."""
    small_metres: float
    decimals: int
    """Of places."""
    nothing: float = NO_LENGTH
    """m: what is shorter is written as zero."""

    @staticmethod
    def of(assembly: Assembly) -> Lengths:
        """As fine as the parts of that assembly call for."""
        from kinform.foundation.units import metres_per

        largest = assembly.largest
        metric = assembly.units in ("m", "cm", "mm")
        unit = assembly.units if not metric else "m" if largest >= LARGE else "mm"
        metres = metres_per(unit)
        fine = FINE * (largest or 1.0) / metres
        small = "mm" if metric else assembly.units
        nothing = max(NO_LENGTH, SINGLE * largest)
        return Lengths(unit, metres, small, metres_per(small), math.ceil(-math.log10(fine)), nothing)

    def length(self, metres: float | None) -> str:
        """A gap, a depth, a pitch: to four digits, and zero where it is rounding."""
        if metres is None or not math.isfinite(metres):
            return number(metres)
        return number(0.0 if abs(metres) < self.nothing else metres / self.small_metres)

    def place(self, metres: float) -> str:
        """A coordinate, to as many decimals as the parts call for."""
        return _rounded(metres / self.metres, self.decimals)

    def point(self, point: Iterable[float] | None) -> str:
        """Three coordinates."""
        if point is None:
            return NONE
        coordinates = [float(x) for x in point]
        if not all(map(math.isfinite, coordinates)):
            return NONE
        return ", ".join(map(self.place, coordinates))

    def area(self, square_metres: float) -> str:
        """An area."""
        return number(square_metres / self.small_metres**2)

    def volume(self, cubic_metres: float) -> str:
        """A volume."""
        return number(cubic_metres / self.small_metres**3)


def ground_note(design: Design) -> str | None:
    """Which body was taken as the ground, where the manifest does not say."""
    if design.assembly.ground is not None:
        return None
    assert design.kinematics is not None
    chosen = [body.name for body in design.kinematics.bodies if body.ground]
    return (
        f"note: no ground is stated: {', '.join(chosen)} is taken, as the heaviest (else the largest) body; "
        'ground = "PART" in [assembly] chooses another'
    )


def dumps(value: Any) -> str:
    """JSON text of a value; null for what is not a finite number."""
    from kinform.reports.values.plain import plain

    return json_text(json.dumps(plain(value), indent=1, allow_nan=False))
