"""The commands of docs/batch.md, as they stand there."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.places import FIXTURES, ROOT

pytest.importorskip("distributed")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="commands of a POSIX shell"),
]


def blocks(name: str) -> list[list[str]]:
    """Lines of the tested blocks of this name."""
    text = (ROOT / "docs" / "batch.md").read_text(encoding="utf-8")
    return [part.splitlines() for part in re.findall(rf"<!-- tested: {name} -->\n```\n(.*?)```", text, re.DOTALL)]


@pytest.fixture
def place(tmp_path) -> tuple[Path, dict[str, str]]:
    """A folder beside a checkout, and an environment with the commands `kinform` and `dask`."""
    (tmp_path / "kinform" / "fixtures").mkdir(parents=True)
    shutil.copytree(FIXTURES / "pairs", tmp_path / "kinform" / "fixtures" / "pairs")
    (tmp_path / "bin").mkdir()
    for name, module in (("kinform", "kinform_cli"), ("dask", "dask")):
        (tmp_path / "bin" / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" -m {module} "$@"\n')
        (tmp_path / "bin" / name).chmod(0o755)
    author = {f"GIT_{who}_{what}": "t@example.org" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    paths = os.pathsep.join([str(ROOT / "pipeline"), str(ROOT / "cli")])
    environment = {"PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": paths}
    return tmp_path, os.environ | author | environment


def ran(line: str, place: tuple[Path, dict[str, str]]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(line, shell=True, cwd=place[0], env=place[1], capture_output=True, text=True, timeout=600)


def counts(text: str) -> list[list[int]]:
    """The whole numbers of each line."""
    return [[int(number) for number in re.findall(r"\b\d+\b", line)] for line in text.splitlines()]


def test_the_tutorial_of_ci(place):
    first, second = blocks("ci")
    *before, whole, again = first
    for line in before:
        assert ran(line, place).returncode == 0, line
    done = ran(whole, place)
    assert done.returncode == 1 and [21, 20, 0, 1] in [found[:4] for found in counts(done.stderr)], done.stderr
    assert {path.name for path in (place[0] / "reports").iterdir()} == {"summary.md", "findings.sarif", "findings.xml"}
    assert any(21 in line for line in counts(ran(again, place).stderr))
    assert ran(second[0], place).returncode == 0
    done = ran(second[1], place)
    assert done.returncode == 0 and [1, 21] in counts(done.stderr), done.stderr


def test_the_commands_of_a_cluster(place):
    started, (sent,) = blocks("cluster")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    *daemons, shared = [line.replace("8786", port) for line in started]
    ran(
        "mkdir designs; cp -r kinform/fixtures/pairs/planar_block kinform/fixtures/pairs/prismatic_drawer designs",
        place,
    )
    processes = [
        subprocess.Popen(line, shell=True, cwd=place[0], env=place[1], start_new_session=True,
                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for line in daemons
    ]  # fmt: skip
    try:
        assert len(daemons) == 3
        time.sleep(5.0)
        done = ran(shared, place)
        assert done.returncode == 0, done.stderr
        kept = {path.name: path.read_bytes() for path in (place[0] / "results").rglob("*.h5")}
        ran("rm -r results", place)
        assert ran(sent.replace("8786", port), place).returncode == 0
        assert {path.name: path.read_bytes() for path in (place[0] / "results").rglob("*.h5")} == kept
        assert len(kept) == 2
    finally:
        for process in reversed(processes):
            os.killpg(process.pid, signal.SIGTERM)
        for process in processes:
            process.wait(timeout=60)
