"""What contact lets go, as the command tells it: `show joints`, `show joints --joint`, `query`, `query --intended`."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from support.places import FIXTURES

from kinform import results as results_file
from kinform_cli.main import main


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory, derive_design) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("questions")
    out = {}
    for name in ("planar_block", "revolute_collars"):
        file = folder / f"{name}.h5"
        manifest = FIXTURES / "pairs" / name / f"{name}.toml"
        results_file.write(derive_design(manifest), file)
        out[name] = file
    return out


def printed(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    capsys.readouterr()
    assert main([str(a) for a in arguments]) == 0
    return capsys.readouterr().out


def test_joints_say_how_they_come_apart(results: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    (joint,) = json.loads(printed(capsys, "show", results["planar_block"], "joints", "-f", "json"))["joints"]
    assert joint["held"] is False
    assert joint["releases"][0]["direction"] == pytest.approx([0, 0, -1])
    (joint,) = json.loads(printed(capsys, "show", results["revolute_collars"], "joints", "-f", "json"))["joints"]
    assert (joint["held"], joint["releases"]) == (True, [])


def test_one_joint_shows_its_patches_its_gap_and_its_alternatives(
    results: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    file = results["revolute_collars"]
    text = printed(capsys, "show", file, "joints", "--joint", "block~shaft")
    assert "3 patches" in text and "cylindrical" in text
    found = json.loads(printed(capsys, "show", file, "joints", "--joint", "block~shaft", "-f", "json"))
    assert found["schema"] == "kinform/joint/1"
    assert {item["type"] for item in found["alternatives"]} == {"planar", "cylindrical"}


def test_a_joint_is_shown_by_the_name_that_its_designer_gave_it(
    results: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(results["revolute_collars"])
    (joint,) = json.loads(printed(capsys, "show", file, "joints", "-f", "json"))["joints"]
    (intended,) = json.loads(printed(capsys, "query", file, "--intended", "-f", "json"))["joints"]
    assert intended["name"] != joint["name"]
    told = printed(capsys, "show", file, "joints", "--joint", joint["name"])
    assert printed(capsys, "show", file, "--joint", intended["name"]) == told
    assert main(["show", file, "--joint", f"{intended['name']}s"]) == 2
    assert f'"{intended["name"]}"' in capsys.readouterr().err


def test_another_joint_or_topic_is_refused(results: dict[str, Path], capsys: pytest.CaptureFixture[str]) -> None:
    file = str(results["revolute_collars"])
    assert main(["show", file, "joints", "--joint", "nope"]) == 2
    assert "block~shaft" in capsys.readouterr().err
    assert main(["show", file, "mass", "--joint", "block~shaft"]) == 2
    assert main(["query", file, "block", "shaft", "--slide", "x", "--intended"]) == 2
    assert main(["query", file]) == 2


def test_queries_are_answered_one_way_and_for_what_is_intended(
    results: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    file = results["planar_block"]
    found = json.loads(printed(capsys, "query", file, "table", "block", "--slide", "z", "-f", "json"))
    assert found["ways_in_pair"] == found["ways_in_assembly"] == {"forward": True, "backward": False}
    intended = json.loads(printed(capsys, "query", results["revolute_collars"], "--intended", "-f", "json"))
    assert all(set(item) >= {"name", "free", "motions", "text"} for item in intended["joints"])


def test_a_joint_without_contact_is_answered_as_the_check_answers_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = FIXTURES / "pairs" / "free_apart"
    text = (source / "free_apart.toml").read_text()
    parts = re.findall(r'^name = "(.*)"', text, re.MULTILINE)[1:3]
    for mesh in source.iterdir():
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    (tmp_path / "apart.toml").write_text(
        text.split("[function")[0]
        + f"[[function.joint]]\nname = 'turn'\nbetween = {json.dumps(parts)}\ntype = 'revolute'\n"
        + "axis = [0, 0, 1]\npoint = [0, 0, 0]\n"
    )
    file = tmp_path / "apart.h5"
    assert main(["run", str(tmp_path / "apart.toml"), "-o", str(file), "-q"]) == 1
    assert "KF401" in capsys.readouterr().out
    assert "KF401" in printed(capsys, "query", file, "--intended")
    (joint,) = json.loads(printed(capsys, "query", file, "--intended", "-f", "json"))["joints"]
    assert (joint["answer"], joint["free"], joint["joint"]) == ("no contact", True, None)


def test_tables_of_joints_have_the_designers_names_and_places_in_mm(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = FIXTURES / "pairs" / "revolute_collars"
    for mesh in source.iterdir():
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    manifest = tmp_path / "revolute_collars.toml"
    text = manifest.read_text()
    name = re.findall(r'\[\[function.joint\]\]\nname = "(.*)"', text)[0]
    file = tmp_path / "r.h5"
    main(["run", str(manifest), "-o", str(file), "-q"])
    shown = " ".join(printed(capsys, "show", file, "joints").split())
    assert " mm" in shown
    assert re.search(f"block~shaft (intended: )?{name} (type: )?revolute", shown)
    (joint,) = json.loads(printed(capsys, "show", file, "joints", "-f", "json"))["joints"]
    asked = ["query", file, "block", "shaft", "--turn"]
    place = ",".join(f"{1e3 * value:.6f}" for value in joint["point"])
    found = json.loads(printed(capsys, *asked, f"{','.join(map(str, joint['axis']))}@{place}mm", "-f", "json"))
    assert found["ways_in_pair"] == {"forward": True, "backward": True}
