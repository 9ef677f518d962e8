"""`/contacts`: candidate pairs, patches with their samples, interferences and suggestions, in the world frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from kinform.model.arrays import freeze
from kinform.model.contacts import Contacts, Interference, Patch, Suggestion
from kinform.model.names import PartName
from kinform.results.table import (
    flag,
    integer,
    pair,
    read_columns,
    read_records,
    read_rows,
    real,
    text,
    vector,
    write_columns,
    write_records,
    write_rows,
)

__all__ = ["read", "write"]

Pair = tuple[PartName, PartName]

_PARTS = pair("parts", text, ("part_a", "part_b"))
_PAIRS = (_PARTS, flag("candidate"), real("tolerance", "m"), text("fingerprint"))
_PATCHES = (
    _PARTS, pair("surfaces", integer, ("surface_a", "surface_b")), text("kind"), flag("one_sided"),
    real("area", "m²"), real("gap", "m"), vector("axis", "1"), vector("point", "m"),
    pair("radii", real, ("radius_a", "radius_b"), "m (cones: rad)"), real("misalignment", "rad"),
    real("offset", "m"), pair("uncertainty", real, ("axis_uncertainty", "point_uncertainty"), "rad, m"),
    real("chord", "m"), text("fit"), real("pitch", "m a turn"),
)  # fmt: skip
_SAMPLES = {
    "x": "m", "y": "m", "z": "m", "normal_x": "1", "normal_y": "1", "normal_z": "1", "gap": "m", "weight": "m²",
}  # fmt: skip
_INTERFERENCES = (
    _PARTS, real("volume", "m³"), real("depth", "m"), vector("place", "m"), flag("mated"), text("method"),
)  # fmt: skip
_SUGGESTIONS = (_PARTS, text("kind"), text("evidence"), vector("axis", "1"), vector("point", "m"))


def write(group: h5py.Group, contacts: Contacts, fingerprints: Mapping[Pair, str]) -> None:
    """Write all contacts, with the fingerprint of each pair."""
    candidates = set(contacts.candidates)
    rows = [
        {
            "parts": parts,
            "candidate": parts in candidates,
            "tolerance": contacts.tolerance.get(parts),
            "fingerprint": fingerprints.get(parts),
        }
        for parts in sorted(candidates | set(contacts.tolerance))
    ]
    write_rows(group, "pairs", _PAIRS, rows)
    write_records(group, "patches", _PATCHES, contacts.patches)
    _write_samples(group, contacts.patches)
    write_records(group, "interferences", _INTERFERENCES, contacts.interferences)
    write_records(group, "suggestions", _SUGGESTIONS, contacts.suggestions)


def read(group: h5py.Group) -> tuple[Contacts, dict[Pair, str]]:
    """The contacts, and the fingerprints by pair."""
    pairs = read_rows(group, "pairs", _PAIRS)
    samples = _read_samples(group)
    rows: list[dict[str, Any]] = [
        row | owned for row, owned in zip(read_rows(group, "patches", _PATCHES, added=("pitch",)), samples, strict=True)
    ]
    contacts = Contacts(
        patches=tuple(Patch(**row) for row in rows),
        interferences=read_records(group, "interferences", _INTERFERENCES, Interference),
        candidates=tuple(row["parts"] for row in pairs if row["candidate"]),
        tolerance={row["parts"]: row["tolerance"] for row in pairs if row["tolerance"] is not None},
        suggestions=read_records(group, "suggestions", _SUGGESTIONS, Suggestion),
    )
    return contacts, {row["parts"]: row["fingerprint"] for row in pairs if row["fingerprint"] is not None}


def _write_samples(group: h5py.Group, patches: tuple[Patch, ...]) -> None:
    counts = [len(patch.points) for patch in patches]
    numbers = np.concatenate(
        [np.zeros((0, len(_SAMPLES)))]
        + [np.column_stack([p.points, p.normals, p.gaps, p.weights]) for p in patches if len(p.points)]
    )
    columns = {"patch": ("1", np.repeat(np.arange(len(patches), dtype="<i8"), counts))}
    for i, (label, unit) in enumerate(_SAMPLES.items()):
        columns[label] = (unit, numbers[:, i].astype("<f8"))
    write_columns(group, "samples", columns)


def _read_samples(group: h5py.Group) -> list[dict[str, np.ndarray]]:
    table = read_columns(group, "samples")
    numbers = np.column_stack([table[label] for label in _SAMPLES])
    owner, count = table["patch"], len(group["patches"])
    if len(owner) and not 0 <= owner.min() <= owner.max() < count:
        raise ValueError(f"samples of patches {owner.min()} to {owner.max()}, of {count}")
    ends = np.cumsum(np.bincount(owner, minlength=count))
    samples = []
    for part in np.split(numbers, ends[:-1]) if len(ends) else []:
        fields = {"points": part[:, :3], "normals": part[:, 3:6], "gaps": part[:, 6], "weights": part[:, 7]}
        samples.append({name: freeze(np.array(values)) for name, values in fields.items()})
    return samples
