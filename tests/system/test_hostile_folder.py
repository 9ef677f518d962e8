"""Every command in a folder that a stranger filled with code: none of it is executed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment
from support.places import FIXTURES
from support.planted import planted

PAIR = "revolute_collars"
STUDY = f"""schema = 1
[study]
design = "{PAIR}.toml"
method = "grid"
[[vary]]
name = "k"
values = [1, 2]
value = "part.shaft.density"
[[measure]]
name = "mobility"
value = "mobility.effective"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A repository with a design, its results, and what was planted."""
    shutil.copytree(FIXTURES / "pairs" / PAIR, tmp_path, dirs_exist_ok=True)
    (tmp_path / "s.toml").write_text(STUDY)
    return tmp_path


def run(folder: Path, *words: str, **extra: str) -> subprocess.CompletedProcess[str]:
    """The command, with an environment that looks for as much as possible in the working folder."""
    path = os.pathsep.join([os.environ.get("PYTHONPATH", ""), ""])
    given = environment(PYTHONPATH=path, XDG_CACHE_HOME="cache", DASK_CONFIG="dask", NUMBA_CACHE_DIR="cache", **extra)
    return subprocess.run(
        [sys.executable, "-m", "kinform_cli", *words], cwd=folder, env=given, capture_output=True, text=True
    )


def test_a_run_executes_nothing_of_the_working_folder(folder: Path):
    marker = planted(folder, at_start=False)
    ran = run(folder, "run", f"{PAIR}.toml", "-o", "r.h5", "--jobs", "2")
    assert (ran.returncode, marker.exists()) == (0, False), ran.stderr


COMMANDS = (
    "run {0}.toml -o r.h5 --jobs 2", "run . -o q.h5", "batch . -o {1}/b --jobs 2", "study s.toml -o s.h5 --jobs 2",
    "import {0}.toml -o i.h5", "contacts i.h5 -o i.h5", "joints i.h5 -o i.h5", "mass i.h5 -o i.h5",
    "simulate i.h5 -o i.h5", "check i.h5 -o i.h5", "show r.h5", "show r.h5 joints --format json", "query r.h5 --help",
    "report r.h5 -o r.html", "export r.h5 --to glb -o r.glb", "export r.h5 --to dot -o r.dot", "catalog --help",
    "diff r.h5 i.h5", "lock --help", "watch --help", "init block.stl shaft.stl --units mm -o n.toml", "explain KF201",
    "schema --help",
)  # fmt: skip


@pytest.mark.slow
def test_no_command_executes_anything_of_the_working_folder(folder: Path, tmp_path_factory: pytest.TempPathFactory):
    marker, elsewhere = planted(folder, at_start=False), tmp_path_factory.mktemp("results")
    for line in COMMANDS:
        ran = run(folder, *line.format(PAIR, elsewhere).split())
        assert not marker.exists(), line
        assert ran.returncode in (0, 1), (line, ran.stderr)


@pytest.mark.slow
def test_the_compiled_kernel_executes_nothing_of_the_working_folder(folder: Path):
    marker = planted(folder)
    code = "from kinform.simulation.kernel.calls import engine; engine(compiled=True)"
    for cache in (str(folder / "cache"), "cache"):
        given = environment(XDG_CACHE_HOME=cache, NUMBA_CACHE_DIR="cache")
        subprocess.run([sys.executable, "-P", "-c", code], cwd=folder, env=given, check=True)
        assert not marker.exists()


def test_git_in_a_hostile_repository_runs_nothing(folder: Path):
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    marker = folder.parent / f"{folder.name}-marker"
    for words in (["init", "-q"], ["add", "."], ["-c", "user.name=n", "-c", "user.email=e", "commit", "-q", "-m", "m"]):
        subprocess.run(["git", *words], cwd=folder, check=True)
    deed = json.dumps(f"touch {marker}; false")
    (folder / ".git" / "config").open("a").write(f"[core]\nfsmonitor = {deed}\nhooksPath = .\n")
    (folder / "git").write_text(f"#!/bin/sh\ntouch {marker}\n")
    (folder / "git").chmod(0o755)
    given = os.pathsep.join(["", os.environ["PATH"]])
    ran = run(folder, "batch", ".", "--changed-since", "HEAD", "-o", str(folder.parent / "results"), PATH=given)
    assert not marker.exists(), ran.stderr
