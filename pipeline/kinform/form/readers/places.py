"""File and line of each key of the tables of a manifest, when these come from several files."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Protocol

from kinform.form.readers.toml_lines import Path, Removed


class Lines(Protocol):
    """The file and the 1-based line of each path, such as ("part", 2, "mesh")."""

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it."""

    def file(self, path: Path) -> str | None:
        """The file that this line is in; None: the manifest."""


class Places:
    """Lines of paths, some in other files than the manifest (None)."""

    def __init__(self, places: Mapping[Path, tuple[str | None, int]]):
        self.of = dict(places)

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it (1 for an empty path)."""
        return self.closest(path)[1]

    def file(self, path: Path) -> str | None:
        """The file that this line is in; None: the manifest."""
        return self.closest(path)[0]

    def closest(self, path: Path) -> tuple[str | None, int]:
        """The place of the path, or of the closest table or key around it."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.of:
                return self.of[path[:length]]
        return None, 1


class Left:
    """Lines of what is left when tables are taken out: later elements of their arrays have moved up."""

    def __init__(self, lines: Lines, dropped: Collection[Path]):
        self._lines, self._removed = lines, Removed(dropped)

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it."""
        return self._lines.line(self._removed.before(path))

    def file(self, path: Path) -> str | None:
        """The file that this line is in; None: the manifest."""
        return self._lines.file(self._removed.before(path))
