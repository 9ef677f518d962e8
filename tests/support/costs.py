"""What a command costs: processor time and memory of a process and of all that it starts."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

_STARTER = """
import json, os, subprocess, sys
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(json.dumps([os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss]))
"""
"""A small process that starts the command: what a process had before it became another counts as its memory."""


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
        command = [sys.executable, "-c", _STARTER, sys.executable, "-m", "kinform_cli", *arguments]
        done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=said, check=True)
        said.seek(0)
        code, seconds, most = json.loads(done.stdout)
        return Cost(code, seconds, most / (1024.0 if sys.platform != "darwin" else 1024.0**2), said.read().decode())
