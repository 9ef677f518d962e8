"""`/contacts`: candidate pairs, patches with their samples, interferences and suggestions, in the world frame."""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.arrays import freeze
from kinform.model.contacts import Contacts, Interference, Patch, Suggestion
from kinform.model.names import PartName
from kinform.model.quantities import Metres, PartPair
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Rows, Table
from kinform.results.table import read_columns, write_columns

SAMPLES = {
    "x": "m", "y": "m", "z": "m", "normal_x": "1", "normal_y": "1", "normal_z": "1", "gap": "m", "weight": "m²",
}  # fmt: skip
"""Columns of the samples and their units."""


@dataclass(frozen=True)
class _Pair:
    """A pair that the broad phase kept, or that has a tolerance, and from what its contacts were made."""

    parts: PartPair
    candidate: bool
    tolerance: Metres | None
    fingerprint: str | None


@dataclass(frozen=True)
class _Contacts:
    pairs: tuple[_Pair, ...]
    patches: tuple[Patch, ...]
    interferences: tuple[Interference, ...]
    suggestions: tuple[Suggestion, ...]
    possible_overlaps: tuple[Interference, ...] = ()


class _Samples:
    """All samples of all patches in one table, with the number of their patch."""

    dataset, fields = "samples", ("points", "normals", "gaps", "weights")

    def write(self, group: h5py.Group, cls: type, records: Sequence[Patch]) -> None:
        counts = [len(patch.points) for patch in records]
        numbers = np.concatenate(
            [np.zeros((0, len(SAMPLES)))]
            + [np.column_stack([p.points, p.normals, p.gaps, p.weights]) for p in records if len(p.points)]
        )
        columns = {"patch": ("1", np.repeat(np.arange(len(records), dtype="<i8"), counts))}
        for i, (label, unit) in enumerate(SAMPLES.items()):
            columns[label] = (unit, numbers[:, i].astype("<f8"))
        write_columns(group, "samples", columns)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        table = read_columns(group, "samples")
        numbers = np.column_stack([table[label] for label in SAMPLES])
        owner, count = table["patch"], len(rows)
        if len(owner) and not 0 <= owner.min() <= owner.max() < count:
            raise ValueError(f"samples of patches {owner.min()} to {owner.max()}, of {count}")
        ends = np.cumsum(np.bincount(owner, minlength=count))
        for row, part in zip(rows, np.split(numbers, ends[:-1]) if len(ends) else [], strict=True):
            fields = {"points": part[:, :3], "normals": part[:, 3:6], "gaps": part[:, 6], "weights": part[:, 7]}
            row |= {name: freeze(np.array(values)) for name, values in fields.items()}


LAYOUT = Layout(
    _Contacts, Table("pairs"), Table("patches", _Samples()), Table("interferences"), Table("suggestions"),
    Table("possible_overlaps"),
)  # fmt: skip


def write(group: h5py.Group, design: Design) -> None:
    """Write all contacts, with the fingerprint of each pair."""
    contacts, marks = design.contacts, design.fingerprints.pairs
    assert contacts is not None
    candidates = set(contacts.candidates)
    pairs = tuple(
        _Pair(parts, parts in candidates, contacts.tolerance.get(parts), marks.get(parts))
        for parts in sorted(candidates | set(contacts.tolerance))
    )
    found = contacts.patches, contacts.interferences, contacts.suggestions, contacts.possible_overlaps
    LAYOUT.write(group, _Contacts(pairs, *found))


def read(group: HeldGroup) -> tuple[Contacts, dict[tuple[PartName, PartName], str]]:
    """The contacts, and the fingerprints by pair."""
    stored: _Contacts = LAYOUT.read(group)
    contacts = Contacts(
        patches=stored.patches,
        interferences=stored.interferences,
        candidates=tuple(pair.parts for pair in stored.pairs if pair.candidate),
        tolerance={pair.parts: pair.tolerance for pair in stored.pairs if pair.tolerance is not None},
        suggestions=stored.suggestions,
        possible_overlaps=stored.possible_overlaps,
    )
    return contacts, {pair.parts: pair.fingerprint for pair in stored.pairs if pair.fingerprint is not None}
