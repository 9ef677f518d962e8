"""The same function of many things, in several processes where the system can fork."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from kinform.foundation.progress import Progress

Item = TypeVar("Item")
Result = TypeVar("Result")

_function: Callable[[Any], Any] | None = None
"""What a worker does; a fork has it, and all that it holds, without being sent it."""


def map_in_processes(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int, progress: Progress | None = None
) -> Iterator[Result]:
    """The function of each item, in their order, whatever the number of `jobs`; `progress(done, total)` counts items.

    Items and results are sent between processes, the function is not. Where the system cannot fork, threads do it.
    """
    for done, result in enumerate(_results(function, items, jobs), start=1):
        if progress is not None:
            progress(done, len(items))
        yield result


def _results(function: Callable[[Item], Result], items: Sequence[Item], jobs: int) -> Iterator[Result]:
    if jobs <= 1 or len(items) < 2:
        yield from map(function, items)
        return
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

    pool: Any
    task: Callable[[Item], Result]
    if "fork" in multiprocessing.get_all_start_methods():
        context = multiprocessing.get_context("fork")
        pool, task = ProcessPoolExecutor(jobs, context, initializer=_begin, initargs=(function,)), _in_worker
    else:
        pool, task = ThreadPoolExecutor(jobs), function
    try:
        yield from pool.map(task, items)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _begin(function: Callable[[Any], Any]) -> None:
    """Remember what is to be done, and leave Ctrl-C to the process that waits for it."""
    global _function
    _function = function
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _in_worker(item: Any) -> Any:
    assert _function is not None
    return _function(item)
