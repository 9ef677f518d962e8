"""csv, json and dot: what other people's scripts rely on."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from support.devices import intended
from support.export_models import ALL, known, model_of
from support.places import ROOT
from support.validators import package

from kinform.errors import InputError
from kinform.exports import FORMATS, ExportError, export
from kinform.exports.port_model import read, schema


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
    with pytest.raises(ExportError, match="nothing was simulated"):
        export(design(made, run=False), "csv")


@pytest.mark.parametrize("name", ALL)
def test_reading_the_port_model_gives_an_equal_one(name):
    (data,) = export(known(name), "json").files.values()
    system, again = model_of(known(name)).nested, read(data)
    assert again.nodes == system.nodes
    assert [type(c) for c in again.components] == [type(c) for c in system.components]
    for ours, theirs in zip(system.components, again.components, strict=True):
        same(vars(ours), vars(theirs))


def same(a, b):
    """Equal to the bit, arrays and nested records too."""
    if isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            same(a[key], b[key])
    elif isinstance(a, np.ndarray):
        np.testing.assert_array_equal(a, b)
    elif (
        hasattr(a, "__dict__") and type(a).__module__.startswith("kinform") and not callable(getattr(a, "chain", None))
    ):
        assert type(a) is type(b)
        same(vars(a), vars(b))
    else:
        assert a == b


@pytest.mark.parametrize("name", ALL)
def test_the_port_model_keeps_its_schema(name):
    jsonschema = package("jsonschema")
    (data,) = export(known(name), "json").files.values()
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.Draft202012Validator(schema()).validate(json.loads(data))


def test_the_published_schema_is_current():
    assert json.loads((ROOT / "docs" / "port-model.schema.json").read_text(encoding="utf-8")) == schema()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda d: d.update(schema="kinform/port-model/9"), "schema"),
        (lambda d: d["components"][1].update(mass="heavy"), "mass"),
        (lambda d: d["components"][1].update(colour="red"), "colour"),
        (lambda d: d["components"].append(d["components"][0]), "same name"),
        (lambda d: d["nodes"][0]["ports"].pop(), "in no node"),
        (lambda d: d["nodes"][0].update(size=3), "fit"),
    ],
)
def test_a_damaged_port_model_is_refused_with_the_place(change, told):
    (data,) = export(known("gimbal"), "json").files.values()
    changed = json.loads(data)
    change(changed)
    with pytest.raises(InputError, match=told):
        read(json.dumps(changed))


def test_dot_names_every_body_and_joint():
    text = export(known("gimbal"), "dot").files["device.dot"].decode()
    assert text.count(" -- ") == 3
    for name in ("a rotor", "base", "inner", "outer"):
        assert re.search(rf'^  "{name}"', text, re.MULTILINE)
    if shutil.which("dot"):
        ran = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr


def test_bytes_depend_on_nothing_but_the_design(tmp_path):
    """Another process, another hash seed, another folder: the same bytes, and no path of this machine."""
    code = (
        "import sys, hashlib\n"
        f"sys.path.insert(0, {str(ROOT / 'tests')!r})\n"
        "from support.export_models import known\n"
        "from kinform.exports import FORMATS, export\n"
        "for name in ('four_bar',):\n"
        "    for format in sorted(FORMATS):\n"
        "        for file, data in sorted(export(known(name), format).files.items()):\n"
        "            print(name, format, file, hashlib.sha256(data).hexdigest())\n"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "77"}
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    import hashlib

    here = [
        f"{name} {format} {file} {hashlib.sha256(data).hexdigest()}"
        for name in ("four_bar",)
        for format in sorted(FORMATS)
        for file, data in sorted(export(known(name), format).files.items())
    ]
    assert ran.stdout.splitlines() == here
    for format in FORMATS:
        for data in export(known("four_bar"), format).files.values():
            assert str(ROOT).encode() not in data and str(tmp_path).encode() not in data


def test_motors_and_servos_are_whole_where_there_are_equations_and_named_as_lost_elsewhere():
    found = known("motorised")
    (data,) = export(found, "json").files.values()
    system = read(data)
    assert system.components == model_of(found).system.components
    assert {type(c).__name__ for c in system.components} >= {"Servo", "DcMotor", "VoltageSource"}
    for format in ("json", "modelica", "vhdl-ams"):
        assert not export(found, format).lost
    for format in ("sdf", "urdf"):
        lost = " ".join(export(found, format).lost)
        assert "a servo with its gains and target" in lost
        assert "a DC motor with its voltage" in lost
