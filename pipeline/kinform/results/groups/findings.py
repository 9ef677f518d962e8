"""`/findings`: what is inconsistent, and what became of each rule."""

from __future__ import annotations

import h5py

from kinform.design import Design
from kinform.model.findings import CheckReport
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Table

LAYOUT = Layout(
    CheckReport,
    Table("findings"),
    Table("rules"),
    Table("ignored"),
    Table("gone"),
    Table("answers", if_any=True),
    Table("statements", if_any=True),
    Table("coverage"),
    Table("members", if_any=True),
)


def write(group: h5py.Group, design: Design) -> None:
    """Write findings and rules."""
    LAYOUT.write(group, design.report)


def read(group: HeldGroup) -> CheckReport:
    """The report that `write` wrote."""
    report: CheckReport = LAYOUT.read(group)
    return report
