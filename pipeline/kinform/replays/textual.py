"""Textual witnesses, read again from the file as text: no reader of the format takes part."""

from __future__ import annotations

import math
import re

from kinform.form.constants import TEXT_BYTES
from kinform.foundation.escapes import one_line
from kinform.model.findings import Witness
from kinform.replays.files import Files
from kinform.replays.outcome import NotReplayed, Outcome, held, refuted

ELEMENT_LINES = 200
"""Lines of an element or a table that are looked at."""
VALUE_OFF = 1e-9
"""Share by which a number may differ from the one in the file: rounding of a unit."""

_HEADER = re.compile(r"\[\[?[^\[\],=]*\]\]?\s*(#.*)?$")
"""Of a table of TOML; rows of arrays have commas."""
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def replay(witness: Witness, files: Files) -> Outcome:
    """Whether a file states what the witness says. Raises NotReplayed."""
    if witness.source_file is None or witness.source_line is None:
        raise NotReplayed("the witness names no line")
    if not (witness.states or witness.lacks or witness.missing):
        raise NotReplayed("the witness states no text")
    where = f"{one_line(witness.source_file)}:{witness.source_line}"
    try:
        lines = files.read(witness.source_file, TEXT_BYTES).decode("utf-8-sig").replace("\r\n", "\n").split("\n")
    except UnicodeDecodeError:
        raise NotReplayed(f"{one_line(witness.source_file)} is not UTF-8 text") from None
    if not 1 <= witness.source_line <= len(lines):
        return refuted(f"{one_line(witness.source_file)} has no line {witness.source_line}")
    text = _element(lines, witness.source_line - 1)
    for stated in witness.states or ():
        if not _stands(stated, text):
            if why := _may_be_elsewhere(lines, text):
                raise NotReplayed(f"{where}: {why}")
            return refuted(f"{where} does not state {one_line(stated)}")
    for key in witness.lacks or ():
        if re.search(rf"(?<![\w-]){re.escape(key)}(?![\w-])", text):
            return refuted(f"{where} states {one_line(key)}")
    if witness.missing is not None and files.is_there(witness.missing):
        return refuted(f"{one_line(witness.missing)} is there")
    return held(f"{where} reads so")


def _element(lines: list[str], start: int) -> str:
    """The element of XML or JSON, the table of TOML, or the line that begins there."""
    first = lines[start].lstrip()
    several = lines[start : start + ELEMENT_LINES]
    if _HEADER.match(first):
        ends = (k for k, line in enumerate(several) if k and _HEADER.match(line.lstrip()))
        return "\n".join(several[: next(ends, len(several))])
    if "<" in first:
        text = "\n".join(several)
        name = re.match(r"[^<]*<([\w:.-]+)", text)
        if name is None:
            return lines[start]
        # up to its end tag, or to that of its start where it has none
        close, whole = re.search(rf"</{re.escape(name[1])}\s*>", text), re.match(r"[^<]*<[^<>]*/>", text)
        return whole[0] if whole is not None else text[: close.end()] if close is not None else text
    return lines[start]


def _stands(stated: str, text: str) -> bool:
    """Whether a name, or a number of its value, in radians or degrees where it is an angle, stands there."""
    try:
        value = float(stated)
    except ValueError:
        return re.search(rf"(?<![\w-]){re.escape(stated)}(?![\w-])", text) is not None
    tokens = [float(token) for token in _NUMBER.findall(text)]
    values = (value, math.degrees(value))
    return any(abs(token - one) <= VALUE_OFF * abs(one) for token in tokens for one in values)


def _may_be_elsewhere(lines: list[str], text: str) -> str:
    """Why what is not there may be stated elsewhere; "" where it may not."""
    if "${" in text or "$(" in text:
        return "an expression of xacro stands there"
    return "MJCF may state it in its defaults" if any("<mujoco" in line for line in lines) else ""
