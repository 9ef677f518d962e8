"""Commands that look at a design take it from any source; wrong use is answered by what to do."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from support.command_line import ran_here
from tests.support.places import ROOT
from tests.support.robots import urdf, write


def kinform(*words):
    return ran_here(*words, cwd=Path.cwd())


STEP = ROOT / "tests" / "form" / "scenes" / "step" / "revolute_collars.step"


@pytest.fixture
def robot(tmp_path):
    return write(tmp_path, urdf())


LOOKS = [
    ("show", "SOURCE", "joints"),
    ("check", "SOURCE"),
    ("diff", "SOURCE", "SOURCE"),
    ("export", "SOURCE", "--to", "json", "-o", "OUT"),
    ("query", "SOURCE", "base", "arm", "--slide", "0,0,1"),
]


@pytest.mark.parametrize("words", LOOKS, ids=lambda words: words[0])
def test_a_design_is_looked_at_without_a_results_file(robot, tmp_path, words):
    said = {"SOURCE": str(robot), "OUT": str(tmp_path / "out")}
    done = kinform(*(said.get(word, word) for word in words))
    assert done.returncode == (0 if words[0] != "check" else done.returncode) and done.returncode in (0, 1, 2)
    assert "error:" not in done.stderr
    assert not list(robot.parent.glob("*.h5"))


def test_what_is_shown_is_that_of_a_results_file(robot, tmp_path):
    kinform("run", str(robot), "-o", str(tmp_path / "r.h5"))
    files = robot, tmp_path / "r.h5"
    one, other = (json.loads(kinform("show", path, "joints", "--format", "json").stdout) for path in files)
    assert one == other


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("a.step", ["--units", "mm"], "states its own unit"),
        ("a.urdf", ["--units", "mm"], "metres"),
        ("a.iges", [], "export STEP"),
        ("a.fcstd", ["--units", "mm"], "export STEP"),
        ("a.ply", [], "--units mm"),
        ("a.step", ["--deviation", "3"], "0.01mm"),
        ("a.step", ["--deviation", "-1mm"], "0.01mm"),
        ("no.step", [], "does not exist"),
    ],
)
def test_wrong_use_is_answered_by_what_to_do(tmp_path, name, options, words):
    if name != "no.step":
        shutil.copy(STEP, tmp_path / name)
    done = kinform("run", str(tmp_path / name), *options)
    assert done.returncode == 2 and words in done.stderr and "remedy:" in done.stderr
