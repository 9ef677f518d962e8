"""What a results file holds, each dataset read once: first it is checked, then something is made of it.

h5py looks a name up again each time it is asked for, and takes half a millisecond for a small table; a file has some
two hundred of them. What is read is kept for as long as the file is open, and is read-only. Only what `check_structure`
lets pass is held here: groups, and datasets of numbers and texts.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5g, h5o, h5s, h5t
from numpy.typing import NDArray

from kinform.results.texts import read_texts_of


class HeldDataset:
    """A dataset. Fields as h5py's: `shape` is None where there is nothing, not even no rows."""

    def __init__(self, name: str, made: Any):
        self.name = name
        self._made = made
        self.dtype: np.dtype[Any] = made.dtype
        space = made.get_space()
        self.shape: tuple[int, ...] | None = None if space.get_simple_extent_type() == h5s.NULL else tuple(made.shape)

    @property
    def ndim(self) -> int:
        return len(self.shape or ())

    def __len__(self) -> int:
        if not self.shape:
            raise TypeError(f"{self.name} has no rows")
        return self.shape[0]

    @cached_property
    def data(self) -> NDArray[Any]:
        """All of it, read-only. Raises ValueError where there is nothing."""
        if self.shape is None:
            raise ValueError(f"{self.name.lstrip('/')} holds nothing")
        out = np.empty(self.shape, dtype=self.dtype)
        if out.size:
            self._made.read(h5s.ALL, h5s.ALL, out, h5t.py_create(self.dtype))
        out.flags.writeable = False
        return out

    @cached_property
    def _texts(self) -> dict[str, tuple[str | None, ...]]:
        """Columns that were asked for."""
        return {}

    def texts(self, column: str = "") -> tuple[str | None, ...]:
        """The texts of a column of a table, or of a dataset of texts; None: no text. Raises ValueError where they are
        none."""
        if column not in self._texts:
            self._texts[column] = tuple(read_texts_of(self.data[column] if column else self.data))
        return self._texts[column]


class HeldGroup:
    """A group. Names with "/" are looked up below."""

    def __init__(self, name: str, made: Any):
        self.name = name
        self._made = made

    @cached_property
    def _members(self) -> dict[str, HeldGroup | HeldDataset]:
        members: dict[str, HeldGroup | HeldDataset] = {}
        for stored in self._made:
            inner, name = h5o.open(self._made, stored), stored.decode("utf-8", "surrogateescape")
            place = f"{self.name.rstrip('/')}/{name}"
            if isinstance(inner, h5g.GroupID):
                members[name] = HeldGroup(place, inner)
            elif isinstance(inner, h5d.DatasetID):
                members[name] = HeldDataset(place, inner)
        return members

    @cached_property
    def attrs(self) -> dict[str, Any]:
        """Attributes by name."""
        return dict(h5py.AttributeManager(h5py.Group(self._made)))

    def get(self, name: str) -> HeldGroup | HeldDataset | None:
        """What has this name here or below; None where there is nothing."""
        first, _, rest = name.partition("/")
        found = self._members.get(first)
        if not rest:
            return found
        return found.get(rest) if isinstance(found, HeldGroup) else None

    def group(self, name: str) -> HeldGroup:
        """The group of this name. Raises KeyError where there is none."""
        found = self.get(name)
        if not isinstance(found, HeldGroup):
            raise KeyError(name)
        return found

    def dataset(self, name: str) -> HeldDataset:
        """The dataset of this name. Raises KeyError where there is none."""
        found = self.get(name)
        if not isinstance(found, HeldDataset):
            raise KeyError(name)
        return found

    def __contains__(self, name: str) -> bool:
        return self.get(name) is not None

    def groups(self) -> dict[str, HeldGroup]:
        """The groups here, by name."""
        return {name: item for name, item in self._members.items() if isinstance(item, HeldGroup)}

    def datasets(self) -> Iterator[str]:
        """Names of all datasets here and below, as `get` takes them."""
        for name, item in self._members.items():
            if isinstance(item, HeldDataset):
                yield name
            else:
                yield from (f"{name}/{inner}" for inner in item.datasets())


class HeldFile(HeldGroup):
    """The content of an open file."""

    def __init__(self, made: Any, recorded: bool):
        super().__init__("/", made)
        self.recorded = recorded
        """Whether this user's kinform wrote the file."""


def hold(file: h5py.File, *, recorded: bool = False) -> HeldFile:
    """The content of an open file."""
    return HeldFile(h5g.open(file.id, b"/"), recorded)
