"""One manifest of the hierarchy while it is read: its frame, its units, its prefix, and its lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from kinform.form.constants import MANIFEST_BYTES
from kinform.form.files import DesignFiles, is_mesh
from kinform.form.keys import changed
from kinform.form.manifest import Manifest
from kinform.form.manifest.parts import Part
from kinform.form.problems import Problems
from kinform.form.readers import pydantic_errors
from kinform.form.readers.overrides import Overlay
from kinform.form.readers.places import Left, Lines, Places
from kinform.form.readers.toml_lines import LineTable
from kinform.form.readers.toml_lines import Path as KeyPath
from kinform.form.readers.toml_text import TomlError, read_toml
from kinform.form.sources import Source as SourceFile
from kinform.form.sources import SourceTables, is_scene, is_source, source_tables, unread
from kinform.foundation.boundary import Boundary
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.texts import TextError, read_text
from kinform.foundation.units import UNITS, metres_per
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Source

if TYPE_CHECKING:
    from kinform.formats.description.facts import Facts


@dataclass(frozen=True, eq=False)
class Scope:
    """A parsed manifest and where it stands in the whole. `X_WF` is the pose of its frame in the world."""

    manifest: Manifest
    lines: Lines
    file: str
    """As shown to people: relative to the folder of the top manifest."""
    folder: Path
    prefix: str
    """"" for the top manifest, else "yaw_motor/"."""
    X_WF: Array
    problems: Problems
    refused: frozenset[str]
    """Names of tables that cannot be used: they have been complained of."""
    notes: tuple[str, ...] = ()
    """What the reader of a description did on its own account, in sentences."""
    described: bool = False
    """Whether a robot description says it, alone or as `from`."""
    facts: Facts | None = None
    """What that description says word for word."""
    boundary: Boundary | None = None
    """Where the files lie that it may name; None: everywhere."""

    @property
    def metres(self) -> float:
        """Metres in one unit of length of this manifest."""
        return metres_per(self.manifest.assembly.units)

    def of_scene(self, table: Part) -> bool:
        """Whether a part is of a CAD or scene file, whose names tell the groups that it is in."""
        source = self.manifest.assembly.from_ or ""
        return any(is_scene(Path(name)) for name in (self.file, source, table.mesh or "") if name)

    def line(self, *path: str | int) -> int:
        """Line of a key."""
        key: KeyPath = path
        return self.lines.line(key)

    def where(self, *path: str | int) -> tuple[str, int]:
        """File and line of a key."""
        return self.lines.file(path) or self.file, self.line(*path)

    def tables(self, *keys: str) -> Iterator[tuple[tuple[Any, ...], Any]]:
        """The tables of an array such as "function", "joint", each with its path."""
        value: Any = self.manifest
        for key in keys:
            value = () if value is None else getattr(value, key)
        for k, table in enumerate(value or ()):
            yield (*keys, k), table

    def local_names(self, names: Iterable[str]) -> Iterator[str]:
        """Those of the full names that this manifest can say, as it says them."""
        return (name.removeprefix(self.prefix) for name in names if name.startswith(self.prefix))

    def source(self, *path: str | int) -> Source:
        """File and line of a key, as the model keeps them."""
        return Source(*self.where(*path))

    def complain(self, message: str, remedy: str, *path: str | int) -> None:
        """Note a problem at a key."""
        self.problems.add(message, *self.where(*path), remedy)

    def point(self, stated: list[float] | None) -> Array | None:
        """A point of this manifest in the world (m)."""
        if stated is None:
            return None
        return np.asarray(self.X_WF[:3, :3] @ (np.array(stated) * self.metres) + self.X_WF[:3, 3])

    def vector(self, stated: list[float] | None) -> Array | None:
        """A vector without unit of length, turned into the world."""
        return None if stated is None else np.asarray(self.X_WF[:3, :3] @ np.array(stated, dtype=float))

    def direction(self, stated: list[float] | None, *path: str | int) -> Array | None:
        """A unit vector in the world; a zero one is a problem."""
        vector = self.vector(stated)
        if vector is None:
            return None
        size = float(np.linalg.norm(vector))
        if size == 0.0:
            self.complain("an axis or direction is zero", "give a direction such as [0, 0, 1]", *path)
            return np.array([0.0, 0.0, 1.0])
        return vector / size


@dataclass(frozen=True, eq=False)
class Parsed:
    """A manifest as far as it can be used, its lines, the names of tables that cannot be, and notes of its source."""

    manifest: Manifest
    lines: Lines
    refused: frozenset[str]
    notes: tuple[str, ...] = ()
    described: bool = False
    facts: Facts | None = None


Changes = Sequence[tuple[tuple[str, ...], Any]]
"""Paths and values."""


def parse(path: Path, file: str, files: DesignFiles, problems: Problems, changes: Changes = ()) -> Parsed | None:
    """The manifest at `path`, or the tables that a description says, with these changes; every problem is noted. None
    when nothing can be used."""
    if is_source(path):
        tables = _from_source(path, file, path.parent, None, files, problems)
        raw = None if tables is None else _changed(tables.raw, file, changes, problems)
        parsed = None if tables is None or raw is None else _validated(raw, tables.places, file, tables.notes, problems)
        return None if tables is None or parsed is None else _of_source(parsed, tables)
    foreign = unread(path)
    if foreign is not None:
        problems.add(foreign[0], file, None, foreign[1])
        return None
    try:
        text = read_text(path, MANIFEST_BYTES, "a manifest", files.boundary)
        raw = read_toml(text)
    except TextError as error:
        problems.add(error.message, file, None, error.remedy or "name a manifest (TOML)")
        return None
    except TomlError as error:
        other = f"; if it is no manifest: {path.suffix} is not read, export STEP, GLB or 3MF"
        remedy = error.remedy + ("" if path.suffix.lower() in (".toml", "") else other)
        problems.add(error.message, file, error.line, remedy, error.column)
        return None
    lines = LineTable(text)
    stated = raw["assembly"].get("from") if isinstance(raw.get("assembly"), dict) else None
    if isinstance(stated, str) and stated:
        return _over_source(path, file, raw, lines, files, problems, changes)
    varied = _changed(raw, file, changes, problems)
    return None if varied is None else _validated(varied, lines, file, (), problems)


def _changed(raw: dict[str, Any], file: str, changes: Changes, problems: Problems) -> dict[str, Any] | None:
    """The tables with these changes; None where one leads nowhere, which is noted."""
    for steps, value in changes:
        try:
            raw = changed(raw, steps, value)
        except KeyError as error:
            problems.add(f"{'.'.join(steps)}: {error.args[0]}", file, None, "name a key of this file")
            return None
    return raw


def _of_source(parsed: Parsed, tables: SourceTables) -> Parsed:
    return replace(parsed, described=tables.described, facts=tables.facts)


def _validated(
    raw: dict[str, Any], lines: Lines, file: str, notes: tuple[str, ...], problems: Problems
) -> Parsed | None:
    try:
        return Parsed(Manifest.model_validate(raw), lines, frozenset(), notes)
    except ValidationError as error:
        pydantic_errors.report(error, raw, lines, file, problems)
        try:
            kept, dropped = pydantic_errors.without_errors(error, raw)
            refused = frozenset(pydantic_errors.names_of(dropped, raw))
            return Parsed(Manifest.model_validate(kept), Left(lines, dropped), refused, notes)
        except ValidationError:
            return None


def _from_source(
    path: Path, file: str, folder: Path, units: str | None, files: DesignFiles, problems: Problems
) -> SourceTables | None:
    """The tables of a source; its files are noted."""
    tables = source_tables(SourceFile(path, file, folder, units, problems, files.reading, files.boundary))
    if tables is not None:
        files.unsettled |= tables.unsettled
        for other in tables.files:
            files.note(other)
        files.hash_meshes([other for other in tables.files if is_mesh(other)])
    return tables


def _over_source(
    path: Path,
    file: str,
    raw: dict[str, Any],
    lines: LineTable,
    files: DesignFiles,
    problems: Problems,
    changes: Changes,
) -> Parsed | None:
    """A manifest over the tables that its `from` gives."""
    key = ("assembly", "from")
    stated = raw["assembly"]["from"]
    below = files.find(stated, path.parent, file, lines.line(key), "the source")
    if below is None:
        return None
    if not is_source(below):
        problems.add(f"from = {in_quotes(stated)} is no description or assembly file", file, lines.line(key),
                     "name a URDF, SDF, MJCF, STEP, GLB or 3MF; a manifest goes into a [[subassembly]]")  # fmt: skip
        return None
    units = raw["assembly"].get("units")
    tables = _from_source(below, files.shown(below), path.parent, units if units in UNITS else None, files, problems)
    if tables is None:
        return None
    named = {part["name"] for part in tables.raw.get("part", [])}
    parts = raw.get("part")
    for k, part in enumerate(parts if isinstance(parts, list) else ()):
        if isinstance(part, dict) and not {"mesh", "shape"} & set(part) and part.get("name") not in named:
            name = str(part.get("name"))
            message = f"[[part]] {in_quotes(name)} has no mesh, and {stated} has no part of that name"
            problems.add(message, file, lines.line(("part", k)), did_you_mean(name, named, "its parts"))
    above = Places({at: (None, line) for at, line in lines.items()})
    overlay = Overlay(above, tables.places)
    both = overlay.tables(raw, tables.raw)
    other = _changed(both, file, changes, problems)
    parsed = None if other is None else _validated(other, Places(overlay.places), file, tables.notes, problems)
    return None if parsed is None else _of_source(parsed, tables)
