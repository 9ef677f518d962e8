"""Which files are designs, with git itself as the judge of what it ignores."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from kinform.batch.discovery import discover
from kinform.errors import InputError

pytest.importorskip("pathspec")

MANIFEST = 'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n'
FILES = {
    "a.toml": MANIFEST, "pyproject.toml": "[project]\nname = 'x'\n", "faulty.toml": MANIFEST + "[[part\n",
    "robots/r.urdf": '<?xml version="1.0"?>\n<robot name="r"/>', "robots/macro.xacro": "<robot xmlns:xacro='x'/>",
    "robots/r.urdf.xacro": '<robot xmlns:xacro="x" name="r"/>', "robots/m.xml": "<mujoco/>",
    "robots/package.xml": "<package/>",
    "robots/inc.xml": "<mujocoinclude/>", "robots/hidden.xml": "<!-- <mujoco/> --><other/>", "robots/w.sdf": "<sdf/>",
    "build/b.toml": MANIFEST, "keep/build/b.toml": MANIFEST, "keep/c.toml": MANIFEST, "keep/d.tmp.toml": MANIFEST,
    "keep/e.tmp.toml": MANIFEST, ".hidden/h.toml": MANIFEST, "cad/x.step": "ISO-10303-21;", "results/r.toml": MANIFEST,
}  # fmt: skip
IGNORED = {".gitignore": "/build/\n*.tmp.toml\n", "keep/.gitignore": "!e.tmp.toml\nc.toml\n"}


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with designs, and other files."""
    for name, text in (FILES | IGNORED).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    return tmp_path


def names(*paths: Path, **settings) -> list[str]:
    return [one.name for one in discover(paths, **settings)]


def test_designs_are_those_files_that_git_sees(repository):
    asked = ["git", "-C", str(repository), "ls-files", "--others", "--exclude-standard", "--", "*.toml"]
    seen = set(subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split())
    expected = seen - {"pyproject.toml", ".hidden/h.toml", "results/r.toml"}
    found = names(repository, results=repository / "results")
    assert {name for name in found if name.endswith(".toml")} == expected
    assert "keep/e.tmp.toml" in found and "keep/c.toml" not in found
    assert set(found) - expected == {"robots/r.urdf", "robots/r.urdf.xacro", "robots/m.xml", "robots/w.sdf"}


def test_what_git_ignores_is_found_when_asked_for(repository):
    assert {"build/b.toml", "keep/build/b.toml", "keep/d.tmp.toml"} <= set(names(repository, ignored=True))


def test_below_a_folder_the_rules_of_those_above_hold(repository):
    assert names(repository / "keep") == ["build/b.toml", "e.tmp.toml"]


def test_patterns_choose(repository):
    assert names(repository, include=["*.step"]) == ["cad/x.step"]
    assert names(repository, include=["robots/*"], exclude=["*.xml", "*macro*"]) == [
        "robots/r.urdf", "robots/r.urdf.xacro", "robots/w.sdf",
    ]  # fmt: skip


def test_a_file_that_is_named_is_taken_as_it_is(repository):
    assert names(repository / "robots" / "package.xml") == ["package.xml"]


def test_results_lie_as_designs_do(repository):
    found = discover([repository / "robots", repository / "keep"])
    assert [one.results for one in found] == [
        "keep/build/b.h5", "keep/e.tmp.h5", "robots/m.xml.h5", "robots/r.urdf.h5", "robots/r.urdf.xacro.h5",
        "robots/w.sdf.h5",
    ]  # fmt: skip


def test_two_designs_with_one_place_of_results_are_refused(tmp_path):
    (tmp_path / "r.urdf").write_text('<robot name="r"/>')
    (tmp_path / "r.urdf.toml").write_text(MANIFEST)
    with pytest.raises(InputError):
        discover([tmp_path])


def test_nothing_found_is_an_error(tmp_path):
    with pytest.raises(InputError):
        discover([tmp_path])
    with pytest.raises(InputError):
        discover([tmp_path / "absent"])


def test_pipes_are_no_designs_and_nobody_waits_for_them(repository):
    for name in ("pipe.toml", "pipe.urdf"):
        os.mkfifo(repository / name)
    assert not [name for name in names(repository) if "pipe" in name]
