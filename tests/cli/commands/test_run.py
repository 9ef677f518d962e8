"""Ranges of `run` and `simulate`, asked for or not: what they compute, print and answer, and what the gate makes of
it."""

from __future__ import annotations

import json
import re
from math import asin, atan2, degrees, hypot
from pathlib import Path

import numpy as np
import pytest
from support.slots import lever_between_pegs
from support.solids import save

from kinform.results import read
from kinform_cli.main import main

UPPER = degrees(atan2(12, 32) - asin(4 / hypot(32, 12)))
LOWER = degrees(atan2(16, 24) - asin(4 / hypot(24, 16)))
"""Degrees from the pose of the meshes at which the lever meets its pegs."""

PARTS = """schema = 1
[assembly]
name = "lever"
units = "mm"
ground = "base"
[[part]]
name = "base"
mesh = "base.stl"
material = "steel"
[[part]]
name = "lever"
mesh = "lever.stl"
material = "steel"
"""
STATED = """[function]
mobility = 1
[[function.joint]]
name = "swing"
between = ["base", "lever"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
{range}
[[function.drive]]
joint = "swing"
kind = "motion"
law = {{type = "sine", amplitude = {amplitude}, frequency = 1.0}}
[simulation]
level = "kinematic"
duration = 1.0
step = 0.01
"""


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lever")
    for name, solid in lever_between_pegs().items():
        save(solid, folder / f"{name}.stl")
    return folder


def ran(
    folder: Path, capsys: pytest.CaptureFixture[str], name: str, text: str, *options: str
) -> tuple[int, str, dict[str, str]]:
    """Exit code, what was printed, and the findings by code."""
    (folder / f"{name}.toml").write_text(text)
    capsys.readouterr()
    code = main(["run", str(folder / f"{name}.toml"), "-o", str(folder / f"{name}.h5"), "-q", *options])
    text = capsys.readouterr().out
    report = read(folder / f"{name}.h5").report
    assert report is not None
    return code, text, {f.code: f.message for f in report.findings}


def test_ranges_that_nothing_states_are_found_unless_told_not_to(
    meshes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ran(meshes, capsys, "plain", PARTS, "--no-ranges")[0] == 0
    plain = read(meshes / "plain.h5").simulation
    assert plain is not None
    assert plain.ranges is None
    assert ran(meshes, capsys, "plain", PARTS)[0] == 0
    (joint,) = json.loads(shown(meshes / "plain.h5", "joints", capsys))["joints"]
    assert joint["range"]["status"] == "found"
    assert np.degrees([joint["range"]["lower"], joint["range"]["upper"]]) == pytest.approx([-LOWER, UPPER], abs=0.01)
    capsys.readouterr()
    assert main(["show", str(meshes / "plain.h5"), "simulation"]) == 0
    text = capsys.readouterr().out
    assert f"{-LOWER:.2f}"[:-1] in text
    assert "base/lever" in text


def shown(file: Path, topic: str, capsys: pytest.CaptureFixture[str]) -> str:
    capsys.readouterr()
    assert main(["show", str(file), topic, "--format", "json"]) == 0
    return capsys.readouterr().out


def test_simulate_finds_the_same_and_leaves_them_out_where_told_to(
    meshes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PARTS + STATED.format(range="range = [-15, 10]", amplitude=5)
    code, _, findings = ran(meshes, capsys, "stated", text)
    assert code == 0
    assert not {"KF412", "KF505"} & set(findings)
    asked, left_out = meshes / "asked.h5", meshes / "left_out.h5"
    assert main(["simulate", str(meshes / "stated.h5"), "-o", str(asked), "--ranges", "-q"]) == 0
    assert main(["simulate", str(meshes / "stated.h5"), "-o", str(left_out), "--no-ranges", "-q"]) == 0
    by_default, found, without = (read(f).simulation for f in (meshes / "stated.h5", asked, left_out))
    assert by_default is not None
    assert found is not None
    assert without is not None
    assert without.ranges is None
    assert [(r.lower.value, r.upper.value) for r in found.ranges or ()] == [
        (r.lower.value, r.upper.value) for r in by_default.ranges or ()
    ]


def test_where_it_would_take_long_they_are_found_where_they_are_asked_for_and_that_is_said(
    meshes: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kinform.collisions.joint_ranges.UNASKED_PAIRS", 1)
    assert ran(meshes, capsys, "long", PARTS)[0] == 0
    unasked = read(meshes / "long.h5").simulation
    assert unasked is not None
    assert unasked.ranges is None
    (said,) = (text for text in unasked.assumptions if "--ranges" in text)
    assert [int(number) for number in re.findall(r"\b\d+\b", said)[:2]] == [1, 2]  # joints, parts
    capsys.readouterr()
    assert main(["show", str(meshes / "long.h5"), "simulation"]) == 0
    assert "--ranges" in capsys.readouterr().out
    assert main(["run", str(meshes / "long.toml"), "-o", str(meshes / "said.h5")]) == 0
    assert "--ranges" in capsys.readouterr().err
    for name, options, text in (
        ("long", ["--ranges"], PARTS),
        ("told", [], PARTS + STATED.format(range="range = [-15, 10]", amplitude=5)),
    ):
        ran(meshes, capsys, name, text, *options)
        run = read(meshes / f"{name}.h5").simulation
        assert run is not None
        assert run.ranges
        assert not any("--ranges" in sentence for sentence in run.assumptions)


def test_a_range_that_a_peg_cuts_short_and_a_run_into_it_close_the_gate(
    meshes: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = PARTS + STATED.format(range="range = [-20, 30]", amplitude=20)
    code, printed, findings = ran(meshes, capsys, "short", text, "--ranges")
    assert code == 1
    assert "swing" in findings["KF412"]
    assert "'base'" in findings["KF505"] and "'lever'" in findings["KF505"]
    assert "KF412" in printed
    assert "KF505" in printed
    run = read(meshes / "short.h5").simulation
    assert run is not None
    (met,) = run.collisions
    assert met.time == pytest.approx(asin(UPPER / 20) / (2 * np.pi), abs=1e-3)
