"""The command as a user runs it: a process of its own, in a folder of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Ran = subprocess.CompletedProcess[str]


def environment(**extra: str) -> dict[str, str]:
    """The environment without what makes terminals of pipes."""
    dropped = ("FORCE_COLOR", "PY_COLORS", "GITHUB_ACTIONS", "NO_COLOR", "COLUMNS", "KINFORM_DEBUG")
    kept = {name: value for name, value in os.environ.items() if name not in dropped}
    return {**kept, "TERM": "xterm-256color", **extra}


@pytest.fixture
def kinform(tmp_path: Path) -> Callable[..., Ran]:
    """Run `kinform ARGUMENTS` in tmp_path; stdout and stderr are pipes."""

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
