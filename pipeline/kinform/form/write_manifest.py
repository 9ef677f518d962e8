"""The tables of a manifest as TOML: the manifest that says what a description says, in full."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from kinform.form.problems import Problems
from kinform.form.readers.assembly import load
from kinform.form.sources import AS_IT_IS, Reading, Source, source_tables
from kinform.form.without_manifest import proposals
from kinform.foundation.boundary import Boundary
from kinform.foundation.escapes import toml
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def init_from_source(
    path: Path,
    *,
    relative_to: str | Path = ".",
    reading: Reading = AS_IT_IS,
    fastened: Callable[[Assembly], Sequence[tuple[Sequence[str], str]]] | None = None,
    jointed: Callable[[Assembly], Sequence[tuple[IntendedJoint, str]]] | None = None,
) -> str:
    """Text of a manifest that is equivalent to a source; meshes are named relative to the folder `relative_to`.

    A CAD or scene file has no function: what `fastened` and `jointed` propose is added as `init_manifest` does. Raises
    InputError with every problem.
    """
    problems = Problems()
    folder = Path(os.path.realpath(relative_to))
    boundary = Boundary(path, packages=(package for _, package in reading.packages))
    tables = source_tables(Source(path, path.name, folder, None, problems, reading, boundary))
    problems.raise_if_any()
    assert tables is not None
    notes = [f"# {' '.join(note.split())}" for note in tables.notes]
    if tables.described:
        tables.raw.setdefault("check", {"profile": "description"})
    lines = ["schema = 1", *notes, *_tables(tables.raw, ())]
    if not tables.described:
        assembly = load(path, reading=reading)
        lines += proposals(assembly, tables.raw["assembly"]["units"], fastened, jointed)
    return "\n".join(lines) + "\n"


def _tables(tables: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    """Lines of a table, its own keys first."""
    plain = {key: value for key, value in tables.items() if not _is_table(value) and key != "schema"}
    lines = [f"{_key(key)} = {_value(value)}" for key, value in plain.items()]
    for key, value in tables.items():
        name = ".".join(map(_key, (*path, key)))
        if isinstance(value, dict) and not plain.get(key):
            lines += ["", f"[{name}]", *_tables(value, (*path, key))]
        elif _is_table(value):
            for table in value:
                lines += ["", f"[[{name}]]", *(f"{_key(k)} = {_value(v)}" for k, v in table.items())]
    return lines


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and all(isinstance(item, dict) for item in value))


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else toml(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return toml(value)
    if isinstance(value, float):
        return ("-inf" if value < 0 else "inf") if math.isinf(value) else repr(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return str(value)
