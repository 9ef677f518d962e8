"""Commands that write beside results, killed at every step of writing, or writing at once, leave whole files."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import environment, ran_here
from support.places import FIXTURES

from kinform import results

PAIR = FIXTURES / "pairs" / "revolute_collars"
NAME = "revolute_collars.toml"
COMMANDS = {
    "catalog": ("catalog", "add", "r.h5", "-c", "c.sqlite"),
    "report": ("report", "r.h5", "-o", "r.html", "--png", "pictures"),
    "export": ("export", "r.h5", "--to", "urdf", "-o", "urdf"),
    "lock": ("lock", "r.h5", "-o", "r.lock"),
    "baseline": ("check", "r.h5", "--write-baseline", "b.json"),
    "run": ("run", NAME, "-o", "n.h5", "--depfile", "n.d"),
}
STEPS = """
import os, signal, sys
from kinform.results import replacement
from kinform_cli.main import main

left = int(sys.argv.pop(1))

def counted(step):
    def taken(*given, **named):
        global left
        left -= 1
        if left < 0:
            {deed}
        return step(*given, **named)
    return taken

os.fsync, os.replace = counted(os.fsync), counted(os.replace)
os.open = counted(os.open)
sys.exit(main(sys.argv[1:]))
"""
KILL = "os.kill(os.getpid(), signal.SIGKILL)"
FULL = "raise OSError(28, 'No space left on device')"


@pytest.fixture
def folder(tmp_path: Path, derive_design) -> Path:
    """The hinge with its results."""
    folder = tmp_path / "work"
    shutil.copytree(PAIR, folder)
    results.write(derive_design(PAIR / NAME), folder / "r.h5")
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """All files that bear a name of their own."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.suffix != ".tmp"
    }


def stopped(folder: Path, deed: str, step: int, words: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", STEPS.format(deed=deed), str(step), *words, "-q"]
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=120)


def step_by_step(folder: Path, deed: str, words: tuple[str, ...]) -> list[subprocess.CompletedProcess[str]]:
    """The command stopped at its first step of writing, at its second, and so on, until it ends; whatever is there
    after each is what it would have written, and a last run writes the rest and leaves nothing behind."""
    whole = folder.parent / "whole"
    shutil.copytree(folder, whole)
    assert ran_here(*words, "-q", cwd=whole).returncode == 0
    expected = contents(whole)
    runs = []
    for step in range(100):
        ran = stopped(folder, deed, step, words)
        there = contents(folder)
        assert all(expected[name] == data for name, data in there.items()), step
        if ran.returncode == 0:
            break
        runs.append(ran)
    assert contents(folder) == expected
    assert not list(folder.rglob("*.tmp"))
    return runs


@pytest.mark.parametrize(
    "what", ["lock", *(pytest.param(name, marks=pytest.mark.slow) for name in COMMANDS if name != "lock")]
)
def test_a_command_that_is_killed_at_any_step_leaves_whole_files_and_the_next_one_the_rest(what, folder) -> None:
    runs = step_by_step(folder, KILL, COMMANDS[what])
    assert len(runs) >= 3
    assert {ran.returncode for ran in runs} == {-signal.SIGKILL}


@pytest.mark.parametrize(
    "what", ["catalog", *(pytest.param(name, marks=pytest.mark.slow) for name in COMMANDS if name != "catalog")]
)
def test_a_disk_that_is_full_at_any_step_is_told_and_nothing_half_written_stays(what, folder) -> None:
    runs = step_by_step(folder, FULL, COMMANDS[what])
    for ran in runs:
        assert ran.returncode == 2
        assert "No space left on device" in ran.stderr
        assert "Traceback" not in ran.stderr


@pytest.mark.parametrize(
    "what", ["catalog", *(pytest.param(name, marks=pytest.mark.slow) for name in COMMANDS if name != "catalog")]
)
def test_two_that_write_the_same_files_at_once_both_succeed_and_leave_them_whole(what, folder) -> None:
    whole = folder.parent / "whole"
    shutil.copytree(folder, whole)
    words = COMMANDS[what]
    assert ran_here(*words, "-q", cwd=whole).returncode == 0
    code = (
        "import sys\nfrom kinform_cli.main import main\n"
        "print('ready', flush=True)\nsys.stdin.readline()\n"
        "sys.exit(max(main(sys.argv[1:]) for _ in range(3)))"
    )
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", code, *words, "-q"],
            cwd=folder, env=environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]  # fmt: skip
    for writer in writers:
        assert writer.stdout is not None
        assert writer.stdout.readline() == "ready\n"
    ends = []
    for writer in writers:
        assert writer.stdin is not None
        writer.stdin.write("go\n")
        writer.stdin.flush()
    for writer in writers:
        _, errors = writer.communicate(timeout=120)
        ends.append((writer.returncode, errors))
    assert [code for code, _ in ends] == [0, 0], ends
    assert contents(folder) == contents(whole)
    assert not list(folder.rglob("*.tmp"))


def test_a_killed_command_loses_nothing_that_was_there(folder: Path) -> None:
    """Each of them over a file of an earlier design."""
    for words in (COMMANDS["lock"], COMMANDS["catalog"], COMMANDS["baseline"]):
        assert ran_here(*words, "-q", cwd=folder).returncode == 0
    before = contents(folder)
    text = (folder / NAME).read_text()
    (folder / NAME).write_text(text.replace('"steel"', '"brass"'))
    assert stopped(folder, KILL, 2, ("run", NAME, "-o", "r.h5")).returncode == -signal.SIGKILL
    (folder / NAME).write_text(text)
    assert contents(folder) == before
    assert os.listdir(folder)
