"""Outputs of every command leave a planted link, and what it leads to, alone."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from support.places import FIXTURES

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> Path:
    """A design with its results, and a precious file outside."""
    from support.command_line import ran_here

    place = tmp_path_factory.mktemp("planted")
    shutil.copytree(PAIR, place / "design")
    (place / "out").mkdir()
    ran_here("run", NAME, "-o", "r.h5", cwd=place / "design")
    return place


OUTPUTS = {
    "run": ("run", NAME, "-o", "{}x.h5"),
    "import": ("import", NAME, "-o", "{}x.h5"),
    "joints": ("joints", "r.h5", "-o", "{}x.h5"),
    "check": ("check", "r.h5", "-o", "{}x.h5"),
    "findings": ("check", "r.h5", "-f", "json={}x.json"),
    "baseline": ("check", "r.h5", "--write-baseline", "{}x.json"),
    "depfile": ("run", NAME, "-o", "y.h5", "--depfile", "{}x.d"),
    "page": ("report", "r.h5", "-o", "{}x.html"),
    "lock": ("lock", "r.h5", "-o", "{}x.json"),
    "graph": ("show", "r.h5", "--graph", "{}x.svg"),
    "manifest": ("init", "shaft.stl", "--units", "mm", "-o", "{}x.toml"),
    "catalog": ("catalog", "add", "r.h5", "-c", "{}x.sqlite"),
}
"""Commands, with the file that each writes."""


@pytest.mark.parametrize("folder", [False, True], ids=["a file", "a folder"])
@pytest.mark.parametrize("case", OUTPUTS)
def test_a_command_writes_through_no_link(done: Path, command, case: str, folder: bool):
    design, out = done / "design", done / "out"
    words = [word.format("link/" if folder else "") for word in OUTPUTS[case]]
    name = next(word for word in OUTPUTS[case] if "{}" in word).format("").rpartition("=")[2]
    link = design / ("link" if folder else name)
    link.symlink_to(out if folder else out / "precious")
    (out / "precious").write_text("precious")
    try:
        ran = command(*words, cwd=design)
    finally:
        link.unlink()
    assert ran.returncode == 2 and "remedy:" in ran.stderr
    assert [path.name for path in out.iterdir()] == ["precious"] and (out / "precious").read_text() == "precious"


@pytest.mark.parametrize(
    "words", [("export", "r.h5", "--to", "glb", "-o", "made"), ("report", "r.h5", "--png", "made")]
)
def test_a_folder_of_outputs_is_no_link_out_and_has_none(done: Path, command, words: tuple[str, ...]):
    design, out = done / "design", done / "out"
    names = {path.name for path in out.iterdir()}
    (design / "made").symlink_to(out)
    assert command(*words, cwd=design).returncode == 2
    (design / "made").unlink()
    assert {path.name for path in out.iterdir()} == names


def test_a_page_that_is_named_by_nobody_is_not_read_through_a_link(done: Path, command):
    design = done / "design"
    (design / "r.html").symlink_to("../out/nothing")
    gone = command("report", "r.h5", cwd=design)
    (design / "r.html").unlink()
    assert gone.returncode == 2 and not (done / "out" / "nothing").exists()
