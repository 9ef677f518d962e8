"""Output that does not all reach its reader is never a pass: full disks, readers that leave, with and without
buffers."""

from __future__ import annotations

import errno
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment, ran_here
from support.places import FIXTURES

from kinform import results

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"
PRINTING = (
    (("check", "r.h5", "-f", "sarif"), True),
    (("--version",), False),
)
"""What is printed by the command's own means and by typer; and whether without a buffer."""
NIGHTLY = (
    *((words, not unbuffered) for words, unbuffered in PRINTING),
    (("show", "r.h5"), False),
    (("show", "r.h5"), True),
    (("check", "r.h5"), False),
    (("show", "r.h5", "joints", "--format", "json"), False),
    (("diff", "r.h5", "r.h5"), False),
    (("explain", "KF203"), False),
    (("check", "--help"), True),
    (("--help",), False),
)
CASES = (*PRINTING, *(pytest.param(*case, marks=pytest.mark.sweep) for case in NIGHTLY))


@pytest.fixture(scope="module")
def folder(tmp_path_factory, derive_design) -> Path:
    """A hinge that is as its function says, and its results; and one that is not."""
    folder = tmp_path_factory.mktemp("cut")
    shutil.copytree(PAIR, folder, dirs_exist_ok=True)
    results.write(derive_design(folder / NAME), folder / "r.h5")
    text = (folder / NAME).read_text()
    assert 'type = "revolute"' in text
    (folder / "wrong.toml").write_text(text.replace('type = "revolute"', 'type = "prismatic"', 1))
    results.write(derive_design(folder / "wrong.toml"), folder / "wrong.h5")
    return folder


def printing(folder: Path, *words: str, out, unbuffered: bool, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-B", "-m", "kinform_cli", *words],
        cwd=folder, env=environment(**({"PYTHONUNBUFFERED": "1"} if unbuffered else {})),
        stdout=out, stderr=subprocess.PIPE, text=True, timeout=60, **more,
    )  # fmt: skip


@pytest.mark.parametrize(("words", "unbuffered"), CASES)
def test_a_full_disk_is_said_and_never_a_pass(words, unbuffered, folder: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("needs /dev/full")
    with open("/dev/full", "w") as full:
        ran = printing(folder, *words, out=full, unbuffered=unbuffered)
    assert ran.returncode == 2
    assert os.strerror(errno.ENOSPC) in ran.stderr
    assert "Traceback" not in ran.stderr


@pytest.mark.parametrize("unbuffered", [False, pytest.param(True, marks=pytest.mark.sweep)])
def test_a_disk_that_takes_only_the_first_half_is_said_and_never_a_pass(unbuffered, folder: Path, tmp_path) -> None:
    whole = ran_here("check", "r.h5", "-f", "sarif", cwd=folder)
    assert whole.returncode == 0
    half = len(whole.stdout.encode()) // 2
    with (tmp_path / "half").open("w") as out:
        ran = printing(
            folder, "check", "r.h5", "-f", "sarif", out=out, unbuffered=unbuffered,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (half, half)),
        )  # fmt: skip
    assert (tmp_path / "half").stat().st_size == half
    assert ran.returncode == 2
    assert ran.stderr


@pytest.mark.parametrize(("words", "unbuffered"), CASES)
def test_a_reader_that_left_is_told_nothing_and_is_no_pass(words, unbuffered, folder: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ran = printing(folder, *words, out=writing, unbuffered=unbuffered)
    os.close(writing)
    assert (ran.returncode, ran.stderr) == (2, "")


@pytest.mark.parametrize("format", ["json", pytest.param("full", marks=pytest.mark.sweep)])
def test_findings_are_findings_also_where_not_all_were_read(format, folder: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ran = printing(folder, "check", "wrong.h5", "-f", format, out=writing, unbuffered=False)
    os.close(writing)
    assert (ran.returncode, ran.stderr) == (1, "")


def test_watching_ends_when_nobody_reads(folder: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ran = printing(folder, "watch", "wrong.toml", "-o", "w.h5", "-q", out=writing, unbuffered=False)
    os.close(writing)
    assert (ran.returncode, ran.stderr) == (1, "")
