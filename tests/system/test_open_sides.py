"""Joints without `between`, or with one side of it, as the command takes, reuses and refuses them."""

from __future__ import annotations

import json
import shutil

import pytest
from support.places import FIXTURES

from kinform.errors import InputError
from kinform.form import load

FORK = FIXTURES / "pairs" / "revolute_fork"
BETWEEN = 'between = ["fork", "eye"]\n'


@pytest.fixture
def fork(tmp_path):
    shutil.copytree(FORK, tmp_path / "fork")
    manifest = tmp_path / "fork" / "revolute_fork.toml"
    text = manifest.read_text()
    assert BETWEEN in text
    return manifest, text


@pytest.mark.parametrize(
    ("between", "sides"),
    [pytest.param("", ["fork", "eye"], marks=pytest.mark.sweep), ('between = ["eye"]\n', ["eye", "fork"])],
)
def test_sides_are_told_kept_and_told_again(command, fork, between, sides):
    manifest, text = fork
    manifest.write_text(text.replace(BETWEEN, between))
    assert command("run", manifest, "-o", "a.h5").returncode == 0
    first = (manifest.parent.parent / "a.h5").read_bytes()
    found = json.loads(command("show", "a.h5", "joints", "-f", "json").stdout)["sides"]
    assert [(one["joint"], one["parts"]) for one in found] == [("main", sides)]
    assert command("joints", "a.h5", "-o", "b.h5").returncode == 0
    assert json.loads(command("show", "b.h5", "joints", "-f", "json").stdout)["sides"] == found
    again = command("run", manifest, "-o", "a.h5")
    assert "→" not in again.stderr
    assert (manifest.parent.parent / "a.h5").read_bytes() == first


def test_what_contact_does_not_tell_is_refused_at_its_line(command, fork):
    manifest, text = fork
    lines = text.replace(BETWEEN, "").splitlines()
    line = lines.index("[[function.joint]]") + 1
    manifest.write_text("\n".join(lines).replace("point = [1, 2, -0.5]", "point = [1, 2.5, -0.5]"))
    ran = command("run", manifest, "-o", "a.h5")
    assert ran.returncode == 2
    assert f"revolute_fork.toml:{line}: error: [[function.joint]] 'main' " in ran.stderr


def test_fixed_joints_and_joints_of_sticks_name_both(fork, tmp_path):
    manifest, text = fork
    manifest.write_text(text.replace(BETWEEN, 'between = ["fork"]\n').replace('"revolute"\n', '"fixed"\n'))
    with pytest.raises(InputError):
        load(manifest)
    sticks = 'schema = 1\n[assembly]\nname = "x"\nunits = "mm"\n[[part]]\nname = "a"\n[[part]]\nname = "b"\n'
    sticks += '[[function.joint]]\nname = "j"\ntype = "prismatic"\naxis = [1, 0, 0]\n'
    (tmp_path / "sticks.toml").write_text(sticks)
    with pytest.raises(InputError):
        load(tmp_path / "sticks.toml")


def test_a_sub_assembly_stands_for_its_ground_or_its_largest_part(fork):
    manifest, text = fork
    above = manifest.parent / "above.toml"
    above.write_text(
        'schema = 1\n[assembly]\nname = "above"\nunits = "m"\n'
        '[[subassembly]]\nname = "hinge"\n'
        'file = "revolute_fork.toml"\n[[subassembly]]\nname = "other"\nfile = "revolute_fork.toml"\n'
        "position = [0, 9, 0]\n"
        '[[function.joint]]\nname = "far"\nbetween = ["hinge", "other"]\ntype = "prismatic"\naxis = [0, 1, 0]\n'
    )
    (joint,) = (one for one in load(above).function.joints if one.name == "far")
    assert joint.between == ("hinge/fork", "other/fork")
    manifest.write_text(text.replace('ground = "fork"\n', ""))
    assembly = load(above)
    (joint,) = (one for one in assembly.function.joints if one.name == "far")
    largest = max(assembly.parts, key=lambda part: part.mesh.health.volume)
    assert joint.between[0].split("/")[1] == largest.name.split("/")[1]
