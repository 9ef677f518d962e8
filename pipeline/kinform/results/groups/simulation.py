"""`/simulation`: trajectories, joint values, efforts and what monitored them; coordinates of joint j are
joint_offset[j] to joint_offset[j+1]."""

from __future__ import annotations

from collections.abc import Sequence

import h5py

from kinform.design import Design
from kinform.model.simulation import Simulation
from kinform.results.groups.collisions import COLLISIONS
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Numbers, Row, Rows, Table, Texts, WholeColumns
from kinform.results.table import TEXT


class _EnergyColumns:
    """What the columns of `energy` are."""

    dataset, fields = "energy", ()

    def write(self, group: h5py.Group, cls: type, records: Sequence[Simulation]) -> None:
        group["energy"].attrs.create("columns", ["kinetic", "potential", "work"], dtype=TEXT)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        """Nothing: they are always these."""


LAYOUT = Layout(
    Simulation,
    Row("summary", "status", "reason", "level"),
    *map(Numbers, ("time", "p_WB", "q_WB", "joint_position", "joint_velocity", "joint_effort", "energy")),
    *map(
        Numbers, ("joint_acceleration", "F_A", "F_B", "balance_bodies", "balance_shafts", "gear_effort", "gear_force")
    ),
    _EnergyColumns(),
    *map(Texts, ("body_names", "joint_names", "joint_types")),
    Numbers("joint_offset"),
    WholeColumns("monitors", "residual", "rank", "balance"),
    Numbers("undetermined"),
    Texts("gear_names"),
    Table("drives"),
    Texts("assumptions"),
    Table("failures"),
    *COLLISIONS,
)


def write(group: h5py.Group, design: Design) -> None:
    """Write the run."""
    LAYOUT.write(group, design.simulation)


def read(group: HeldGroup) -> Simulation:
    """The run that `write` wrote."""
    simulation: Simulation = LAYOUT.read(group)
    return simulation
