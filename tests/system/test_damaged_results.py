"""A results file that somebody changed and sealed again, and that makes no sense, is made again where it is written."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest
from support.command_line import ran_here
from support.diagonal import first
from support.places import FIXTURES
from support.sealing import editing

import kinform
from kinform import results

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> bytes:
    """As a run writes it."""
    path = tmp_path_factory.mktemp("good") / "r.h5"
    kinform.run(PAIR / NAME, path)
    return path.read_bytes()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(PAIR, tmp_path, dirs_exist_ok=True)
    return tmp_path


def _beyond(file: h5py.File) -> None:
    file["joints/patches"][0] = 99


def _without_bodies(file: h5py.File) -> None:
    del file["joints/bodies"]


def _nested_inputs(file: h5py.File) -> None:
    for group in file.values():
        group.attrs["inputs"] = json.dumps({"meshes": {"deep": [1]}})


def _text_for_a_vertex(file: h5py.File) -> None:
    del file["assembly/vertices"]
    file["assembly/vertices"] = "far"


EDITS: dict[str, Callable[[h5py.File], None]] = {
    "a patch beyond": _beyond,
    "inputs that are none": _nested_inputs,
    "no bodies": _without_bodies,
    "a text for vertices": _text_for_a_vertex,
}


def _spoil(path: Path, good: bytes, edit: str) -> None:
    path.write_bytes(good)
    with editing(path) as file:
        EDITS[edit](file)


@pytest.mark.parametrize("edit", first(2, list(EDITS)))
def test_a_run_makes_it_again_with_a_warning_though_nothing_else_changed(edit: str, folder: Path, good: bytes) -> None:
    _spoil(folder / "r.h5", good, edit)
    ran = ran_here("run", NAME, "-o", "r.h5", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    if edit != "inputs that are none":  # of what is as it would come out, nobody asks what it was made of
        assert "warning: r.h5: " in ran.stderr
        assert (folder / "r.h5").read_bytes() == good
    assert "internal" not in ran.stderr


@pytest.mark.parametrize("edit", [pytest.param(e, marks=[] if e == "no bodies" else pytest.mark.sweep) for e in EDITS])
def test_a_run_of_a_changed_manifest_makes_it_again(edit: str, folder: Path, good: bytes) -> None:
    text = (folder / NAME).read_text()
    (folder / NAME).write_text(text.replace("[function]", "[check]\nselect = ['KF1', 'KF2']\n[function]", 1))
    assert (folder / NAME).read_text() != text
    kinform.run(folder / NAME, folder / "fresh.h5")
    _spoil(folder / "r.h5", good, edit)
    ran = ran_here("run", NAME, "-o", "r.h5", cwd=folder)
    assert ran.returncode in (0, 1), ran.stderr
    assert "internal" not in ran.stderr
    assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()


@pytest.mark.parametrize(
    "stage",
    [
        "joints",
        *(pytest.param(s, marks=pytest.mark.sweep) for s in ("check", "import", "contacts", "mass", "simulate")),
    ],
)
def test_it_counts_as_absent_as_the_target_of_a_stage(stage: str, folder: Path, good: bytes) -> None:
    (folder / "good.h5").write_bytes(good)
    _spoil(folder / "spoilt.h5", good, "a patch beyond")
    assert results.fault_of(folder / "spoilt.h5") is not None
    for name in ("fresh.h5", "spoilt.h5"):
        ran = ran_here(stage, NAME if stage == "import" else "good.h5", "-o", name, cwd=folder)
        assert ran.returncode == 0, ran.stderr
        assert ("warning: spoilt.h5: " in ran.stderr) == (name == "spoilt.h5")
    assert (folder / "spoilt.h5").read_bytes() == (folder / "fresh.h5").read_bytes()


def test_contacts_reuse_nothing_of_a_target_that_makes_no_sense(folder: Path, good: bytes) -> None:
    """Earlier contacts are read before they are reused."""
    (folder / "good.h5").write_bytes(good)
    (folder / "spoilt.h5").write_bytes(good)
    with editing(folder / "spoilt.h5") as file:
        rows = file["contacts/samples"][()]
        rows["patch"] += 99
        file["contacts/samples"][...] = rows
    ran = ran_here("contacts", "good.h5", "-o", "spoilt.h5", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    ran_here("contacts", "good.h5", "-o", "fresh.h5", cwd=folder)
    assert (folder / "spoilt.h5").read_bytes() == (folder / "fresh.h5").read_bytes()
