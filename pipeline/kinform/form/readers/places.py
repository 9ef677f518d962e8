"""File and line of each key of the tables of a manifest, when these come from several files."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Protocol

from kinform.form.readers.toml_lines import Path


class Lines(Protocol):
    """The file and the 1-based line of each path, such as ("part", 2, "mesh")."""

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it."""

    def file(self, path: Path) -> str | None:
        """The file that this line is in; None: the manifest."""

    def without(self, dropped: Collection[Path]) -> Lines:
        """The lines of what is left when these tables are taken out."""


class Places:
    """Lines of paths, some in other files than the manifest (None)."""

    def __init__(self, places: Mapping[Path, tuple[str | None, int]]):
        self.of = dict(places)

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it (1 for an empty path)."""
        return self._closest(path)[1]

    def file(self, path: Path) -> str | None:
        """The file that this line is in; None: the manifest."""
        return self._closest(path)[0]

    def _closest(self, path: Path) -> tuple[str | None, int]:
        for length in range(len(path), -1, -1):
            if path[:length] in self.of:
                return self.of[path[:length]]
        return None, 1

    def without(self, dropped: Collection[Path]) -> Places:
        """The places of what is left when these tables are taken out: later elements of their arrays move up."""
        return Places({moved: place for path, place in self.of.items() if (moved := moved_up(path, dropped))})


def moved_up(path: Path, dropped: Collection[Path]) -> Path | None:
    """Where a path is when these tables are taken out; None where it is in one of them."""
    if any(path[:length] in dropped for length in range(1, len(path) + 1)):
        return None
    return tuple(
        step - sum((*path[:n], before) in dropped for before in range(step)) if isinstance(step, int) else step
        for n, step in enumerate(path)
    )
