"""A manifest on top of what its `from` says: a table of the same name overrides key by key, the rest is added."""

from __future__ import annotations

from typing import Any

from kinform.form.readers.places import Places
from kinform.form.readers.toml_lines import Path

_INSTEAD = {
    "rpy": ("quaternion",), "quaternion": ("rpy",), "material": ("density",), "density": ("material",),
    "mesh": ("shape", "units", "scale", "body"), "shape": ("mesh", "units", "scale", "body"),
    "units": (), "scale": (), "body": (),
}  # fmt: skip
"""Keys that a key of the manifest takes the place of."""


class Overlay:
    """Tables of a source, and of the manifest over them, with the place of each key."""

    def __init__(self, above: Places, below: Places):
        self._above, self._below = above, below
        self.places: dict[Path, tuple[str | None, int]] = {}

    def tables(self, above: dict[str, Any], below: dict[str, Any]) -> dict[str, Any]:
        """Both as one."""
        return self._table(above, below, (), (), ())

    def _table(self, above: dict[str, Any], below: dict[str, Any], at: Path, up: Path, down: Path) -> dict[str, Any]:
        """The table at the path `at`, which is at `up` in the manifest and at `down` in the source."""
        replaced = {other for key in above for other in _INSTEAD.get(key, ()) if other not in above}
        out: dict[str, Any] = {}
        if down in self._below.of:
            self.places[at] = self._below.of[down]
        if up:
            self.places[at] = self._above.closest(up)
        for key, value in below.items():
            if key not in above and key not in replaced:
                out[key] = self._copy(value, self._below, (*at, key), (*down, key))
        for key, value in above.items():
            old = below.get(key)
            where, upper, lower = (*at, key), (*up, key), (*down, key)
            if isinstance(value, dict) and isinstance(old, dict):
                out[key] = self._table(value, old, where, upper, lower)
            elif _tables(value) and isinstance(old, list) and _tables(old):
                out[key] = self._array(value, old, where, upper, lower)
            else:
                self.places[where] = self._above.closest(upper)
                out[key] = self._copy(value, self._above, where, upper)
        return out

    def _array(self, above: list[Any], below: list[Any], at: Path, up: Path, down: Path) -> list[Any]:
        named = {
            table["name"]: k for k, table in reversed(list(enumerate(above))) if isinstance(table.get("name"), str)
        }
        out: list[Any] = []
        used = set()
        for k, table in enumerate(below):
            over = named.get(table.get("name"))
            where = (*at, len(out))
            if over is None:
                out.append(self._copy(table, self._below, where, (*down, k)))
            else:
                used.add(over)
                out.append(self._table(above[over], table, where, (*up, over), (*down, k)))
        for k, table in enumerate(above):
            if k not in used:
                out.append(self._copy(table, self._above, (*at, len(out)), (*up, k)))
        return out

    def _copy(self, value: Any, places: Places, at: Path, old: Path) -> Any:
        """The value, with the places of all that is in it."""
        if old in places.of:
            self.places[at] = places.of[old]
        if isinstance(value, dict):
            return {key: self._copy(item, places, (*at, key), (*old, key)) for key, item in value.items()}
        if isinstance(value, list):
            return [self._copy(item, places, (*at, k), (*old, k)) for k, item in enumerate(value)]
        return value


def _tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, dict) for item in value)
