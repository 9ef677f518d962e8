"""`/mass`: mass properties of parts and bodies, in the world frame at the pose of the meshes."""

from __future__ import annotations

import h5py

from kinform.design import Design
from kinform.model.mass import MassReport
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Row, Table

LAYOUT = Layout(MassReport, Row("summary", "valid"), Table("parts"), Table("bodies"), Table("problems"))


def write(group: h5py.Group, design: Design) -> None:
    """Write the properties of parts and bodies, and what is wrong with them."""
    LAYOUT.write(group, design.mass)


def read(group: HeldGroup) -> MassReport:
    """The report that `write` wrote."""
    report: MassReport = LAYOUT.read(group)
    return report
