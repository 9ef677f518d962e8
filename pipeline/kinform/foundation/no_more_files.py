"""Native code that can open no file: what a file that it is given names elsewhere stays closed to it.

A limit of 0 for open files, or a filter of system calls, would also stop buffers in memory, which are files to the
system. Linux can close the file systems and leave these (Landlock, since 5.13), for this process and its children.
"""

from __future__ import annotations

import struct
import sys

_CREATE_RULES, _RESTRICT = 444, 446
"""Numbers of system calls, the same on all machines."""
_NO_NEW_PRIVILEGES = 38
"""Of prctl."""
_EVERYTHING = (1 << 13) - 1
"""All that the first version of Landlock can refuse: to run, to read, to write, to make, to remove."""


def open_no_more_files() -> bool:
    """Let this process open no file of a file system any more, for good; False where the system cannot do that."""
    if sys.platform != "linux":
        return False
    import ctypes

    system = ctypes.CDLL(None)
    refused = struct.pack("Q", _EVERYTHING)
    rules = system.syscall(ctypes.c_long(_CREATE_RULES), refused, ctypes.c_size_t(len(refused)), ctypes.c_long(0))
    if rules < 0 or system.prctl(_NO_NEW_PRIVILEGES, *map(ctypes.c_ulong, (1, 0, 0, 0))) != 0:
        return False
    return bool(system.syscall(ctypes.c_long(_RESTRICT), ctypes.c_long(rules), ctypes.c_long(0)) == 0)
