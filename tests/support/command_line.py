"""The command as a user runs it, in a folder of its own: its environment, and a run without a process of its own."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from unittest import mock

import pytest

from kinform_cli.main import main

Ran = subprocess.CompletedProcess[str]


def ran_here(*arguments: object, cwd: Path, **extra: str) -> Ran:
    """What `kinform ARGUMENTS` ends with and prints, in this process: a new one takes longer than most commands."""
    words, out, errors = [str(argument) for argument in arguments], io.StringIO(), io.StringIO()
    surroundings = mock.patch.dict(os.environ, environment(**extra), clear=True)
    with surroundings, contextlib.chdir(cwd), contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = main(words)
    return subprocess.CompletedProcess(["kinform", *words], code, out.getvalue(), errors.getvalue())


def listening() -> None:
    """For `preexec_fn`: hear Ctrl-C, also where the tests run in the background of a shell, which ignores it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def environment(**extra: str) -> dict[str, str]:
    """The environment without what makes terminals of pipes."""
    dropped = ("FORCE_COLOR", "PY_COLORS", "GITHUB_ACTIONS", "NO_COLOR", "COLUMNS", "KINFORM_DEBUG")
    kept = {name: value for name, value in os.environ.items() if name not in dropped}
    return {**kept, "TERM": "xterm-256color", **extra}


def at_work(command: Sequence[str], folder: Path, begun: Callable[[], object], **options: Any) -> subprocess.Popen[str]:
    """The command in a folder, which hears Ctrl-C, once it has `begun`."""
    running = subprocess.Popen(
        command, cwd=folder, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=listening, **options,
    )  # fmt: skip
    while not begun():
        if running.poll() is not None:
            pytest.fail(str(running.communicate()))
        time.sleep(0.01)
    return running


KINFORM = Path(sys.executable).with_name("kinform")


def modules_after(arguments: list[str], returncode: int = 0) -> list[str]:
    """What is imported, sorted, once a command has ended in a process of its own, as it should."""
    code = (
        "import sys\n"
        "from kinform_cli.main import main\n"
        f"assert main({arguments!r}) == {returncode}\n"
        "print(*sorted(sys.modules), file=sys.stderr)\n"
    )
    ran = subprocess.run([sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True)
    return ran.stderr.splitlines()[-1].split()
