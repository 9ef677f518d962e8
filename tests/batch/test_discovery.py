"""Which files are designs, with git itself as the judge of what it ignores."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from kinform.batch.discovery import discover
from kinform.errors import InputError

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


def test_of_two_designs_with_one_place_of_results_one_has_a_fault(tmp_path):
    (tmp_path / "r.urdf").write_text('<robot name="r"/>')
    (tmp_path / "r.urdf.toml").write_text(MANIFEST)
    (tmp_path / "batch.json").mkdir()
    (tmp_path / "batch.json" / "a.toml").write_text(MANIFEST)
    faulty = {one.name: one.fault is not None for one in discover([tmp_path])}
    assert faulty == {"batch.json/a.toml": True, "r.urdf": False, "r.urdf.toml": True}


def test_nothing_found_is_an_error(tmp_path):
    with pytest.raises(InputError):
        discover([tmp_path])
    with pytest.raises(InputError):
        discover([tmp_path / "absent"])


def test_pipes_are_no_designs_nobody_waits_for_them_and_they_are_reported(repository):
    for name in ("pipe.toml", "pipe.urdf"):
        os.mkfifo(repository / name)
    told: list[str] = []
    assert not [name for name in names(repository, say=told.append) if "pipe" in name]
    assert len(told) == 2 and all("pipe." in line for line in told)


HIDDEN = ("designs/broken/b.toml", ".dot/d.toml", "designs/.dot/e.urdf")


def test_what_git_tracks_counts_whatever_gitignore_says(tmp_path):
    for name in HIDDEN:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(MANIFEST if name.endswith("toml") else '<robot name="r"/>')
        (tmp_path / name).with_name(".gitignore").write_text("*\n")
    (tmp_path / ".gitignore").write_text("*\n!.gitignore\n")
    (tmp_path / "a.toml").write_text(MANIFEST)
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    subprocess.run(["git", "-C", str(tmp_path), "add", "-f", *HIDDEN], check=True)
    assert names(tmp_path) == sorted(HIDDEN)
    assert names(tmp_path / "designs") == [".dot/e.urdf", "broken/b.toml"]
    assert names(tmp_path, ignored=True) == sorted([*HIDDEN, "a.toml"])


def test_outside_of_a_repository_and_without_git_nothing_is_hidden_and_that_is_said(repository, tmp_path, monkeypatch):
    alone = tmp_path / "alone" / "build"
    alone.mkdir(parents=True)
    (alone / "a.toml").write_text(MANIFEST)
    (alone / ".gitignore").write_text("*\n")
    told: list[str] = []
    with monkeypatch.context() as patch:
        patch.setattr("kinform.batch.discovery.root_of", lambda folder: None)
        assert names(alone, say=told.append) == ["a.toml"]
    assert len(told) == 1
    monkeypatch.setenv("PATH", ".")
    assert "build/b.toml" in names(repository, say=told.append)
    assert len(told) == 2


def test_names_of_any_bytes_and_links_in_circles_end_nothing(repository):
    for folder in (b"\xff\xfe", b"new\nline", b"100%s", b"x" * 255):
        os.mkdir(os.fsencode(repository) + b"/" + folder)
        with open(os.fsencode(repository) + b"/" + folder + b"/a.toml", "w") as file:
            file.write(MANIFEST)
    (repository / "circle").symlink_to(".")
    (repository / "itself.toml").symlink_to("itself.toml")
    found = {name for name in names(repository) if name.endswith("/a.toml")}
    assert found == {"\udcff\udcfe/a.toml", "new\nline/a.toml", "100%s/a.toml", "x" * 255 + "/a.toml"}
    assert "itself.toml" in names(repository)


def test_what_leads_out_is_not_looked_into(repository, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "a.toml").write_text(MANIFEST)
    (repository / "out.toml").symlink_to(outside / "a.toml")
    (repository / "out.urdf").symlink_to(outside / "a.toml")
    (repository / "out").symlink_to(outside)
    told: list[str] = []
    found = names(repository, say=told.append)
    assert "out.urdf" in found and "out.toml" not in found and "out/a.toml" not in found
    assert len(told) == 2


def test_tracked_designs_in_the_folder_of_results_are_reported(repository):
    subprocess.run(["git", "-C", str(repository), "add", "results/r.toml"], check=True)
    told: list[str] = []
    assert "results/r.toml" not in names(repository, results=repository / "results", say=told.append)
    assert len(told) == 1 and "r.toml" in told[0]


def test_a_submodule_in_an_ignored_folder_counts(repository, tmp_path_factory):
    inner = tmp_path_factory.mktemp("inner")
    (inner / "s.toml").write_text(MANIFEST)
    for words in (["init", "-q"], ["add", "."], ["-c", "user.name=t", "-c", "user.email=t@t", "commit", "-qm", "one"]):
        subprocess.run(["git", "-C", str(inner), *words], check=True)
    add = ["-c", "protocol.file.allow=always", "submodule", "--quiet", "add", "-f", str(inner), "build/inner"]
    subprocess.run(["git", "-C", str(repository), *add], check=True)
    assert "build/inner/s.toml" in names(repository) and "build/b.toml" not in names(repository)


def test_a_submodule_in_a_folder_with_a_dot_counts(repository, tmp_path_factory):
    inner = tmp_path_factory.mktemp("inner")
    (inner / "s.toml").write_text(MANIFEST)
    for words in (["init", "-q"], ["add", "."], ["-c", "user.name=t", "-c", "user.email=t@t", "commit", "-qm", "one"]):
        subprocess.run(["git", "-C", str(inner), *words], check=True)
    add = ["-c", "protocol.file.allow=always", "submodule", "--quiet", "add", "-f", str(inner), ".parts/inner"]
    subprocess.run(["git", "-C", str(repository), *add], check=True)
    assert ".parts/inner/s.toml" in names(repository)
