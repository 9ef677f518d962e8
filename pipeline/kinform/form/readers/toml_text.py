"""A TOML text as values, after a look at what would cost more than it says: depth, long keys, long numbers.

tomllib reads dotted keys and nested brackets of any depth, by recursion, and numbers of any length; some of that raises
what is no TOMLDecodeError. Strings and comments are passed over here; nothing else is judged.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any

from kinform.form.constants import BARE_LENGTH, MANIFEST_DEPTH
from kinform.foundation.words import counted

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
_PLACE = re.compile(r"\(at line (\d+), column \d+\)")


class TomlError(Exception):
    """A text is no TOML, or more than is read of one: what is wrong, at which line, and what to do about it."""

    def __init__(self, message: str, line: int, remedy: str):
        self.message, self.line, self.remedy = message, line, remedy
        super().__init__(f"{message} at line {line}")


def read_toml(text: str) -> dict[str, Any]:
    """The values of a TOML text; raises TomlError."""
    for start, message, remedy in _excesses(text):
        raise TomlError(message, text.count("\n", 0, start) + 1, remedy)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        said = str(error)
        place = _PLACE.search(said)
        line = int(place[1]) if place else text.count("\n") + 1
        message = "not valid TOML: " + _PLACE.sub("", said).replace("(at end of document)", "").strip()
        raise TomlError(message, line, "correct the syntax: see toml.io") from None


def _excesses(text: str) -> Iterator[tuple[int, str, str]]:
    """Position, message and remedy of what nests too deep, or is too long."""
    depth = 0
    for token in _TOKEN.finditer(text):
        if token["open"]:
            depth += 1
            if depth > MANIFEST_DEPTH:
                message = f"arrays and tables in each other more than {MANIFEST_DEPTH} deep"
                yield token.start(), message, "remove brackets: the manifest needs six at most"
        elif token["close"]:
            depth = max(depth - 1, 0)
        elif token["dotted"]:
            steps = _STEP.findall(token[0]) if len(token[0]) > MANIFEST_DEPTH else ()
            if len(steps) > MANIFEST_DEPTH:
                message = f"a key of {counted(len(steps), 'step')} between dots; {MANIFEST_DEPTH} are the most"
                yield token.start(), message, "shorten it: no key of the manifest has more than four"
            longest = max((len(step) for step in steps if step[0] not in "\"'"), default=0)
            if longest > BARE_LENGTH:
                message = f"a key or number of {longest} characters; {BARE_LENGTH} are the most"
                yield token.start(), message, "shorten it"
