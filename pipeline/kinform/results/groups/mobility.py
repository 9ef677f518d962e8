"""`/mobility`: the counts, and the motions that they count."""

from __future__ import annotations

import h5py

from kinform.design import Design
from kinform.model.kinematics import Mobility
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Numbers, Ragged, Row, Table, Texts

LAYOUT = Layout(
    Mobility,
    Row("counts", "instantaneous", "finite", "effective", "idle", "redundant", "blocked", "by_contact"),
    Row("ends", "low", "high"),
    Numbers("freedoms"),
    Texts("idle_bodies"),
    Texts("uncertain"),
    Row("finite", "finite_reason", "infinitesimal", "singular", "on_edge"),
    Table("certificates"),
    Table("named", Table("drives", owner="freedom")),
    Table("redundancies", Ragged("redundant_patches", "patches"), Ragged("redundant_wrenches", "wrenches", width=6)),
)
"""`freedoms` has one item a freedom: a twist a body, in the order of the bodies; `drives` the joint rates that are not
zero."""


def write(group: h5py.Group, design: Design) -> None:
    """Write the mobility of the kinematics."""
    assert design.kinematics is not None
    LAYOUT.write(group, design.kinematics.mobility)


def read(group: HeldGroup) -> Mobility:
    """The mobility that `write` wrote."""
    mobility: Mobility = LAYOUT.read(group)
    return mobility
