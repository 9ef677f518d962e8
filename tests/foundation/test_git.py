"""git is asked in a repository whose own configuration names programs; none of them runs."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from kinform.foundation import git

pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


def run(folder: Path, *words: str) -> None:
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    named = ["-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", *named, *words], cwd=folder, check=True, capture_output=True, env=environment)


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with one commit, in whose working tree a file has changed."""
    folder = tmp_path / "repository"
    folder.mkdir()
    run(folder, "init", "-q")
    (folder / "file.txt").write_text("first\n")
    (folder / ".gitattributes").write_text("*.txt filter=a=b.c diff=d\n")
    run(folder, "add", ".")
    run(folder, "commit", "-q", "-m", "first")
    (folder / "file.txt").write_text("other\n")
    return folder


def poisoned(config: Path, marker: Path) -> None:
    """Write keys that have git run programs, for any question, to a configuration file."""
    deed = f"touch {marker}; cat"
    hooks = config.parent / "planted"
    hooks.mkdir()
    for name in ("fsmonitor-watchman", "post-index-change", "reference-transaction"):
        (hooks / name).write_text(f"#!/bin/sh\ntouch {marker}\n")
        (hooks / name).chmod(0o755)
    with config.open("a") as stream:
        stream.write(
            f'[core]\nfsmonitor = "{deed}"\nhooksPath = {hooks}\nsshCommand = "{deed}"\npager = "{deed}"\n'
            f'[diff]\nexternal = "{deed}"\n[diff "d"]\ntextconv = "{deed}"\ncommand = "{deed}"\n'
            f'[filter "a=b.c"]\nclean = "{deed}"\nsmudge = "{deed}"\nrequired = true\n'
        )


QUESTIONS = (
    ("status", "--porcelain"),
    ("diff", "--name-only", "HEAD", "--"),
    ("ls-files", "--others"),
    ("diff", "HEAD"),
)


def test_programs_that_the_repository_names_do_not_run(repository: Path, tmp_path: Path):
    marker = tmp_path / "MARKER"
    poisoned(repository / ".git" / "config", marker)
    run(repository, "diff", "--name-only")
    assert marker.exists(), "git runs none of them by itself: the test shows nothing"
    marker.unlink()
    os.utime(repository / ".gitattributes")
    for question in QUESTIONS:
        assert git.ask(repository, *question) is not None
    assert not marker.exists()
    assert git.ask(repository, "diff", "--name-only", "HEAD", "--") == b"file.txt\n"


def test_a_configuration_that_is_included_counts_as_the_repositorys(repository: Path, tmp_path: Path):
    marker = tmp_path / "MARKER"
    poisoned(repository / "included", marker)
    run(repository, "config", "include.path", "../included")
    for question in QUESTIONS:
        assert git.ask(repository, *question) is not None
    assert not marker.exists()


def test_a_bare_repository_in_a_folder_is_not_entered(repository: Path, tmp_path: Path):
    marker, bare = tmp_path / "MARKER", repository / "meshes"
    run(repository, "init", "-q", "--bare", str(bare))
    poisoned(bare / "config", marker)
    run(bare, "config", "core.bare", "false")
    run(bare, "config", "core.worktree", str(repository))
    for question in QUESTIONS:
        git.ask(bare, *question)
    assert not marker.exists()


def test_filters_of_the_user_run(repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    marker = tmp_path / "MARKER"
    own = tmp_path / "gitconfig"
    own.write_text(f'[filter "a=b.c"]\nclean = "touch {marker}; cat"\n')
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", str(own))
    assert git.ask(repository, "diff", "--name-only", "HEAD", "--") == b"file.txt\n"
    assert marker.exists()


def test_what_git_refuses_is_none_and_its_lack_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    (tmp_path / "plain").mkdir()
    assert git.ask(tmp_path / "plain", "rev-parse", "--show-toplevel") is None
    monkeypatch.setenv("PATH", ".")
    with pytest.raises(git.NoGit):
        git.ask(tmp_path, "status")


def test_filters_of_a_home_in_the_repository_do_not_run(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (repository / ".gitconfig").write_text(f'[filter "a=b.c"]\nclean = "touch {tmp_path / "MARKER"}; cat"\n')
    monkeypatch.setenv("HOME", str(repository))
    monkeypatch.delenv("GIT_CONFIG_GLOBAL", raising=False)
    assert git.ask(repository, "diff", "--name-only", "HEAD", "--") == b"file.txt\n"
    assert not (tmp_path / "MARKER").exists()
