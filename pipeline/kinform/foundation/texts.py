"""Texts that are read from files: bounded in size, UTF-8; and JSON of them, bounded in depth."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, Boundary
from kinform.foundation.regular_files import not_a_file

JSON_DEPTH = 32
"""Deepest nesting of brackets in a JSON file: those that kinform writes have five, and Python's parser recurses."""
JSON_DIGITS = 18
"""Most digits of a whole number in a JSON file: those of a 64-bit integer."""
JSON_NAME = 40
"""Characters of a name that a message shows. Chosen, not measured."""
JSON_LARGEST = 1e60
"""The largest magnitude of a number in a JSON file: moments of inertia of mountains in g·mm² are smaller, and cubes of
it are still finite."""


_JSON_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*+"?|[\[{]|[\]}]', re.DOTALL)


class TextError(Exception):
    """A file is no text that can be read: what is wrong, and what to do about it ("" where only the caller knows)."""

    def __init__(self, message: str, remedy: str = ""):
        self.message, self.remedy = message, remedy
        super().__init__(message)


def read_text(path: Path, most: int, what: str, boundary: Boundary | None = None) -> str:
    """The UTF-8 text of a file of at most so many bytes, without its byte order mark; `what` it should be, and where it
    may lie if not everywhere. Lines end in a line feed, or all of them in a carriage return: one among other line ends
    shows a reader one line, such as a comment, where there are two. Raises TextError."""
    if boundary is not None and not boundary.allows(path):
        raise TextError(OUTSIDE, OUTSIDE_REMEDY)
    fault = not_a_file(path)
    if fault is not None:
        raise TextError(fault, f"write it to a file, and name {what}")
    try:
        with open(path, "rb") if boundary is None else boundary.open(path) as stream:
            data = stream.read(most + 1)
    except OSError as error:
        raise TextError(f"cannot be read: {error.strerror or error}") from None
    if len(data) > most:
        raise TextError(f"is larger than {most >> 20} MiB, and {what} is not", f"name {what}, or divide it")
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise TextError(f"is not UTF-8 text (byte {error.start})", "save it as UTF-8") from None
    alone = text.find("\r")
    if alone >= 0 and "\n" in text:
        line = text.count("\n", 0, alone) + 1
        raise TextError(f"has a carriage return without line feed in line {line}", "remove it, or end the line there")
    return text


def parse_json(text: str) -> Any:
    """The value of a JSON text, all of whose numbers are finite; raises ValueError where it is none, nests too deep,
    has a number too long to be one, or gives a name twice in one object."""
    depth = 0
    for token in _JSON_TOKEN.finditer(text):
        if token[0] in "[{":
            depth += 1
            if depth > JSON_DEPTH:
                line = text.count("\n", 0, token.start()) + 1
                raise ValueError(f"more than {JSON_DEPTH} brackets in each other at line {line}")
        elif token[0] in "]}":
            depth -= 1
    return json.loads(
        text, parse_float=_finite, parse_int=_whole, parse_constant=_no_constant, object_pairs_hook=_each_once
    )


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A table; of a name that is given twice readers would take one or the other."""
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the name {twice[:JSON_NAME]!r} is given twice in one object")
    return table


def _finite(text: str) -> float:
    value = float(text)
    if not abs(value) <= JSON_LARGEST:
        raise ValueError(f"the number {text[:JSON_DIGITS]} is too large")
    return value


def _whole(text: str) -> int:
    if len(text) > JSON_DIGITS:
        raise ValueError(f"a whole number of {len(text)} digits, and {JSON_DIGITS} are the most")
    return int(text)


def _no_constant(text: str) -> None:
    raise ValueError(f"{text} is no number in JSON")
