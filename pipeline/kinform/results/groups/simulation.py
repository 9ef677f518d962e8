"""`/simulation`: trajectories, joint values, efforts and what monitored them; coordinates of joint j are
joint_offset[j] to joint_offset[j+1].

Joints and drives have the names that the function gives them, and joint values its signs, where it gives some;
`derived_joints` and `joint_signs` lead back to the joints of `/joints`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import field, replace

import h5py
import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.function import DesignersJoint, designers_joints
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.simulation import Simulation
from kinform.results.datasets import TEXT
from kinform.results.groups.collisions import COLLISIONS
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Numbers, Row, Rows, Table, Texts, WholeColumns


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
    Numbers("friction_effort"),
    Numbers("friction_limit"),
    Numbers("friction_sticks"),
    Texts("friction_joints"),
    Table("drives"),
    Numbers("drive_effort"),
    Numbers("drive_speed"),
    Table("readings"),
    Numbers("sensed"),
    Table("dampings"),
    Texts("assumptions"),
    Table("failures"),
    Table("not_dynamic"),
    *COLLISIONS,
)


@dataclass(frozen=True, eq=False)
class _Derived:
    """What joints are called in `/joints`, and the sign of their values there; empty in files of older versions."""

    derived_joints: tuple[str, ...] = ()
    joint_signs: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))


_DERIVED = Layout(_Derived, Texts("derived_joints"), Numbers("joint_signs"))


def write(group: h5py.Group, design: Design) -> None:
    """Write the run."""
    run = design.simulation
    assert run is not None
    known = _designers(design, run)
    signs = np.array([known[name].sign if name in known else 1 for name in run.joint_names], dtype=np.int64)
    LAYOUT.write(group, _called(run, known))
    _DERIVED.write(group, _Derived(run.joint_names, signs))


def read(group: HeldGroup) -> Simulation:
    """The run that `write` wrote."""
    run: Simulation = LAYOUT.read(group)
    derived: _Derived = _DERIVED.read(group)
    back = {
        name: DesignersJoint(own, -1 if sign < 0 else 1)
        for name, own, sign in zip(run.joint_names, derived.derived_joints, derived.joint_signs, strict=False)
        if name != own or sign < 0
    }
    return _called(run, back) if back else run


def _designers(design: Design, run: Simulation) -> dict[str, DesignersJoint]:
    """The names and signs of the function, by the names of joints of the run; names that it has otherwise are left."""
    if design.kinematics is None:
        return {}
    taken = Counter({*run.joint_names, *(use.joint for use in run.drives)})
    known = designers_joints(design.assembly, design.kinematics)
    return {name: one for name, one in known.items() if name in run.joint_names and not taken[one.name]}


def _called(run: Simulation, known: dict[str, DesignersJoint]) -> Simulation:
    """The run with other names of its joints and drives, and other signs of joint values, to the last bit; ranges and
    gears are those of derived joints."""
    if not known:
        return run
    named = {name: one.name for name, one in known.items()}
    of_joint = [name in known and known[name].sign < 0 for name in run.joint_names]
    rubbing = np.array([name in known and known[name].sign < 0 for name in run.friction_joints], dtype=np.bool_)
    turned = np.repeat(of_joint, np.diff(run.joint_offset))
    against = np.array([use.joint in known and known[use.joint].sign < 0 for use in run.drives], dtype=np.bool_)

    def signed(values: Array, turned: Flags = turned) -> Array:
        return np.where(turned, -values, values) if values.ndim == 2 and values.shape[1] == len(turned) else values

    return replace(
        run,
        joint_names=tuple(named.get(name, name) for name in run.joint_names),
        joint_position=signed(run.joint_position),
        joint_velocity=signed(run.joint_velocity),
        joint_effort=signed(run.joint_effort),
        joint_acceleration=signed(run.joint_acceleration),
        drive_effort=signed(run.drive_effort, against),
        drive_speed=signed(run.drive_speed, against),
        friction_joints=tuple(named.get(name, name) for name in run.friction_joints),
        friction_effort=signed(run.friction_effort, rubbing),
        drives=tuple(replace(use, joint=named.get(use.joint, use.joint)) for use in run.drives),
    )
