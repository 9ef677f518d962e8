"""The desks of this process: processes that do tasks, started when they are needed, and again when they died."""

from __future__ import annotations

import contextlib
import queue
import subprocess
from typing import Any

from kinform.batch.desk import receive, send
from kinform.batch.task import DIED, Answer, Task, failed
from kinform.foundation import interpreters

_free: queue.LifoQueue[Desk] = queue.LifoQueue()
"""Desks that have nothing to do."""


class Desk:
    """A process that does tasks, one at a time; it ends with this one."""

    def __init__(self) -> None:
        self._process: Any = subprocess.Popen(
            interpreters.command("-m", "kinform.batch.desk"), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env=interpreters.environment(OPENBLAS_NUM_THREADS="1"), start_new_session=True,
        )  # fmt: skip

    @property
    def pid(self) -> int:
        """The number of the process."""
        return int(self._process.pid)

    @property
    def alive(self) -> bool:
        """Whether it can be given a task."""
        return self._process.poll() is None

    def ask(self, task: Task) -> Answer:
        """The answer to a task; one that says so where the desk died."""
        try:
            send(self._process.stdin, task)
            answer: Answer = receive(self._process.stdout)
            return answer
        except (EOFError, OSError):
            self.close()
            status = self._process.returncode
            how = f"signal {-status}" if status is not None and status < 0 else f"exit code {status}"
            return Answer(task.key, failure=failed(DIED, f"the worker was ended by {how}", "run it alone"))

    def close(self) -> None:
        """End it, and what it does."""
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                stream.close()
        try:
            self._process.wait(timeout=1)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def perform(task: Task) -> Answer:
    """The answer to a task, by a free desk of this process, or a new one: what a worker of Dask does."""
    try:
        desk = _free.get_nowait()
    except queue.Empty:
        desk = Desk()
    if not desk.alive:
        desk.close()
        desk = Desk()
    answer = desk.ask(task)
    if desk.alive:
        _free.put(desk)
    return answer


def close_all() -> None:
    """End all free desks of this process."""
    while True:
        try:
            _free.get_nowait().close()
        except queue.Empty:
            return
