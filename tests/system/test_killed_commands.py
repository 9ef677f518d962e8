"""Commands that write beside results, killed at every step of writing, or writing at once, leave whole files."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
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
    "run": ("run", NAME, "-o", "n.h5", "--depfile", "n.d", "--no-ranges"),
}
STEPS = """
import os, signal, sys
from kinform import results
from kinform.results import replacement
from kinform_cli.main import main

def counted(step):
    def taken(*given, **named):
        global left
        left -= 1
        if left < 0:
            {deed}
        return step(*given, **named)
    return taken

os.chdir("../whole")
assert main(sys.argv[1:]) in (0, 1)
os.chdir("../work")
print("ready", flush=True)
for line in sys.stdin:
    left = int(line)
    if not (child := os.fork()):
        os.dup2(os.open("errors.tmp", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.fsync, os.replace = counted(os.fsync), counted(os.replace)
        os.open = counted(os.open)
        code = main(sys.argv[1:])
        sys.stderr.flush()
        os._exit(code)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
"""Runs a command as it is in the folder `whole`, which imports all that it needs; then in a fork for each line of
stdin, which says after how many steps of writing the deed is done."""


def _how_often(name, often, slow):
    return () if name in often else pytest.mark.slow if name in slow else pytest.mark.sweep


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


@contextlib.contextmanager
def stopping(folder: Path, deed: str, words: tuple[str, ...]) -> Iterator[Callable[[int], tuple[int, str]]]:
    """Exit code and errors of the command, stopped after so many steps of writing. A copy of the folder, `whole`, has
    what the command does that nothing stops."""
    shutil.copytree(folder, folder.parent / "whole")
    command = [sys.executable, "-c", STEPS.format(deed=deed), *words, "-q"]
    with subprocess.Popen(
        command, cwd=folder, env=environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as runner:

        def stopped(step: int) -> tuple[int, str]:
            print(step, file=runner.stdin, flush=True)
            code = int(runner.stdout.readline())
            errors = folder / "errors.tmp"
            text = errors.read_text()
            errors.unlink()
            return code, text

        assert "ready\n" in iter(runner.stdout.readline, "")
        yield stopped
        runner.stdin.close()


def step_by_step(folder: Path, deed: str, words: tuple[str, ...]) -> list[tuple[int, str]]:
    """The command stopped at its first step of writing, at its second, and so on, until it ends; whatever is there
    after each is what it would have written, and a last run writes the rest and leaves nothing behind."""
    runs = []
    with stopping(folder, deed, words) as stopped:
        expected = contents(folder.parent / "whole")
        for step in range(100):
            code, errors = stopped(step)
            there = contents(folder)
            assert all(expected[name] == data for name, data in there.items()), step
            if code == 0:
                break
            runs.append((code, errors))
    assert contents(folder) == expected
    assert not list(folder.rglob("*.tmp"))
    return runs


@pytest.mark.parametrize(
    "what", [pytest.param(name, marks=_how_often(name, often=("lock",), slow=("run",))) for name in COMMANDS]
)
def test_a_command_that_is_killed_at_any_step_leaves_whole_files_and_the_next_one_the_rest(what, folder) -> None:
    runs = step_by_step(folder, KILL, COMMANDS[what])
    assert len(runs) >= 3
    assert {code for code, _ in runs} == {-signal.SIGKILL}


@pytest.mark.parametrize(
    "what", [pytest.param(name, marks=_how_often(name, often=("baseline",), slow=("catalog",))) for name in COMMANDS]
)
def test_a_disk_that_is_full_at_any_step_is_told_and_nothing_half_written_stays(what, folder) -> None:
    runs = step_by_step(folder, FULL, COMMANDS[what])
    for code, errors in runs:
        assert code == 2
        assert os.strerror(errno.ENOSPC) in errors
        assert "Traceback" not in errors


@pytest.mark.parametrize(
    "what", [pytest.param(name, marks=_how_often(name, often=(), slow=("catalog", "run"))) for name in COMMANDS]
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
    for words in (COMMANDS["lock"], COMMANDS["baseline"]):
        assert ran_here(*words, "-q", cwd=folder).returncode == 0
    before = contents(folder)
    text = (folder / NAME).read_text()
    (folder / NAME).write_text(text.replace('"steel"', '"brass"'))
    with stopping(folder, KILL, ("run", NAME, "-o", "r.h5", "--no-ranges")) as stopped:
        assert stopped(2)[0] == -signal.SIGKILL
    (folder / NAME).write_text(text)
    assert contents(folder) == before
    assert os.listdir(folder)
