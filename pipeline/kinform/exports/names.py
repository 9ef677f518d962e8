"""Names for other languages: each user's name becomes one identifier, and no two become the same.

Names that are identifiers already stay as they are; the others are spelt with the letters that the
language has, and numbered where they would collide. The result depends on the set of names, not on their
order.
"""

from __future__ import annotations

import re
import sys
import unicodedata
from collections.abc import Container, Iterable

from kinform.foundation.escapes import lines, one_line
from kinform.frozen import dataclass


@dataclass(frozen=True)
class Language:
    """What a name may be. `reserved` in lower case when `folds`."""

    reserved: frozenset[str] = frozenset()
    folds: bool = False
    """Upper and lower case are the same."""
    letters: str = "A-Za-z0-9_"
    """What names are made of, as in a regular expression; "" for any text."""
    first: str = "A-Za-z"
    """What they begin with."""
    longest: int = sys.maxsize
    """Letters after which they are cut."""
    stem: bool = False
    """What stands before the first dot must not be reserved: as of files on Windows."""

    def spell(self, name: str) -> str:
        """The name as an identifier, whatever else may have the same."""
        if not self.letters:
            text = "".join("_" if unicodedata.category(c) in ("Cc", "Cs", "Cn") else c for c in name).strip() or "_"
            text = re.sub(":{2,}", "_", text) if "__" in self.reserved else text
            if self._taken(text):
                text = text.strip("_") or "unnamed" if text.startswith("__") else f"{text}_"
            return text
        plain = "".join(_plain(c) for c in unicodedata.normalize("NFKD", name))
        text = re.sub(f"[^{self.letters}]+", "_", plain)
        text = re.sub("_+", "_", text).strip("_.-") or "unnamed"
        if not re.match(f"[{self.first}]", text):
            text = f"n{text}"
        if len(text) > self.longest:
            text = text[: self.longest].rstrip("_.-")
        if not self._taken(text):
            return text
        stem, dot, rest = text.partition(".") if self.stem else (text, "", "")
        return f"{stem}_x{dot}{rest}"

    def _taken(self, text: str) -> bool:
        text = text.partition(".")[0] if self.stem else text
        return (text.lower() if self.folds else text) in self.reserved or (
            "__" in self.reserved and text.startswith("__") and text.endswith("__")
        )

    def key(self, text: str) -> str:
        """What makes two identifiers the same."""
        return text.casefold() if self.folds else text


def identifiers(
    names: Iterable[str], language: Language, *, beside: Iterable[str] = (), suffixes: Iterable[str] = ("",)
) -> dict[str, str]:
    """An identifier for each name; none, with any of the suffixes, is one of `beside` or the same as another."""
    out: dict[str, str] = {}
    used = {language.key(name) for name in beside}
    ends = tuple(suffixes)
    ordered = sorted(set(names))
    spelt = {name: language.spell(name) for name in ordered}
    for name in sorted(ordered, key=lambda n: (spelt[n] != n, n)):
        identifier, number = spelt[name], 2
        while any(language.key(identifier + end) in used for end in ends):
            identifier, number = f"{spelt[name]}_{number}", number + 1
        used.update(language.key(identifier + end) for end in ends)
        out[name] = identifier
    return out


def free_name(name: str, taken: Container[str]) -> str:
    """The name, or the name with underscores behind it where it is taken."""
    while name in taken:
        name += "_"
    return name


def comment(text: str) -> str:
    """Text for a comment: on one line, and without two hyphens in a row or what ends a comment."""
    flat = lines(one_line(text)).replace("*/", "* /")
    while "--" in flat:
        flat = flat.replace("--", "- -")
    return flat


def _plain(character: str) -> str:
    """ASCII for a character: accents go, other letters become their number."""
    if character.isascii():
        return character
    if unicodedata.combining(character):
        return ""
    return f"u{ord(character):x}" if character.isalnum() else "_"


_VHDL = """abs access across after alias all and architecture array assert attribute begin block body break buffer
bus case component configuration constant disconnect downto else elsif end entity exit file for function generate
generic group guarded if impure in inertial inout is label library limit linkage literal loop map mod nand nature new
next noise nor not null of on open or others out package port postponed procedural procedure process pure quantity
range record reference register reject rem report return rol ror select severity shared signal sla sll spectrum sra
srl subnature subtype terminal then through to tolerance transport type unaffected units until use variable wait when
while with xnor xor
work std ieee boolean bit character integer real time natural positive string real_vector delay_length true false note
warning error failure now domain math_pi sin cos sqrt"""

_MODELICA = """algorithm and annotation as assert block break class connect connector constant constrainedby der
discrete each else elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow
for function if import impure in initial inner input loop model not operator or outer output package parameter partial
protected public pure record redeclare replaceable return stream then true type when while within
Real Integer Boolean String time abs sign sqrt sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10 cross
skew transpose identity zeros ones fill sum product max min size pre edge change sample reinit terminate noEvent smooth
delay cardinality homotopy Modelica Connections StateSelect"""

VHDL = Language(frozenset(_VHDL.split()), folds=True)
"""Basic identifiers of IEEE 1076.1; extended ones are rarely supported."""
MODELICA = Language(frozenset(_MODELICA.split()))
XML = Language(letters="")
"""Attributes hold any text but control characters."""
MJCF = Language(frozenset({"world"}), letters="")
"""Any text but the name of the ground."""
SDF = Language(frozenset({"world", "__"}), letters="")
"""Any text but "::", "world" and names between double underscores."""
FILES = Language(
    frozenset("con prn aux nul com1 com2 com3 com4 com5 com6 com7 com8 com9 lpt1 lpt2 lpt3".split()),
    folds=True,
    letters="A-Za-z0-9_.-",
    first="A-Za-z0-9_",
    longest=120,
    stem=True,
)
"""Names of files on any system: with a number and an ending behind them they stay below the 143 bytes that encrypted
folders take (eCryptfs)."""
