"""Progress on stderr: only on a terminal, only for work that takes over a second.

A thread of its own draws, so that the clock goes on while a step takes long. Stages fork workers: the
lock is held across a fork, so that no worker starts with a half-written line.
"""

from __future__ import annotations

import os
import sys
import threading
from types import TracebackType
from typing import TYPE_CHECKING

from kinform.foundation.escapes import one_line
from kinform_cli import console, interrupts

if TYPE_CHECKING:
    from rich.progress import Progress as Bars


_drawing = threading.RLock()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_drawing.acquire, after_in_parent=_drawing.release, after_in_child=_drawing.release)


class Working:
    """A context in which work is under way; call it with (done, total) as the work proceeds.

    Without calls there is a spinner; `stage` changes the label when another stage begins. The bar
    vanishes at the end.
    """

    def __init__(self, label: str):
        self._label = one_line(label)
        self._done, self._total = 0, 0
        self._over = threading.Event()
        self._thread: threading.Thread | None = None

    def __enter__(self) -> Working:
        if sys.stderr.isatty() and not console.settings.quiet:
            self._thread = threading.Thread(target=self._draw, daemon=True)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        if self._thread is not None:
            self._thread.join()

    def __call__(self, done: int, total: int) -> None:
        """So many of so many steps of the present stage are done; total 0 when nobody knows."""
        interrupts.raise_unheard()
        self._done, self._total = done, total

    def stage(self, label: str) -> None:
        """This stage is under way now."""
        self._label = one_line(label)

    def step(self, label: str, done: int, total: int) -> None:
        """As a run reports it: so many steps of this stage are done."""
        self.stage(label)
        self(done, total)

    def _draw(self) -> None:
        # Seconds after which a bar appears: shorter work needs none.
        if self._over.wait(1.0):
            return
        with _drawing:
            bars = _bars()
            task = bars.add_task(self._label, total=None)
            bars.start()
        # Seconds between two drawings of the bar; a choice.
        while not self._over.wait(0.1):
            with _drawing:
                bars.update(task, description=self._label, completed=self._done, total=self._total or None)
                bars.refresh()
        with _drawing:
            bars.stop()


def _bars() -> Bars:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console.stderr(),
        auto_refresh=False,
        redirect_stdout=False,
        redirect_stderr=False,
        transient=True,
    )
