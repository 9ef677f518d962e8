"""Workers of Dask that do tasks: a cluster of this process on this machine, or any other by its address.

The crew gives out no more tasks than its workers can take, so that a death is that of the task it was about. A task
whose worker died is begun once more, elsewhere where there is another worker; died it twice, that is its answer.
"""

from __future__ import annotations

import collections
import contextlib
import os
import signal
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from types import TracebackType
from typing import Any

from kinform.batch.desks import close_all, perform
from kinform.batch.task import DIED, INTERNAL, Answer, Task, failed
from kinform.errors import InputError, Problem
from kinform.foundation import interpreters

TRIES = 2
"""How often a task is begun whose worker died: once, and once more elsewhere."""
WAITING = 2
"""Tasks a worker that are under way or waiting for it, so that none is idle while an answer travels. A choice."""
PATIENCE = 20.0
"""s in which a scheduler has to answer, and to have a worker: workers start within seconds, on a busy machine too.
Chosen, not measured."""


MISSING = "many designs at once need Dask, which is not installed"
REMEDY = "install it: pip install 'kinform[batch]'"


class Crew:
    """A context in which there are workers. Raises InputError where Dask is not installed, or nobody is at the
    address."""

    def __init__(self, jobs: int = 1, scheduler: str | None = None):
        self._jobs, self._scheduler = jobs, scheduler
        self._closing = contextlib.ExitStack()
        self._client: Any = None

    def __enter__(self) -> Crew:
        try:
            with interpreters.safe_children():
                import dask
                import distributed
        except ImportError:
            raise InputError([Problem(MISSING, None, None, REMEDY)]) from None
        warnings.filterwarnings("ignore", module=r"distributed\..*")
        if self._scheduler is not None:
            self._client = self._connected(distributed)
            return self
        settings = {
            "distributed.scheduler.allowed-failures": 0,
            "distributed.scheduler.worker-saturation": 1.0,
            "distributed.scheduler.work-stealing": False,
            "distributed.comm.timeouts.connect": "30s",
            "distributed.admin.tick.limit": "1h",
        }
        self._closing.enter_context(interpreters.safe_children())
        self._closing.enter_context(dask.config.set(settings))
        with _deaf():
            cluster = distributed.LocalCluster(
                n_workers=self._jobs, threads_per_worker=1, processes=True, memory_limit=0, dashboard_address=None,
                silence_logs=60, host="127.0.0.1",
            )  # fmt: skip
        self._closing.callback(cluster.close, timeout=10)
        self._client = distributed.Client(cluster, set_as_default=False)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, KeyboardInterrupt):  # workers end with this process: nobody waits for what they do
            return
        if self._scheduler is None:
            with contextlib.suppress(Exception):
                self._client.run(close_all)
        with contextlib.suppress(Exception):
            self._client.close(timeout=5)
        self._closing.close()

    @property
    def size(self) -> int:
        """How many tasks are done at once, now."""
        return sum(self._client.nthreads().values())

    def answers(self, tasks: Iterable[Task]) -> Iterator[Answer]:
        """The answer to each task, as they come; tasks are taken when there is somebody to do them."""
        from distributed import as_completed

        waiting = collections.deque[tuple[Task, int, tuple[str, ...]]]()
        source = iter(tasks)
        under_way: dict[Any, tuple[Task, int]] = {}
        completed = as_completed([], loop=self._client.loop)

        def more() -> bool:
            if not waiting:
                task = next(source, None)
                if task is None:
                    return False
                waiting.append((task, 1, ()))
            task, tries, avoided = waiting.popleft()
            workers = [name for name in self._client.nthreads() if name not in avoided] if avoided else []
            placed = {"workers": workers, "allow_other_workers": True} if workers else {}
            future = self._client.submit(perform, task, key=f"{task.key}-{tries}-{os.urandom(4).hex()}", pure=False,
                                         **placed)  # fmt: skip
            under_way[future] = (task, tries)
            completed.add(future)
            return True

        def fill() -> None:
            most = WAITING * max(self.size, 1)
            while len(under_way) < most and more():
                pass

        fill()
        while under_way:
            future = next(completed)
            task, tries = under_way.pop(future)
            answer, avoided = _outcome(future, task)
            future.release()
            if answer.failure is not None and answer.failure.kind == DIED and tries < TRIES:
                waiting.append((task, tries + 1, avoided))
            else:
                yield replace(answer, tries=tries)
            fill()

    def _connected(self, distributed: Any) -> Any:
        address = str(self._scheduler)
        try:
            client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            remedy = "start one: dask scheduler; and workers: dask worker ADDRESS --nthreads 1"
            raise InputError([Problem(f"no scheduler answers there: {error}", address, None, remedy)]) from None
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            client.close()
            remedy = f"start one: dask worker {address} --nthreads 1"
            raise InputError([Problem("the scheduler has no worker", address, None, remedy)]) from None
        return client


def _outcome(future: Any, task: Task) -> tuple[Answer, tuple[str, ...]]:
    """The answer of a future that is done, and the worker that the task should not be given to again."""
    from distributed.scheduler import KilledWorker

    error = future.exception()
    if error is None:
        answer: Answer = future.result()
        if answer.failure is not None and answer.failure.kind == DIED:
            return answer, tuple(future.client.who_has([future]).get(future.key, ()))
        return answer, ()
    if isinstance(error, KilledWorker):
        lost = failed(DIED, "the worker that did it died, killed or out of memory", "run it alone")
        return Answer(task.key, failure=lost), ()
    remedy = "see that the workers have the same kinform"
    return Answer(task.key, failure=failed(INTERNAL, f"{type(error).__name__}: {error}", remedy)), ()


@contextlib.contextmanager
def _deaf() -> Iterator[None]:
    """Processes that are begun now do not hear Ctrl-C: they end with this one."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:  # not the main thread
        yield
        return
    # the process that clears up after them is begun with them, and would warn of all that an end by Ctrl-C leaves to it
    warned = os.environ.get("PYTHONWARNINGS")
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (warned, "ignore:resource_tracker")))
    try:
        yield
    finally:
        if warned is None:
            del os.environ["PYTHONWARNINGS"]
        else:
            os.environ["PYTHONWARNINGS"] = warned
        signal.signal(signal.SIGINT, before)
