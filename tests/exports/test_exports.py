"""`kinform export` as a user runs it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
import trimesh
from support.diagonal import first
from support.places import FIXTURES

from kinform import results
from kinform.exports import FORMATS
from kinform_cli.commands.export import Target
from kinform_cli.main import main

SEEKER = FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml"
FOUR_BAR = FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml"
CARRIES_A_LOOP = {"modelica", "vhdl-ams", "json", "glb", "csv", "dot"}
TABLE = FIXTURES / "pairs" / "general_ball_on_table" / "general_ball_on_table.toml"


@pytest.fixture(scope="module")
def stored(tmp_path_factory, derive_design):
    """A manifest as a results file, written once a module."""
    folder = tmp_path_factory.mktemp("stored")

    def store(manifest):
        path = folder / f"{manifest.stem}.h5"
        if not path.exists():
            results.write(derive_design(manifest), path)
        return str(path)

    return store


def test_the_command_offers_the_formats_of_the_registry():
    assert {target.value for target in Target} == set(FORMATS)


@pytest.mark.parametrize("format", sorted(FORMATS))
def test_every_format_is_written_and_written_again_alike(format, stored, tmp_path, capsys):
    """Where all of a four-bar is carried, `--strict` writes it too."""
    source, folder = stored(FOUR_BAR), tmp_path / "out" / format
    assert main(["export", source, "--to", format, "-o", str(folder)]) == 0
    first = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    assert first
    assert not [p for p in first if p.suffix == ".tmp"]
    strict = ["--strict"] * (format in CARRIES_A_LOOP)
    assert main(["export", source, "--to", format, "-o", str(folder), *strict]) == 0
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == first
    text, told = capsys.readouterr()
    assert text == ""
    assert told


def test_what_a_format_cannot_carry_is_named_and_strict_refuses_it(stored, tmp_path, capsys):
    source, folder = stored(FOUR_BAR), tmp_path / "urdf"
    assert main(["export", source, "--to", "urdf", "-o", str(folder)]) == 0
    # its function states that joint last
    assert "base~rocker_unit" in capsys.readouterr().err
    assert "not carried: base~rocker_unit" in (folder / "four_bar.urdf").read_text()
    strict = tmp_path / "strict"
    assert main(["export", source, "--to", "urdf", "-o", str(strict), "--strict"]) == 2
    assert "base~rocker_unit" in capsys.readouterr().err
    assert not strict.exists()


def test_what_is_not_carried_of_many_for_one_reason_is_told_once(tmp_path, capsys):
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "box.stl")
    parts = [f'[[part]]\nname = "p{k}"\nmesh = "box.stl"\nposition = [{2 * k}, 0, 0]\n' for k in range(10)]
    manifest = tmp_path / "row.toml"
    manifest.write_text('schema = 1\n[assembly]\nname = "row"\nunits = "m"\n' + "".join(parts), encoding="utf-8")
    assert main(["run", str(manifest), "-o", str(tmp_path / "row.h5")]) in (0, 1)
    capsys.readouterr()
    assert main(["export", str(tmp_path / "row.h5"), "--to", "mjcf", "-o", str(tmp_path / "mjcf")]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if "p1" in line]
    assert lines and all("p4" in line and "p5" not in line for line in lines)
    written = (tmp_path / "mjcf" / "row.xml").read_text()
    assert all(f"not carried: p{k}:" in written for k in range(1, 10))


@pytest.mark.parametrize("format", first(2, ["urdf", "vhdl-ams", "sdf", "mjcf", "modelica", "json"]))
def test_a_joint_that_is_no_lower_pair_is_named(format, stored, tmp_path, capsys):
    folder = tmp_path / format
    assert main(["export", stored(TABLE), "--to", format, "-o", str(folder)]) == 0
    assert "ball~table" in capsys.readouterr().err
    assert any(b"ball~table" in p.read_bytes() for p in folder.iterdir() if p.is_file())
    assert main(["export", stored(TABLE), "--to", format, "-o", str(tmp_path / "no"), "--strict"]) == 2


def test_csv_without_a_motion_is_refused(stored, tmp_path, capsys):
    assert main(["export", stored(TABLE), "--to", "csv", "-o", str(tmp_path / "csv")]) == 2


def test_usage_and_places_are_checked(stored, tmp_path, capsys):
    source = stored(SEEKER)
    assert main(["export", source, "--to", "step", "-o", str(tmp_path / "x")]) == 2
    assert "--to" in capsys.readouterr().err
    (tmp_path / "file").write_text("precious")
    assert main(["export", source, "--to", "dot", "-o", str(tmp_path / "file")]) == 2
    assert (tmp_path / "file").read_text() == "precious"
    assert main(["export", str(tmp_path / "file"), "--to", "dot", "-o", str(tmp_path / "x")]) == 2
    assert not (tmp_path / "x").exists()


def test_a_manifest_gives_what_its_results_give(stored, tmp_path):
    """Whatever is missing is run first, as `report` does."""
    for source, folder in ((stored(SEEKER), "from_results"), (str(SEEKER), "from_manifest")):
        assert main(["export", source, "--to", "dot", "-o", str(tmp_path / folder)]) == 0
    (one,), (other,) = ((tmp_path / name).iterdir() for name in ("from_results", "from_manifest"))
    assert (one.name, one.read_bytes()) == (other.name, other.read_bytes())


def test_before_joints_are_derived_it_says_what_to_run(tmp_path, capsys):
    path = tmp_path / "a.h5"
    assert main(["import", str(SEEKER), "-o", str(path)]) == 0
    assert main(["export", str(path), "--to", "urdf", "-o", str(tmp_path / "x")]) == 2
    assert "kinform joints" in capsys.readouterr().err


def test_quiet_writes_and_says_nothing(stored, tmp_path, capsys):
    assert main(["export", stored(FOUR_BAR), "--to", "urdf", "-o", str(tmp_path / "q"), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_templates_are_part_of_the_package():
    """What a wheel holds is what the package folder holds: templates are found where the code is."""
    code = "from importlib.resources import files; print(*(p.name for p in files('kinform').rglob('*.j2')))"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=dict(os.environ))
    assert {"robot.urdf.j2", "model.sdf.j2", "model.mjcf.j2", "package.mo.j2", "system.vhd.j2"} <= set(
        ran.stdout.split()
    )
