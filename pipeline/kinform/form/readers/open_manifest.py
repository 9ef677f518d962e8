"""One manifest of the hierarchy while it is read: its frame, its units, its prefix, and its lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from kinform.form.constants import MANIFEST_BYTES
from kinform.form.manifest import Manifest
from kinform.form.problems import Problems
from kinform.form.readers import pydantic_errors
from kinform.form.readers.toml_lines import LineTable
from kinform.form.readers.toml_lines import Path as KeyPath
from kinform.form.readers.toml_text import TomlError, read_toml
from kinform.foundation.texts import TextError, read_text
from kinform.foundation.units import metres_per
from kinform.model.arrays import Array
from kinform.model.assembly import Source


@dataclass(frozen=True, eq=False)
class Scope:
    """A parsed manifest and where it stands in the whole. `X_WF` is the pose of its frame in the world."""

    manifest: Manifest
    lines: LineTable
    file: str
    """As shown to people: relative to the folder of the top manifest."""
    folder: Path
    prefix: str
    """"" for the top manifest, else "yaw_motor/"."""
    X_WF: Array
    problems: Problems
    refused: frozenset[str]
    """Names of tables that cannot be used: they have been complained of."""

    @property
    def metres(self) -> float:
        """Metres in one unit of length of this manifest."""
        return metres_per(self.manifest.assembly.units)

    def line(self, *path: str | int) -> int:
        """Line of a key."""
        key: KeyPath = path
        return self.lines.line(key)

    def where(self, *path: str | int) -> tuple[str, int]:
        """File and line of a key."""
        return self.file, self.line(*path)

    def tables(self, *keys: str) -> Iterator[tuple[tuple[Any, ...], Any]]:
        """The tables of an array such as "function", "joint", each with its path."""
        value: Any = self.manifest
        for key in keys:
            value = () if value is None else getattr(value, key)
        for k, table in enumerate(value or ()):
            yield (*keys, k), table

    def local_names(self, names: Iterable[str]) -> list[str]:
        """Those of the full names that this manifest can say, as it says them."""
        return [name.removeprefix(self.prefix) for name in names if name.startswith(self.prefix)]

    def source(self, *path: str | int) -> Source:
        """File and line of a key, as the model keeps them."""
        return Source(*self.where(*path))

    def complain(self, message: str, remedy: str, *path: str | int) -> None:
        """Note a problem at a key."""
        self.problems.add(message, self.file, self.line(*path), remedy)

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


def parse(path: Path, file: str, problems: Problems) -> tuple[Manifest, LineTable, frozenset[str]] | None:
    """The manifest at `path`, as far as it can be used, its lines, and the names of tables that cannot; every problem
    is noted. None when nothing can be used."""
    try:
        text = read_text(path, MANIFEST_BYTES, "a manifest")
        raw = read_toml(text)
    except TextError as error:
        problems.add(error.message, file, None, error.remedy or "name a manifest (TOML)")
        return None
    except TomlError as error:
        problems.add(error.message, file, error.line, error.remedy)
        return None
    lines = LineTable(text)
    try:
        return Manifest.model_validate(raw), lines, frozenset()
    except ValidationError as error:
        pydantic_errors.report(error, raw, lines, file, problems)
        try:
            kept, dropped = pydantic_errors.without_errors(error, raw)
            refused = frozenset(pydantic_errors.names_of(dropped, raw))
            return Manifest.model_validate(kept), lines.without(dropped), refused
        except ValidationError:
            return None
