"""`/mobility`: the counts, and the motions that they count."""

from __future__ import annotations

from collections.abc import Sequence

import h5py

from kinform.model.kinematics import FiniteCertificate, Freedom, Mobility, Redundancy
from kinform.results.table import (
    flag,
    integer,
    read_array,
    read_ragged,
    read_records,
    read_rows,
    read_texts,
    real,
    text,
    texts,
    vector,
    write_array,
    write_ragged,
    write_records,
    write_rows,
    write_texts,
)

__all__ = ["read", "write"]

_COUNTS = (
    integer("instantaneous"), integer("finite", optional=True), integer("effective"), integer("idle"),
    integer("redundant"), integer("blocked"),
)  # fmt: skip
_FINITE = (text("finite_reason"), integer("infinitesimal"), flag("singular"))
_CERTIFICATES = (
    texts("joints"), integer("instantaneous", optional=True), integer("finite", optional=True),
    integer("infinitesimal"), flag("singular"), texts("branches"), real("step", "rad, or of the size"),
    real("kept", "1"), real("residual", "rad, or of the size"), integer("stepped", optional=True),
    text("second_order"), texts("moves"), text("statement"),
)  # fmt: skip
_NAMED = (
    text("driver"), text("body"), text("kind"), vector("axis", "1"), vector("point", "m"), real("pitch", "m a turn"),
    flag("idle"), flag("looped"),
)  # fmt: skip
_DRIVES = (integer("freedom"), text("joint"), integer("twist"), real("rate", "rad/s or m/s, or their ratio"))
_REDUNDANCIES = (text("kind"), text("text"), integer("rows"), texts("joints"), texts("directions"))


def write(group: h5py.Group, mobility: Mobility) -> None:
    """Write the counts; `freedoms` has one item a freedom: a twist a body, in the order of the bodies."""
    write_records(group, "counts", _COUNTS, [mobility])
    write_array(group, "freedoms", mobility.freedoms, "rad/s, m/s (ω; v)")
    write_texts(group, "idle_bodies", mobility.idle_bodies)
    write_texts(group, "uncertain", mobility.uncertain)
    write_records(group, "finite", _FINITE, [mobility])
    write_records(group, "certificates", _CERTIFICATES, mobility.certificates)
    _write_named(group, mobility.named)
    write_records(group, "redundancies", _REDUNDANCIES, mobility.redundancies)
    write_ragged(group, "redundant_patches", [r.patches for r in mobility.redundancies], "1", dtype="<i8")
    write_ragged(group, "redundant_wrenches", [r.wrenches for r in mobility.redundancies], "N m, N (τ; f)", width=6)


def read(group: h5py.Group) -> Mobility:
    """The mobility that `write` wrote."""
    (counts,) = read_rows(group, "counts", _COUNTS)
    if "finite" in group:
        (more,) = read_rows(group, "finite", _FINITE)
        counts |= more | {"certificates": read_records(group, "certificates", _CERTIFICATES, FiniteCertificate)}
    return Mobility(
        **counts,
        freedoms=read_array(group, "freedoms"),
        idle_bodies=read_texts(group, "idle_bodies"),
        uncertain=read_texts(group, "uncertain"),
        named=_read_named(group),
        redundancies=_read_redundancies(group),
    )


def _write_named(group: h5py.Group, named: Sequence[Freedom]) -> None:
    """One row a freedom, and in `drives` one row for each joint rate that is not zero."""
    write_records(group, "named", _NAMED, named)
    fields = [column.field for column in _DRIVES]
    rows = [dict(zip(fields, (i, *drive), strict=True)) for i, freedom in enumerate(named) for drive in freedom.drives]
    write_rows(group, "drives", _DRIVES, rows)


def _read_named(group: h5py.Group) -> tuple[Freedom, ...]:
    if "named" not in group:  # written before they were named
        return ()
    rows = read_rows(group, "named", _NAMED)
    drives: list[list[tuple[str, int, float]]] = [[] for _ in rows]
    for row in read_rows(group, "drives", _DRIVES):
        drives[row["freedom"]].append((row["joint"], row["twist"], row["rate"]))
    return tuple(Freedom(**row, drives=tuple(own)) for row, own in zip(rows, drives, strict=True))  # type: ignore[arg-type]


def _read_redundancies(group: h5py.Group) -> tuple[Redundancy, ...]:
    if "redundancies" not in group:
        return ()
    rows = read_rows(group, "redundancies", _REDUNDANCIES)
    ragged = zip(read_ragged(group, "redundant_patches"), read_ragged(group, "redundant_wrenches"), strict=True)
    return tuple(
        Redundancy(**row, patches=tuple(patches.tolist()), wrenches=wrenches)
        for row, (patches, wrenches) in zip(rows, ragged, strict=True)
    )
