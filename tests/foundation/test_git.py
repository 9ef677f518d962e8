"""Git in repositories of strangers: which one is asked, what is started, and what a failure is."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from kinform.foundation import git as module
from kinform.foundation.git import GitError, git, names, root_of


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    subprocess.run(["git", "init", "-q", str(tmp_path / "r")], check=True)
    return tmp_path / "r"


def test_names_are_those_of_the_file_system(repository):
    name = os.fsdecode(b"\xff\n%s")
    (repository / name).write_text("")
    assert names(git(repository, "ls-files", "-z", "--others")) == [name]


def test_a_folder_that_looks_like_a_bare_repository_is_none(repository):
    inner = repository / "bare"
    subprocess.run(["git", "init", "-q", "--bare", str(inner)], check=True)
    assert root_of(inner) == root_of(inner / "objects") == repository
    assert root_of(repository.parent) is None


def test_variables_for_git_do_not_count(repository, monkeypatch):
    for name in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_EXEC_PATH", "GIT_CONFIG_GLOBAL"):
        monkeypatch.setenv(name, "/nowhere")
    assert git(repository, "ls-files") == b""


def test_a_git_of_the_working_folder_is_not_started(repository, tmp_path, monkeypatch):
    fake = tmp_path / "git"
    fake.write_text(f"#!/bin/sh\ntouch {tmp_path}/ran\n")
    fake.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", os.pathsep.join(["", ".", "x/..", os.environ["PATH"]]))
    assert git(repository, "ls-files") == b"" and not (tmp_path / "ran").exists()
    monkeypatch.setenv("PATH", ".")
    with pytest.raises(GitError):
        git(repository, "ls-files")
    assert not (tmp_path / "ran").exists()


def test_what_git_cannot_do_or_does_not_end_is_an_error(repository, monkeypatch):
    with pytest.raises(GitError):
        git(repository, "ls-tree", "no_such")
    monkeypatch.setattr(module, "SECONDS", 0.0)
    with pytest.raises(GitError):
        git(repository, "ls-files")
