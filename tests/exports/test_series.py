"""csv: the motion as tables, which other people's scripts rely on."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
from support.devices import intended
from support.export_models import known

from kinform.exports import ExportError, export


def table(data):
    """Header and rows (n, k) of a CSV file."""
    header, *rows = csv.reader(io.StringIO(data.decode("utf-8")))
    return header, np.array(rows, dtype=float)


def test_bodies_csv_has_the_columns_of_the_contract():
    found = known("gimbal")
    header, rows = table(export(found, "csv").files["bodies.csv"])
    run = found.simulation
    assert header[0] == "time"
    assert header[1:8] == [f"{run.body_names[0]}.{what}" for what in ("x", "y", "z", "qw", "qx", "qy", "qz")]
    np.testing.assert_array_equal(rows[:, 0], run.time)
    expected = np.concatenate([run.p_WB, run.q_WB], axis=2).reshape(len(run.time), -1)
    np.testing.assert_array_equal(rows[:, 1:], expected)


def test_joints_csv_has_position_velocity_and_effort_of_each_joint():
    found = known("seeker")
    header, rows = table(export(found, "csv").files["joints.csv"])
    run = found.simulation
    assert header == [
        "time",
        *(f"{name}.{what}" for name in run.joint_names for what in ("position", "velocity", "effort")),
    ]
    np.testing.assert_array_equal(rows[:, 1::3], run.joint_position)
    np.testing.assert_array_equal(rows[:, 2::3], run.joint_velocity)
    np.testing.assert_array_equal(rows[:, 3::3], run.joint_effort)


def test_joints_csv_has_the_designers_names_and_senses():
    found = known("seeker")
    first, second = found.kinematics.body_of("outer").name, found.kinematics.body_of("base").name
    stated = replace(found.assembly.function, joints=(intended("pan", first, second, "revolute"),))
    turned = replace(found, assembly=replace(found.assembly, function=stated))
    header, rows = table(export(turned, "csv").files["joints.csv"])
    as_before, values = table(export(found, "csv").files["joints.csv"])
    mine = [k for k, name in enumerate(as_before) if name.startswith("base~outer.")]
    assert [header[k] for k in mine] == ["pan.position", "pan.velocity", "pan.effort"]
    np.testing.assert_array_equal(rows[:, mine], -values[:, mine])
    rest = [k for k in range(len(header)) if k not in mine]
    assert [header[k] for k in rest] == [as_before[k] for k in rest]
    np.testing.assert_array_equal(rows[:, rest], values[:, rest])


def test_joints_with_several_coordinates_have_columns_for_each():
    header, rows = table(export(known("every_joint"), "csv").files["joints.csv"])
    assert "b1~base.angle.position" in header and "b1~base.distance.velocity" in header
    assert {f"b4~b5.{c}.position" for c in ("qw", "qx", "qy", "qz")} <= set(header)
    assert not [name for name in header if name.startswith("b3~b4")]
    assert rows.shape[1] == len(header)


def test_without_a_motion_there_is_no_csv():
    from support.devices import Z, device, joint
    from support.export_models import block, design

    made = device([block("one", (0.1, 0, 0))], [joint("base", "one", "revolute", Z, (0, 0, 0))])
    with pytest.raises(ExportError):
        export(design(made, run=False), "csv")
