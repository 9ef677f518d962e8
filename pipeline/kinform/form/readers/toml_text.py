"""A TOML text as values, after a look at what would cost more than it says: depth, long keys, long numbers.

tomllib reads dotted keys and nested brackets of any depth, by recursion, and numbers of any length; some of that raises
what is no TOMLDecodeError. Strings and comments are passed over here; nothing else is judged.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any

from kinform.form.constants import NAME_LENGTH
from kinform.foundation.words import counted

MANIFEST_DEPTH = 8
"""Tables in tables, arrays in arrays, and keys between dots: schema 1 goes six deep."""
MANIFEST_VALUES = 250_000
"""Keys and values of a manifest, those in arrays counted one by one: 10,000 parts with poses have 200,000. The place of
each is kept, which takes 10 µs."""
_KEY = r"(?:[A-Za-z0-9_+:-]++|\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+')"
_TOKEN = re.compile(
    rf"""
    (?P<comment> \#[^\n]*+ )
  | (?P<long> \"\"\"(?:[^\"\\]|\\.|\"(?!\"\"))*+\"{{3,5}} | '''(?:[^']|'(?!''))*+'{{3,5}} )
  | (?P<dotted> {_KEY}(?:[\ \t]*+\.[\ \t]*+{_KEY})*+ )
  | (?P<open> [\[{{] )
  | (?P<close> [\]}}] )
    """,
    re.VERBOSE | re.DOTALL,
)
_STEP = re.compile(_KEY)
_PLACE = re.compile(r"\(at (?:line (\d+), column (\d+)|end of document)\)")


class TomlError(Exception):
    """A text is no TOML, or more than is read of one: what is wrong, at which line and column (from 1), and what to do
    about it."""

    def __init__(self, message: str, place: tuple[int, int], remedy: str):
        self.message, (self.line, self.column), self.remedy = message, place, remedy
        super().__init__(f"{message} at line {self.line}, column {self.column}")


def read_toml(text: str) -> dict[str, Any]:
    """The values of a TOML text; raises TomlError."""
    for start, message, remedy in _excesses(text):
        raise TomlError(message, _place(text, start), remedy)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        said = str(error)
        told = _PLACE.search(said)
        place = (int(told[1]), int(told[2])) if told and told[1] else _place(text, len(text))
        message = "not valid TOML: " + _PLACE.sub("", said).strip()
        raise TomlError(message, place, "correct the syntax: see toml.io") from None


def _place(text: str, position: int) -> tuple[int, int]:
    """Line and column of a character of the text, from 1."""
    return text.count("\n", 0, position) + 1, position - text.rfind("\n", 0, position)


def _excesses(text: str) -> Iterator[tuple[int, str, str]]:
    """Position, message and remedy of what nests too deep, or is too long."""
    depth = count = 0
    for token in _TOKEN.finditer(text):
        if token["open"]:
            depth += 1
            if depth > MANIFEST_DEPTH:
                message = f"arrays and tables in each other more than {MANIFEST_DEPTH} deep"
                yield token.start(), message, "remove brackets: the manifest needs six at most"
        elif token["close"]:
            depth = max(depth - 1, 0)
        elif token["dotted"]:
            count += 1
            if count > MANIFEST_VALUES:
                message = f"more than {MANIFEST_VALUES:,} keys and values"
                yield token.start(), message, "divide the manifest; long tables go into CSV files"
            steps = _STEP.findall(token[0]) if len(token[0]) > MANIFEST_DEPTH else ()
            if len(steps) > MANIFEST_DEPTH:
                message = f"a key of {counted(len(steps), 'step')} between dots; {MANIFEST_DEPTH} are the most"
                yield token.start(), message, "shorten it: no key of the manifest has more than four"
            longest = max((len(step) for step in steps if step[0] not in "\"'"), default=0)
            if longest > NAME_LENGTH:
                message = f"a key or number of {longest} characters; {NAME_LENGTH} are the most"
                yield token.start(), message, "shorten it"
