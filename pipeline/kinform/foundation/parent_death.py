"""Child processes that are killed when their parent dies, however it died. On Linux only; elsewhere they go on."""

from __future__ import annotations

import os
import signal
import sys


def exit_with_parent(parent: int) -> None:
    """Have the kernel kill this process when its parent, the process with that id, dies."""
    if sys.platform != "linux":
        return
    import ctypes

    set_death_signal = 1  # PR_SET_PDEATHSIG
    ctypes.CDLL(None).prctl(set_death_signal, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:  # already
        os._exit(2)
