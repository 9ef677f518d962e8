"""The catalog: what designs do, kept in an SQLite file, and found again."""

from __future__ import annotations

import contextlib
import json
import re
import shutil
import sqlite3
from pathlib import Path

import pytest
from support.places import FIXTURES
from support.walkers import Walker

from kinform import results
from kinform.catalog import joint_count
from kinform_cli.main import main

DESIGNS = {
    "arms/seeker.h5": "seekers/seeker_1dof/seeker_1dof.toml",
    "four_bar.h5": "functional/stick_four_bar/stick_four_bar.toml",
    "hinge.h5": "pairs/revolute_collars/revolute_collars.toml",
}


@pytest.fixture(scope="module")
def filed(tmp_path_factory, derive_design):
    """A folder of results files, one in a folder of its own, and the catalog beside it, which nobody changes."""
    folder = tmp_path_factory.mktemp("catalog")
    (folder / "designs/arms").mkdir(parents=True)
    for name, manifest in DESIGNS.items():
        results.write(derive_design(FIXTURES / manifest), folder / "designs" / name)
    with contextlib.chdir(folder):
        assert main(["catalog", "add", "designs", "-q"]) == 0
    return folder


@pytest.fixture
def as_filed(filed, monkeypatch):
    """That folder, for who only looks."""
    monkeypatch.chdir(filed)


