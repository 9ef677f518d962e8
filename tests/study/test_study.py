"""A study of the slider-crank: against its formula, interrupted, and with meshes that a command makes."""

from __future__ import annotations

import csv
import json
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from support.command_line import ran_here
from support.places import FIXTURES

import kinform
from kinform import method
from kinform.batch import Settings
from kinform.errors import InputError
from kinform.form.sources import Reading
from kinform.study import read_plan, run
from kinform.study import session as module
from kinform.study.session import Journal
from kinform.study.work import measure, nominal, sample, units

pytest.importorskip("distributed")

DESIGN = Path(__file__).parents[2] / "examples" / "slider_crank.toml"
STUDY = """
schema = 1
[study]
design = "slider_crank.toml"
method = "one-at-a-time"
[[vary]]
name = "crank"
value = "function.joint.crank_pin.point.1"
values = [29.0, 30.0, 31.0]
[[vary]]
name = "reach"
value = "function.joint.slider_pin.point.0"
values = [99.0, 100.0, 0.0]
[[measure]]
name = "farthest"
value = "simulation.joints.guide.intended_position.highest"
"""


def farthest(crank: float, reach: float) -> float:
    """How far the slider goes beyond where it is (m): crank and rod in line, less the start; mm given."""
    return (crank + np.hypot(crank, reach) - reach) / 1000.0


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> Path:
    """The study by the command."""
    folder = tmp_path_factory.mktemp("study")
    shutil.copy(DESIGN, folder)
    (folder / "s.toml").write_text(STUDY)
    ran = ran_here("study", "s.toml", "-o", "s.h5", "--jobs", "1", "--format", "json", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    (folder / "stdout.json").write_text(ran.stdout)
    return folder


def test_every_sample_is_its_formula(done):
    with (done / "s.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 5
    for row in rows:
        if float(row["reach"]) > 0:
            expected = farthest(float(row["crank"]), float(row["reach"]))
            assert float(row["farthest"]) == pytest.approx(expected, rel=1e-9)


def test_all_forms_of_the_table_say_the_same(done):
    with h5py.File(done / "s.h5") as file:
        columns = file["varied/crank"][:], file["measured/farthest"][:]
        assert json.loads(file.attrs["summary"]) == json.loads((done / "stdout.json").read_text())
    with (done / "s.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["crank"]) for row in rows] == list(columns[0])
    assert [row["farthest"] for row in rows] == ["" if np.isnan(v) else repr(float(v)) for v in columns[1]]
    page = (done / "s.html").read_text()
    assert page.count("<svg") == 3 and "farthest (m)" in page and ">reach<" in page and "nan" not in page


SENSED = """
[[simulation.sensor]]
name = "pin"
kind = "point"
part = "crank"
point = [0, 30, 0]
[[function.require]]
name = "slow"
kind = "speed"
joint = "crank_bearing"
limit = 200.0
"""


def test_sensors_and_margins_are_measured(tmp_path):
    """The crank turns by 180 °/s from where it stands upright: its pin is at 30 mm · sin, and 20 °/s are to spare."""
    (tmp_path / "d.toml").write_text(DESIGN.read_text() + SENSED)
    design = method.run(tmp_path / "d.toml").design
    paths = [("sensors", "pin", "position", "x", "lowest"), ("sensors", "pin", "velocity", "y", "highest"),
             ("margins", "slow"), ("requirements", "slow"), ("simulation", "joints", "guide", "fastest")]  # fmt: skip
    lowest, fastest, margin, met, _ = measure(design, paths)
    assert lowest == pytest.approx(-0.03, rel=1e-6) and fastest == pytest.approx(0.03 * np.pi, rel=1e-6)
    assert margin == pytest.approx(np.radians(20.0), rel=1e-6) and met == 1.0
    assert units(design, paths) == ("m", "m/s", "rad/s", "", "m/s")


def test_a_study_goes_on_where_it_stopped(done, tmp_path, monkeypatch):
    for name in ("s.toml", DESIGN.name):
        shutil.copy(done / name, tmp_path)
    plan, output = read_plan(tmp_path / "s.toml"), tmp_path / "s.h5"
    whole = [(float(v), "") for v in range(5)]

    def some(tasks, kept, found, settings, progress):
        with kept:
            for task in tasks[:3]:
                k = int(task.key.split()[1])
                kept.note(k, (whole[k][0],), "")
        raise KeyboardInterrupt

    def rest(tasks, kept, found, settings, progress):
        asked.extend(task.key for task in tasks)
        for task in tasks:
            k = int(task.key.split()[1])
            found[k] = ((whole[k][0],), "")

    asked: list[str] = []
    monkeypatch.setattr(module, "_nominal", lambda *_: ((0.0,), ("m",), {DESIGN.name: "hash"}))
    monkeypatch.setattr(module, "_measure", some)
    with pytest.raises(KeyboardInterrupt):
        run(plan, output, Settings())
    with (tmp_path / "s.h5.part").open("a") as stream:
        stream.write("[4, [7.")  # half a line: killed while it wrote
    monkeypatch.setattr(module, "_measure", rest)
    assert [row[0] for row in run(plan, output, Settings()).measured] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert asked == ["sample 3", "sample 4"]


def test_what_does_not_depend_on_what_varies_is_taken_over(tmp_path):
    shutil.copytree(FIXTURES / "pairs" / "revolute_collars", tmp_path, dirs_exist_ok=True)
    design, base = tmp_path / "revolute_collars.toml", tmp_path / "base.h5"
    first = kinform.run(design, base)
    part = first.design.assembly.parts[0].name
    masses = []
    for density in (1000.0, 2000.0):
        done = method.run(design, base=base, reading=Reading(changes=((("part", part, "density"), density),)))
        assert {"surfaces", "contacts", "joints"} <= {sentence.split()[0] for sentence in done.reused}
        assert not any(sentence.startswith(("surfaces", "contacts", "joints")) for sentence in done.recomputed)
        masses.append(done.part_mass[part].mass)
    assert masses[1] == pytest.approx(2.0 * masses[0], rel=1e-12)


def test_commands_make_meshes_only_where_they_are_allowed(tmp_path):
    pair = FIXTURES / "pairs" / "revolute_collars"
    shutil.copytree(pair, tmp_path, dirs_exist_ok=True)
    mesh = next(iter(sorted(tmp_path.glob("*.stl"))))
    part = mesh.stem
    code = "import shutil, sys; shutil.copy(sys.argv[1], sys.argv[2])"
    words = json.dumps([sys.executable, "-c", code, str(mesh), "{file}"])
    (tmp_path / "s.toml").write_text(
        f'schema = 1\n[study]\ndesign = "revolute_collars.toml"\nmethod = "grid"\n[[vary]]\nname = "k"\nvalues = [1]\n'
        f'value = "part.{part}.density"\n[[make]]\npart = "{part}"\ncommand = {words}\n'
        '[[measure]]\nname = "mobility"\nvalue = "mobility.effective"\n'
    )
    ran = ran_here("study", "s.toml", "-o", "s.h5", cwd=tmp_path)
    assert ran.returncode == 2 and "--allow-commands" in ran.stderr and not (tmp_path / "s.h5").exists()
    design = str(tmp_path / "revolute_collars.toml")
    command = (part, [sys.executable, "-c", code, str(mesh), "{file}"], ".stl")
    assert sample(design, None, [], [("mobility", "effective")], [command]) == sample(
        design, None, [], [("mobility", "effective")]
    )
    failing = (part, [sys.executable, "-c", "import sys; print('no'); sys.exit(3)"], ".stl")
    with pytest.raises(InputError) as caught:
        sample(design, None, [], [], [failing])
    assert part in caught.value.problems[0].message and "3" in caught.value.problems[0].message


@pytest.mark.parametrize(
    "value", ["joints.joints.guide.type", "mass.bodies", "mobility", "mobility.effective.x", "nonsense.x"]
)
def test_what_is_no_number_cannot_be_measured(done, value):
    """A text, a list, a table, nothing, and no topic; the results of the design are there."""
    with pytest.raises(InputError) as caught:
        nominal(str(done / DESIGN.name), str(done / "base.h5"), [tuple(value.split("."))])
    assert any(f"{step}'" in caught.value.problems[0].message for step in value.split("."))


def test_commands_run_in_the_folder_of_the_study(tmp_path):
    pair = FIXTURES / "pairs" / "revolute_collars"
    shutil.copytree(pair, tmp_path, dirs_exist_ok=True)
    mesh = next(iter(sorted(tmp_path.glob("*.stl"))))
    words = [sys.executable, "-c", "import shutil, sys; shutil.copy(*sys.argv[1:])", mesh.name, "{file}"]
    command = (mesh.stem, words, ".stl")
    made = sample(str(tmp_path / "revolute_collars.toml"), None, [], [("mobility", "effective")], [command],
                  folder=str(tmp_path))  # fmt: skip
    assert made == (1.0,)


def test_a_study_of_which_every_sample_fails_is_told_by_the_exit_code(done, tmp_path, monkeypatch):
    for name in (DESIGN.name, "s.toml"):
        shutil.copy(done / name, tmp_path)

    def failed(tasks, kept, found, settings, progress):
        found.update({int(task.key.split()[1]): ((None,), "no") for task in tasks})

    monkeypatch.setattr(module, "_nominal", lambda *_: ((0.0,), ("m",), {DESIGN.name: "hash"}))
    monkeypatch.setattr(module, "_measure", failed)
    ran = ran_here("study", "s.toml", "-o", "s.h5", "--jobs", "1", cwd=tmp_path)
    assert ran.returncode == 2 and "failed" in ran.stdout and (tmp_path / "s.h5").exists()


def test_a_sample_that_cannot_be_computed_fails(done):
    """A crank of 1e300 mm."""
    with pytest.raises(InputError):
        sample(
            str(done / DESIGN.name), None, [(("function", "joint", "crank_pin", "point", "1"), 1e300)],
            [("mobility", "effective")],
        )  # fmt: skip


def test_a_measure_that_is_not_there_is_refused_before_samples_are_measured(done, tmp_path):
    shutil.copy(DESIGN, tmp_path)
    (tmp_path / "s.toml").write_text(STUDY.replace("joints.guide", "joints.guid"))
    ran = ran_here("study", "s.toml", "-o", "s.h5", cwd=tmp_path)
    assert ran.returncode == 2 and "guid" in ran.stderr and "guide" in ran.stderr


def test_samples_that_somebody_else_has_noted_are_measured_again(tmp_path):
    path = tmp_path / "s.h5.part"
    with Journal(path, "key") as journal:
        journal.note(0, (1.0,), "")
        journal.note(1, (2.0,), "")
    text = path.read_text()
    assert Journal(path, "key").read() == {0: ((1.0,), ""), 1: ((2.0,), "")}
    path.write_text(text.replace("[2.0]", "[3.0]"))
    forged = Journal(path, "key")
    assert forged.read() == {0: ((1.0,), "")} and forged.unknown == 1
    assert Journal(path, "key", trust=True).read() == {0: ((1.0,), ""), 1: ((3.0,), "")}
    path.write_text(text.replace("key", "other"))  # measured of another study
    assert not Journal(path, "other").read()
