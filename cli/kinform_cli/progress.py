"""Progress on stderr: only on a terminal, only for work that takes over a second."""

from __future__ import annotations

import sys
import threading
from types import TracebackType
from typing import TYPE_CHECKING

from kinform_cli import console

if TYPE_CHECKING:
    from rich.progress import Progress as Bars

__all__ = ["DELAY", "Working"]

DELAY = 1.0
"""Seconds after which a bar appears."""


class Working:
    """A context in which work is under way; call it with (done, total) as the work proceeds.

    Without calls there is a spinner; `stage` changes the label when the next stage begins. The bar
    vanishes at the end.
    """

    def __init__(self, label: str):
        self._label = label
        self._done, self._total = 0, 0
        self._bars: Bars | None = None
        self._lock = threading.Lock()
        self._timer: threading.Timer | None = None

    def __enter__(self) -> Working:
        if sys.stderr.isatty() and not console.settings.quiet:
            self._timer = threading.Timer(DELAY, self._appear)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
            if self._bars is not None:
                self._bars.stop()
                self._bars = None

    def __call__(self, done: int, total: int) -> None:
        """So many of so many steps of the present stage are done; total 0 when nobody knows."""
        with self._lock:
            self._done, self._total = done, total
            self._refresh()

    def stage(self, label: str) -> None:
        """The next stage begins."""
        with self._lock:
            self._label, self._done, self._total = label, 0, 0
            self._refresh()

    def _refresh(self) -> None:
        if self._bars is not None:
            self._bars.update(
                self._bars.task_ids[0],
                description=self._label,
                completed=self._done,
                total=self._total or None,
            )

    def _appear(self) -> None:
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            SpinnerColumn,
            TextColumn,
            TimeElapsedColumn,
        )

        with self._lock:
            if self._timer is None:
                return
            self._bars = Progress(
                SpinnerColumn(),
                TextColumn("{task.description}", markup=False),
                BarColumn(bar_width=30),
                MofNCompleteColumn(),
                TimeElapsedColumn(),
                console=console.stderr(),
                transient=True,
            )
            self._bars.add_task(self._label, total=None)
            self._refresh()
            self._bars.start()