@pytest.fixture
def designs(filed, tmp_path, monkeypatch):
    """A copy of that folder."""
    shutil.copytree(filed, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "designs"


@pytest.fixture
def found(capsys):
    def find(*arguments):
        capsys.readouterr()
        assert main(["catalog", "find", "--format", "json", *arguments]) == 0
        return [design["path"] for design in json.loads(capsys.readouterr().out)["designs"]]

    return find


@pytest.mark.parametrize("asked, expected", [
    ([], ["designs/hinge.h5", "designs/arms/seeker.h5", "designs/four_bar.h5"]),
    (["--joint", "revolute:4", "--loops", "1"], ["designs/four_bar.h5"]),
    (["--joint", "revolute:1", "--mobility", "1"], ["designs/hinge.h5", "designs/arms/seeker.h5"]),
    (["--joint", "revolute:2+"], ["designs/four_bar.h5"]),
    (["--joint", "prismatic"], []),
    (["--joints", "4"], ["designs/four_bar.h5"]),
    (["--name", "CAMERA"], ["designs/arms/seeker.h5"]),
    (["--name", "rocker_pin"], ["designs/four_bar.h5"]),
    (["--name", "designs/arms", "--name", "yaw"], ["designs/arms/seeker.h5"]),
    (["--min-mass", "0.3", "--max-mass", "0.4"], ["designs/arms/seeker.h5"]),
    (["--max-size", "0.0901", "--name", "seeker"], ["designs/arms/seeker.h5"]),
    (["--max-size", "0.0899", "--name", "seeker"], []),
], ids=lambda x: " ".join(x) if x and x[0].startswith("-") else "")  # fmt: skip
def test_designs_are_found_by_what_they_do(as_filed, found, asked, expected):
    assert found(*asked) == expected


def test_what_is_not_known_never_matches(as_filed, found):
    stick = "designs/four_bar.h5"
    assert stick not in found("--min-mass", "0")
    assert stick not in found("--max-size", "1000")
    assert found("--meets", "reach") == []


def test_the_catalog_is_rebuilt_from_the_results_with_the_same_bytes(designs, found, capsys):
    catalog = designs.parent / "catalog.sqlite"
    before = catalog.read_bytes()
    assert main(["catalog", "rebuild", "-q"]) == 0
    assert catalog.read_bytes() == before
    (designs / "hinge.h5").unlink()
    shutil.copy(designs / "arms/seeker.h5", designs / "another.h5")
    assert main(["catalog", "rebuild", "-q"]) == 0
    assert found() == ["designs/another.h5", "designs/arms/seeker.h5", "designs/four_bar.h5"]


def test_order_and_number_of_additions_change_no_byte(designs, tmp_path):
    for names in (["arms/seeker.h5", "hinge.h5"], ["hinge.h5", "arms/seeker.h5", "hinge.h5"]):
        catalog = tmp_path / f"{len(names)}.sqlite"
        for name in names:
            assert main(["catalog", "add", str(designs / name), "-q", "-c", str(catalog)]) == 0
    assert (tmp_path / "2.sqlite").read_bytes() == (tmp_path / "3.sqlite").read_bytes()


def test_results_that_changed_or_went_are_said_to_be_stale(designs, capsys):
    shutil.copy(designs / "hinge.h5", designs / "arms/seeker.h5")
    (designs / "four_bar.h5").unlink()
    capsys.readouterr()
    assert main(["catalog", "find"]) == 0
    ran = capsys.readouterr()
    assert re.findall(r"(\S+\.h5) \((\w+)\)", ran.out) == [
        ("designs/arms/seeker.h5", "changed"), ("designs/four_bar.h5", "gone"),
    ]  # fmt: skip
    assert "kinform catalog rebuild" in ran.err


def test_other_programs_read_the_catalog(designs):
    with sqlite3.connect(designs.parent / "catalog.sqlite") as database:
        query = "SELECT d.name, j.intended, j.type FROM designs d JOIN joints j ON j.design = d.path WHERE d.mass < 0.4"
        assert ("seeker_1dof", "yaw", "revolute") in database.execute(query).fetchall()


def test_files_of_others_are_left_out_and_said_so(designs, capsys):
    (designs / "other.h5").write_text("no results")
    assert main(["catalog", "add", "designs"]) == 0
    assert "designs/other.h5" in capsys.readouterr().err


@pytest.mark.parametrize("arguments, message", [
    (["add", "nowhere"], "nowhere: error: "),
    (["add", "empty"], "empty: error: "),
    (["add", "note.txt"], "note.txt: error: "),
    (["add", "designs", "-c", "note.txt"], "note.txt: error: "),
    (["find", "-c", "note.txt"], "note.txt: error: "),
    (["find", "-c", "missing.sqlite"], "missing.sqlite: error: "),
    (["rebuild", "-c", "designs/hinge.h5"], "designs/hinge.h5: error: "),
    (["find", "--joint", "hinge"], "hinge"),
    (["find", "--joint", "revolute:many"], "TYPE:COUNT"),
    (["find", "--max-mass", "nan"], "--max-mass"),
], ids=lambda x: " ".join(x) if isinstance(x, list) else "")  # fmt: skip
def test_bad_input_is_refused_with_a_remedy(designs, capsys, arguments, message):
    (designs.parent / "note.txt").write_text("a note")
    (designs.parent / "empty").mkdir()
    capsys.readouterr()
    assert main(["catalog", *arguments]) == 2
    ran = capsys.readouterr()
    assert message in ran.err
    assert "remedy:" in ran.err
    assert (designs.parent / "note.txt").read_text() == "a note"


def test_a_damaged_catalog_is_an_error_and_no_traceback(designs, capsys):
    catalog = designs.parent / "catalog.sqlite"
    image = bytearray(catalog.read_bytes())
    image[4096:] = bytes(len(image) - 4096)
    catalog.write_bytes(image)
    assert main(["catalog", "find"]) == 2
    assert "catalog.sqlite: error:" in capsys.readouterr().err


def test_counts_of_joints():
    assert joint_count("revolute") == ("revolute", 1, None)
    assert joint_count("revolute:2") == ("revolute", 2, 2)
    assert joint_count("revolute:0") == ("revolute", 0, 0)
    assert joint_count("Revolute:2+") == ("revolute", 2, None)


def test_a_description_is_run_first_with_its_results_beside_it(tmp_path, monkeypatch, found, capsys):
    monkeypatch.chdir(tmp_path)
    Path("walker.urdf").write_text(Walker().text())
    assert main(["catalog", "add", "walker.urdf"]) == 0
    assert "walker.h5" in capsys.readouterr().err
    assert found("--joint", "revolute:4") == ["walker.h5"]
    assert main(["catalog", "rebuild", "-q"]) == 0
    assert found() == ["walker.h5"]
    Path("walker.xml").write_text("<mujoco/>")
    assert main(["catalog", "add", "walker.xml"]) == 2
    assert "walker.h5" in capsys.readouterr().err
