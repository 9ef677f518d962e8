"""Ctrl-C is heard once, wherever it falls.

Python raises KeyboardInterrupt between any two instructions. Where that is a callback of its own or of a library, as
while modules are imported, it is dropped there and the program goes on: such a one is raised again at the next step of
the work. While a native module is imported it is heard a moment later.
"""

from __future__ import annotations

import signal
import sys
from importlib.machinery import ExtensionFileLoader
from types import FrameType

AGAIN = 0.01
"""Seconds after which Ctrl-C is heard that came while a native module was imported; a choice."""


_asked = False


def listen() -> None:
    """Remember each Ctrl-C; where it is ignored, as in the background of a shell, it stays so."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)
        sys.unraisablehook = _dropped


def raise_unheard() -> None:
    """Raises KeyboardInterrupt where one was asked for before and did not get through."""
    if _asked:
        raise KeyboardInterrupt


def asked() -> bool:
    """Whether Ctrl-C was pressed: a library that drops it may say of its input what is not so."""
    return _asked


def _interrupted(number: int, frame: FrameType | None) -> None:
    """Once: a terminal sends Ctrl-C to all processes, and the one that watches passes it on."""
    global _asked
    if _asked:
        return
    if _in_native_import(frame) and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _interrupted)
        signal.setitimer(signal.ITIMER_REAL, AGAIN)
        return
    _asked = True
    raise KeyboardInterrupt


def _dropped(dropped: sys.UnraisableHookArgs) -> None:
    """What a callback raised and nobody hears: of Ctrl-C, which is raised again, nothing is said."""
    if not (_asked and isinstance(dropped.exc_value, KeyboardInterrupt)):
        sys.__unraisablehook__(dropped)


def _in_native_import(frame: FrameType | None) -> bool:
    """Whether a native module is being imported: what is raised in Python that it calls then would end the process."""
    while frame is not None:
        loads = frame.f_code.co_name in ("create_module", "exec_module")
        if loads and isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False
