"""The same function of many things, in several processes where the system can fork; and what a crash there becomes.

Native code can end a process without a word. One that ends so in a worker is found out by doing what was left again,
each in a process of its own, and told as a `Crash` with what it was about.

A fork has one thread. Where native code has run threads before (manifold3d's TBB, in a notebook that has derived one
design and reads another), it may wait for ever in the fork for those that are not there. So nothing is forked then that
could ask it again (`threads_ran`): many things are computed in this process, single ones by a new interpreter.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

from kinform.errors import KinformError
from kinform.foundation import current_work
from kinform.foundation.current_work import working_on
from kinform.foundation.parent_death import exit_with_parent
from kinform.foundation.progress import Progress

Item = TypeVar("Item")
Result = TypeVar("Result")

_function: Callable[[Any], Any] | None = None
"""What a worker does; a fork has it, and all that it holds, without being sent it."""


_threaded = False
"""Whether native code may have run threads in this process, or in one that it was forked from."""


def threads_ran() -> None:
    """Note that native code that runs threads is about to be asked in this process."""
    global _threaded
    _threaded = True


class Crash(KinformError):
    """A process ended without an answer: `cause` is the signal, or the exit code; `subject` what it was at work on."""

    def __init__(self, cause: str, subject: str = ""):
        self.cause, self.subject = cause, subject
        of = f"{subject}: " if subject else ""
        super().__init__(
            f"{of}the process that computed this was ended by {cause}; "
            "look at the mesh (kinform show F.h5 assembly), export it again, or leave the part out"
        )


def map_in_processes(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    jobs: int,
    progress: Progress | None = None,
    name: Callable[[Item], str] = str,
    *,
    little: bool = False,
    weights: Sequence[float] | None = None,
    meanwhile: Callable[[], None] | None = None,
) -> Iterator[Result]:
    """The function of each item, in their order, whatever the number of `jobs`; `progress(done, total)` counts items.

    Items and results are sent between processes, the function is not. Where the system cannot fork, threads do it;
    where native threads ran in this process, it does all in turn.
    Raises Crash, with the `name` of the item, where another process ends without an answer: with more than one of the
    `jobs`, also a single item is computed in one. `little`: all of them together take no longer than several processes
    take to start, and are computed in one. Those of the greatest `weights` are begun first, so that none of these is
    left at the end. `meanwhile` is called here while several processes are at work, and not where they are not.
    """
    for done, result in enumerate(_results(function, items, jobs, name, little, weights, meanwhile), start=1):
        if progress is not None:
            progress(done, len(items))
        yield result


def _results(
    function: Callable[[Item], Result],
    items: Sequence[Item],
    jobs: int,
    name: Callable[[Item], str],
    little: bool,
    weights: Sequence[float] | None,
    meanwhile: Callable[[], None] | None,
) -> Iterator[Result]:
    if jobs <= 1 or _threaded:
        for item in items:
            with working_on(name(item)):
                result = function(item)
            yield result
        return
    import numpy.ma  # noqa: F401  numpy loads it when it is first asked for distinct values: here once for all processes

    if len(items) < 2:
        yield from _one_by_one(function, items, name)
        return
    if little:
        try:
            together = in_own_process(lambda: [function(item) for item in items])
        except Crash:
            yield from _one_by_one(function, items, name)
        else:
            yield from together
        return
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    pool: Any
    task: Callable[[Item], Result]
    if "fork" in multiprocessing.get_all_start_methods():
        context = multiprocessing.get_context("fork")
        pool, task = (
            ProcessPoolExecutor(jobs, context, initializer=_begin, initargs=(function, os.getpid())),
            _in_worker,
        )
    else:
        pool, task = ThreadPoolExecutor(jobs), function
    done = 0
    others = set(multiprocessing.active_children())
    order = range(len(items)) if weights is None else sorted(range(len(items)), key=lambda k: -weights[k])
    try:
        begun = {k: pool.submit(task, items[k]) for k in order}
        if meanwhile is not None:
            meanwhile()
        for k in range(len(items)):
            yield begun.pop(k).result()
            done += 1
    except BrokenProcessPool:
        yield from _one_by_one(function, items[done:], name)
    except BaseException:  # nobody waits any more for what takes long, Ctrl-C first of all
        for worker in set(multiprocessing.active_children()) - others:
            worker.kill()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _one_by_one(
    function: Callable[[Item], Result], items: Sequence[Item], name: Callable[[Item], str]
) -> Iterator[Result]:
    """The function of each item, each in a process of its own; raises Crash with the name of the first that ends it."""
    for item in items:
        try:
            yield in_own_process(lambda item=item: function(item))  # type: ignore[misc]
        except Crash as crash:
            raise Crash(crash.cause, name(item)) from None


def _begin(function: Callable[[Any], Any], asker: int) -> None:
    """Remember what is to be done, leave Ctrl-C to the process that waits for it, and end with that one."""
    global _function
    exit_with_parent(asker)
    _function = function
    current_work.board = None
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _in_worker(item: Any) -> Any:
    assert _function is not None
    return _function(item)


def in_own_process(function: Callable[[], Result]) -> Result:
    """The function's result, computed in a fork; raises what it raises, and Crash where the fork ends without one.

    Where the system cannot fork it is called here. Of what runs native threads: `apart`.
    """
    if not hasattr(os, "fork"):
        return function()
    reading, writing = os.pipe()
    asker = os.getpid()
    child = os.fork()
    if child == 0:
        _answer(function, asker, reading, writing)
    os.close(writing)
    try:
        with os.fdopen(reading, "rb") as stream:
            answer = stream.read()
    except BaseException:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    _, status = os.waitpid(child, 0)
    if status != 0:
        raise Crash(cause_of(status))
    result: Result = _given_or_raised(answer)
    return result


def apart(function: Callable[..., Result], *given: Any) -> Result:
    """What a function of a module gives of picklable things, in another process, as `in_own_process`.

    In a fork, or, where native threads ran in this process, by a new interpreter, which imports nothing of the program
    that this one runs.
    """
    if not _threaded or not sys.executable:
        return in_own_process(lambda: function(*given))
    import subprocess

    from kinform.foundation import interpreters

    run = (
        f"import sys; sys.path[:] = {interpreters.search_path()!r}; "
        f"from kinform.foundation import processes; processes.answer_asked({os.getpid()})"
    )
    with subprocess.Popen(interpreters.command("-c", run), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          env=interpreters.environment()) as child:  # fmt: skip
        try:
            answer, _ = child.communicate(pickle.dumps((function, given)))
        except BaseException:
            child.kill()
            raise
    if child.returncode != 0:
        raise Crash(_cause(child.returncode))
    result: Result = _given_or_raised(answer)
    return result


def answer_asked(asker: int) -> None:
    """In a new interpreter: answer on the standard output what the process `asker` asks on the standard input."""
    exit_with_parent(asker)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    writing = os.dup(1)
    os.dup2(2, 1)  # what native code says is no answer
    function, given = pickle.load(sys.stdin.buffer)
    with os.fdopen(writing, "wb") as stream:
        stream.write(_answered(lambda: function(*given)))


def _given_or_raised(answer: bytes) -> Any:
    succeeded, value = pickle.loads(answer)
    if not succeeded:
        raise value
    return value


def _answered(function: Callable[[], Any]) -> bytes:
    """What the function gives or raises."""
    try:
        return pickle.dumps((True, function()))
    except Exception as error:
        return pickle.dumps((False, error))


def _answer(function: Callable[[], Any], asker: int, reading: int, writing: int) -> None:
    """In the fork: send what the function gives or raises, and end without touching anything of the parent."""
    code = 1
    try:
        exit_with_parent(asker)
        os.close(reading)
        current_work.board = None  # what ends this process is told by who asked for it
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        answer = _answered(function)
        with os.fdopen(writing, "wb") as stream:
            stream.write(answer)
        code = 0
    finally:
        os._exit(code)


def cause_of(status: int) -> str:
    """What ended a process, from the status of waitpid."""
    return _cause(os.waitstatus_to_exitcode(status))


def _cause(code: int) -> str:
    return f"signal {-code} ({signal.Signals(-code).name})" if code < 0 else f"exit code {code}"
