"""Memory that is free goes back to the system before much more is taken."""

from __future__ import annotations

import ctypes


def give_back() -> None:
    """Return what was freed but is kept for later: arrays of up to 32 MB, which glibc takes from a heap of its own.

    On systems with another C library nothing happens.
    """
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no such handle
        return
    trim(0)
