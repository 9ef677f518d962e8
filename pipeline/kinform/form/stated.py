"""What a design states at a path, as its files have it: a manifest, a description or scene, or a manifest over one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from kinform.errors import InputError, Problem
from kinform.form.constants import MANIFEST_BYTES
from kinform.form.keys import looked_up
from kinform.form.problems import Problems
from kinform.form.readers.toml_text import TomlError, read_toml
from kinform.form.sources import AS_IT_IS, Source, is_source, source_tables
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY, Boundary
from kinform.foundation.texts import TextError, read_text


def stated_value(design: Path, steps: Sequence[str], boundary: Boundary) -> Any:
    """The value at a path of names and numbers, in the units of the design. Raises InputError where its file cannot be
    read, and KeyError where nothing is there."""
    if is_source(design):
        return looked_up(_tables(design, boundary), steps)
    _, own = toml_of(design, "a manifest", boundary)
    assembly = own.get("assembly")
    below = assembly.get("from") if isinstance(assembly, dict) else None
    try:
        return looked_up(own, steps)
    except KeyError:
        if not isinstance(below, str) or not is_source(design.parent / below):
            raise
    return looked_up(_tables(design.parent / below, boundary), steps)


def toml_of(path: Path, what: str, boundary: Boundary) -> tuple[str, dict[str, Any]]:
    """The text of a TOML file, which should be `what`, and its values. Raises InputError."""
    try:
        text = read_text(path, MANIFEST_BYTES, what, boundary)
        return text, read_toml(text)
    except TextError as error:
        raise InputError([Problem(error.message, str(path), None, error.remedy or f"name {what}")]) from None
    except TomlError as error:
        raise InputError([Problem(error.message, str(path), error.line, error.remedy, error.column)]) from None


def _tables(path: Path, boundary: Boundary) -> dict[str, Any]:
    if not boundary.allows(path):
        raise InputError([Problem(OUTSIDE, str(path), None, OUTSIDE_REMEDY)])
    problems = Problems()
    tables = source_tables(Source(path, path.name, path.parent, None, problems, AS_IT_IS, boundary))
    problems.raise_if_any()
    assert tables is not None
    return tables.raw
