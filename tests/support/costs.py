"""What a command costs: processor time and memory of a process and of all that it starts."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Cost:
    """Of a command that has ended."""

    code: int
    seconds: float
    """Of processor time, user and system."""
    megabytes: float
    """Of the largest of its processes."""
    said: str
    """What it wrote to stderr."""


def cost_of(folder: Path, *arguments: str) -> Cost:
    """Run the command in a folder and measure it, as `getrusage` counts."""
    with open(folder / "said.txt", "w+b") as said:
        command = [sys.executable, "-m", "kinform_cli", *arguments]
        with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=said) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        return Cost(
            process.returncode,
            usage.ru_utime + usage.ru_stime,
            usage.ru_maxrss / (1024.0 if sys.platform != "darwin" else 1024.0**2),
            said.read().decode(),
        )
