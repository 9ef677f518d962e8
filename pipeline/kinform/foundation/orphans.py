"""Processes that end with the one that began them, however that was ended. On Linux; elsewhere they go on."""

from __future__ import annotations

import os
import signal
import sys

_FAILED = 2


def end_with(parent: int) -> None:
    """Have the system kill this process when its parent, the process of that number, is gone."""
    if sys.platform != "linux":
        return
    import ctypes

    set_death_signal = 1  # PR_SET_PDEATHSIG
    ctypes.CDLL(None).prctl(set_death_signal, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:  # already
        os._exit(_FAILED)
