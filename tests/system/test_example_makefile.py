"""The example Makefile: builds converge, and a red gate stays red."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess

import pytest
from support.command_line import KINFORM
from support.places import ROOT


@pytest.fixture
def project(tmp_path):
    if not KINFORM.exists() or shutil.which("make") is None:
        pytest.skip("needs make, and kinform installed beside the interpreter")
    (tmp_path / "examples").mkdir()
    shutil.copy(ROOT / "examples" / "Makefile", tmp_path / "examples" / "Makefile")
    name = "four_bar_missing_pin"
    shutil.copytree(ROOT / "fixtures" / "broken" / name, tmp_path / "fixtures" / "broken" / name)
    return tmp_path / "examples"


def make(project, *arguments):
    command = ["make", "-C", str(project), f"KINFORM={KINFORM}", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def made(project):
    """The bytes of all results."""
    return {path.name: path.read_bytes() for path in sorted((project / "build").glob("*.h5"))}


@pytest.mark.slow
def test_whatever_changes_a_build_ends_with_the_bytes_of_one_from_nothing_and_then_nothing_is_left_to_do(project):
    design = project.parent / "fixtures" / "pairs" / "planar_block"
    shutil.copytree(ROOT / "fixtures" / "pairs" / "planar_block", design)
    only = ("DESIGNS=block", "block=../fixtures/pairs/planar_block/planar_block.toml")

    def built():
        ran = make(project, *only, "all", "check")
        assert ran.returncode == 0, ran.stderr
        assert make(project, *only, "-q", "all").returncode == 0
        return made(project)

    first = built()
    (project / "build" / "block.joints.h5").unlink()
    later = (project / "build" / "block.imported.h5").stat().st_mtime + 2
    os.utime(design / "block.stl", (later, later))  # the same content
    assert make(project, *only, "-q", "all").returncode == 1
    assert built() == first
    manifest = design / "planar_block.toml"
    manifest.write_text(re.sub(r'material = "\w+"', 'material = "brass"', manifest.read_text(), count=1))
    assert (second := built()) != first
    shutil.rmtree(project / "build")
    assert built() == second


def test_a_red_gate_is_red_the_second_time_too(project):
    broken = "broken=../fixtures/broken/four_bar_missing_pin/four_bar_missing_pin.toml"
    first = make(project, "DESIGNS=broken", broken, "check")
    second = make(project, "DESIGNS=broken", broken, "check")
    assert first.returncode != 0
    assert second.returncode != 0
    (code, *_) = json.loads((project.parent / "fixtures/broken/four_bar_missing_pin/codes.json").read_text())
    assert code in first.stdout
    assert code in second.stdout
