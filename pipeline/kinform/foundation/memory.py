"""Memory that is free goes back to the system before much more is taken; and nothing is searched for what can be freed
while many small things are made that stay."""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uncollected() -> Iterator[None]:
    """Python does not search for cycles of objects that nobody holds, as a context or of a function that it decorates.

    Where hundreds of thousands of small objects are made that stay, and no cycles of them, that takes a fifteenth of
    the time, and finds nothing. What nobody holds and is in no cycle is freed all the same.
    """
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


def give_back() -> None:
    """Return what was freed but is kept for later: arrays of up to 32 MB, which glibc takes from a heap of its own.

    On systems with another C library nothing happens.
    """
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no such handle
        return
    trim(0)
