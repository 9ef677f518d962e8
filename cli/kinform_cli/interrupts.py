"""Ctrl-C that is not lost: an exception raised inside a callback of another library is swallowed there."""

from __future__ import annotations

import signal
import threading
from types import FrameType

__all__ = ["check", "listen"]

_pending = threading.Event()


def listen() -> None:
    """From now on remember that Ctrl-C was pressed, besides raising KeyboardInterrupt."""
    _pending.clear()
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) in (
        signal.default_int_handler,
        _remember,
    ):
        signal.signal(signal.SIGINT, _remember)


def check() -> None:
    """Raise KeyboardInterrupt where Ctrl-C was pressed and the exception went missing."""
    if _pending.is_set():
        _pending.clear()
        raise KeyboardInterrupt


def _remember(number: int, frame: FrameType | None) -> None:
    del number, frame
    _pending.set()
    raise KeyboardInterrupt
