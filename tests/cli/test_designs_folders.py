"""A folder in place of a file: the manifest in it, else the robot description, else the scene, else its meshes."""

from __future__ import annotations

import shutil

import pytest
from support.places import FIXTURES

from kinform_cli.main import main

PAIR = FIXTURES / "pairs" / "revolute_collars"
URDF = """<robot name="r"><link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<link name="arm"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="3 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


@pytest.fixture
def folder(tmp_path):
    return shutil.copytree(PAIR, tmp_path / "pair")


def test_every_command_that_takes_a_manifest_takes_its_folder(folder, capsys):
    (manifest,) = folder.glob("*.toml")
    for words in (["check"], ["show"], ["query", "--intended"]):
        assert main([words[0], str(manifest), *words[1:]]) == 0
        told = capsys.readouterr().out
        assert main([words[0], str(folder), *words[1:]]) == 0
        assert capsys.readouterr().out == told
    assert main(["diff", str(folder), str(manifest)]) == 0
    assert main(["import", str(folder), "-o", str(folder / "a.h5")]) == 0
    assert main(["export", str(folder), "--to", "urdf", "-o", str(folder / "a")]) == 0


def test_of_a_folder_without_manifest_its_meshes_are_taken(folder, capsys):
    for manifest in folder.glob("*.toml"):
        manifest.unlink()
    assert main(["init", str(folder)]) == 2
    assert "--units" in capsys.readouterr().err
    assert main(["init", str(folder), "--units", "mm"]) == 0
    assert capsys.readouterr().out.count("[[part]]") == len(list(folder.glob("*.stl")))


def test_a_description_comes_before_the_meshes_beside_it(folder, capsys):
    for manifest in folder.glob("*.toml"):
        manifest.unlink()
    (folder / "package.xml").write_text("<package><name>r</name></package>")
    (folder / "r.urdf").write_text(URDF)
    assert main(["init", str(folder)]) == 0
    assert 'name = "j"' in capsys.readouterr().out
    (folder / "s.urdf").write_text(URDF)
    assert main(["init", str(folder)]) == 2
    told = capsys.readouterr().err
    assert "r.urdf" in told and "s.urdf" in told


def test_a_manifest_is_not_begun_again(folder, capsys):
    assert main(["init", str(folder)]) == 2
    assert ".toml" in capsys.readouterr().err


def test_a_folder_of_nothing_is_refused(tmp_path, capsys):
    for command in ("check", "init", "show"):
        assert main([command, str(tmp_path)]) == 2
        assert f"{tmp_path}: error: " in capsys.readouterr().err
