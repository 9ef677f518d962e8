"""Memory that is free goes back to the system before much more is taken; and nothing is searched for what can be freed
while many small things are made that stay."""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import numpy as np

LEARNT = (32 << 20) - (64 << 10)
"""Bytes of the largest array whose release makes glibc raise its mmap threshold: DEFAULT_MMAP_THRESHOLD_MAX, 32 MiB,
less room for its header."""


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


@cache
def keep_heap() -> None:
    """From now on, arrays of up to 32 MB come from a heap of their own, and 64 MB that are free at its end stay there.

    Otherwise glibc has each array of more than 128 kB from the system, and gives it back, page by page, until it has
    seen larger ones come and go: then it learns this from the largest, and so it does at once from one that nobody
    touches. A second one is from the heap, and numpy asks for large pages there. Of the pages that recovering surfaces
    asks for, two thirds are saved so, and a twentieth of its time. On systems with another C library nothing happens.
    """
    for _ in range(2):
        np.empty(LEARNT, np.uint8)


def give_back() -> None:
    """Return what was freed but is kept for later: arrays of up to 32 MB, which glibc takes from a heap of its own.

    On systems with another C library nothing happens.
    """
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (OSError, AttributeError, TypeError):  # Windows has no such handle
        return
    trim(0)
