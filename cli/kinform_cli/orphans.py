"""Processes that a command started, in any depth: who adopts them, and how they are ended. On Linux only.

Imports little: the process that watches uses it.
"""

from __future__ import annotations

import ctypes
import os
import signal
import time

PATIENCE = 2.0
"""s after which processes that were killed and do not end, as in a system call that hangs, are left. A choice."""


def adopt() -> None:
    """Processes in any depth below this one become its children when their own parent ends."""
    set_child_subreaper = 36  # PR_SET_CHILD_SUBREAPER
    ctypes.CDLL(None).prctl(set_child_subreaper, 1, 0, 0, 0)


def end_all() -> None:
    """Kill all children of this process, and those that it adopts while they end, until there are none."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end and (children := _children()):
        for child in children:
            try:
                os.kill(child, signal.SIGKILL)
            except ProcessLookupError:
                continue
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            return
        time.sleep(0.001)


def _children() -> list[int]:
    """Numbers of the processes whose parent is this one."""
    own, out = os.getpid(), []
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat", "rb") as stream:
                facts = stream.read().rpartition(b")")[2].split()
        except OSError:
            continue
        if int(facts[1]) == own:
            out.append(int(name))
    return out
