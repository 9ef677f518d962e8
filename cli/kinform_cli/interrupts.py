"""Ctrl-C is heard once, wherever it falls.

Python raises KeyboardInterrupt between any two instructions. Where that is a callback of its own or of a library, as
while modules are imported, it is dropped there and the program goes on: such a one is raised again at the next step of
the work.
"""

from __future__ import annotations

import signal
from types import FrameType

_asked = False


def listen() -> None:
    """Remember each Ctrl-C; where it is ignored, as in the background of a shell, it stays so."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)


def raise_unheard() -> None:
    """Raises KeyboardInterrupt where one was asked for before and did not get through."""
    if _asked:
        raise KeyboardInterrupt


def _interrupted(number: int, frame: FrameType | None) -> None:
    """Once: a terminal sends Ctrl-C to all processes, and the one that watches passes it on."""
    global _asked
    if not _asked:
        _asked = True
        raise KeyboardInterrupt
