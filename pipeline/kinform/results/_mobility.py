"""`/mobility`: the counts, and the motions that they count."""

from __future__ import annotations

import h5py

from kinform.model.kinematics import FiniteCertificate, Mobility
from kinform.results._table import (
    flag,
    integer,
    read_array,
    read_records,
    read_rows,
    read_texts,
    real,
    text,
    texts,
    write_array,
    write_records,
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


def write(group: h5py.Group, mobility: Mobility) -> None:
    """Write the counts; `freedoms` has one item a freedom: a twist a body, in the order of the bodies."""
    write_records(group, "counts", _COUNTS, [mobility])
    write_array(group, "freedoms", mobility.freedoms, "rad/s, m/s (ω; v)")
    write_texts(group, "idle_bodies", mobility.idle_bodies)
    write_texts(group, "uncertain", mobility.uncertain)
    write_records(group, "finite", _FINITE, [mobility])
    write_records(group, "certificates", _CERTIFICATES, mobility.certificates)


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
    )
