"""Two computations that need nothing of each other, side by side: one of them in a process of its own."""

from __future__ import annotations

import contextlib
import gc
import os
import pickle
import signal
from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

__all__ = ["beside"]

One = TypeVar("One")
Two = TypeVar("Two")

_LENGTH = 8
"""Bytes that say how many follow."""


def beside(first: Callable[[], One], second: Callable[[], Two]) -> tuple[One, Two]:
    """What both give, `second` computed by a fork of this process meanwhile; raises what they raise.

    Where the system cannot fork, or the fork does not come to an end, for whatever reason, it is computed here.
    """
    if not hasattr(os, "fork"):
        return first(), second()
    source, sink = os.pipe()
    child = os.fork()
    if not child:
        os.close(source)
        _tell(second, sink)
    os.close(sink)
    try:
        with open(source, "rb") as stream:
            one = first()
            told = stream.read()
    finally:
        with contextlib.suppress(OSError):
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    if int.from_bytes(told[:_LENGTH], "little") == len(told) - _LENGTH > 0:
        two: Two = pickle.loads(told[_LENGTH:])
        return one, two
    return one, second()


def _tell(compute: Callable[[], Any], sink: int) -> NoReturn:
    """Write what is computed, and end this process."""
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        gc.disable()
        told = pickle.dumps(compute(), protocol=pickle.HIGHEST_PROTOCOL)
        with open(sink, "wb") as stream:
            stream.write(len(told).to_bytes(_LENGTH, "little") + told)
    finally:
        os._exit(0)
