"""The command as a user runs it, in a folder of its own."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.command_line import Ran, environment, ran_here


@pytest.fixture
def kinform(tmp_path: Path) -> Callable[..., Ran]:
    """Run `kinform ARGUMENTS` in tmp_path, in a process of its own; stdout and stderr are pipes."""

    def run(*arguments: object, cwd: Path = tmp_path, **extra: str) -> Ran:
        return subprocess.run(
            [sys.executable, "-m", "kinform_cli", *map(str, arguments)],
            cwd=cwd,
            env=environment(**extra),
            capture_output=True,
            text=True,
            timeout=120,
        )

    return run


@pytest.fixture
def command(tmp_path: Path) -> Callable[..., Ran]:
    """Run `kinform ARGUMENTS` in tmp_path, in this process: where nothing is asked of the process itself."""

    def run(*arguments: object, cwd: Path = tmp_path, **extra: str) -> Ran:
        return ran_here(*arguments, cwd=cwd, **extra)

    return run
