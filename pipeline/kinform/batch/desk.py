"""The process of a worker that does tasks, one after the other, each in a fork of its own.

It has one thread, so that forking is safe, and has imported what tasks need, so that a fork costs milliseconds. Tasks
come on stdin and answers go to stdout, each as its length in eight bytes and a pickle. Where stdin ends, so does the
task that is under way: nobody waits for it any more. A task that dies, takes longer than its limit, or more memory, is
answered as such. `python -m kinform.batch.desk` is started by `kinform.batch.desks`.
"""

from __future__ import annotations

import contextlib
import importlib
import mmap
import os
import pickle
import select
import signal
import sys
import time
import traceback
from dataclasses import replace
from typing import IO, Any

from kinform.batch.task import DIED, INPUT, INTERNAL, MEMORY, TIME, Answer, Failure, Limits, Task, failed
from kinform.errors import InputError, KinformError, Problem, ResultsError
from kinform.foundation import current_work
from kinform.foundation.parent_death import exit_with_parent
from kinform.foundation.processes import cause_of
from kinform.foundation.words import number

LOOK = 0.05
"""s between two looks at the memory of a task and at its clock: a process that writes new memory at 1 GB/s is seen
within 50 MB of its limit. A choice."""


IMPORTED = (
    "kinform.method", "kinform.stages", "kinform.results", "kinform.form.readers.assembly", "kinform.kinematics",
    "kinform.reuse.contacts", "kinform.mass", "kinform.simulation", "kinform.collisions", "kinform.consistency.rules",
    "kinform.consistency.inspection", "kinform.simulation.assembly_simulation", "kinform.simulation.system_simulation",
    "kinform.simulation.kernel", "kinform.simulation.levels", "kinform.simulation.mechanism", "kinform.reuse.decisions",
    "kinform.reuse.masses", "kinform.reuse.packing", "kinform.reports.values.topics", "kinform.reports.values.form",
    "kinform.reports.values.kinematics", "kinform.reports.values.runs", "kinform.consistency.comparisons.answers",
    "numpy.ma", "numpy.random",
)  # fmt: skip
"""Modules that tasks are likely to need: imported once, before any fork."""


def send(stream: IO[bytes], item: object) -> None:
    """Write an item, whole."""
    data = pickle.dumps(item, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(len(data).to_bytes(8, "little"))
    stream.write(data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """The next item; EOFError where there is none, or only the beginning of one."""
    return pickle.loads(_read(stream, int.from_bytes(_read(stream, 8), "little")))


def _read(stream: IO[bytes], length: int) -> bytes:
    """So many bytes, of a pipe that gives what it has; EOFError where there are fewer."""
    data = bytearray()
    while len(data) < length:
        piece = stream.read(length - len(data))
        if not piece:
            raise EOFError
        data += piece
    return bytes(data)


def main() -> None:
    """Do tasks until stdin ends."""
    exit_with_parent(os.getppid())
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asked = os.fdopen(os.dup(0), "rb", buffering=0)
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(2, 1)  # what a library prints is no answer
    for name in IMPORTED:
        importlib.import_module(name)
    while True:
        try:
            task = receive(asked)
            answer = attend(task, asked.fileno())
            send(answers, answer)
        except (EOFError, BrokenPipeError):
            return


def attend(task: Task, asker: int | None = None) -> Answer:
    """The answer to a task, done in a fork where the system can. `asker` is the file that ends when nobody waits any
    more: then EOFError."""
    began = time.monotonic()
    if not hasattr(os, "fork"):
        return replace(do(task), seconds=time.monotonic() - began)
    board = mmap.mmap(-1, mmap.PAGESIZE)
    reading, writing = os.pipe()
    desk = os.getpid()
    child = os.fork()
    if child == 0:
        _work(task, desk, reading, writing, board)
    os.close(writing)
    try:
        with os.fdopen(reading, "rb", buffering=0) as stream:
            data, over = _wait(stream, child, task.limits, asker, began)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    seconds = time.monotonic() - began
    if over is not None:
        return Answer(task.key, failure=over, seconds=seconds)
    if len(data) > 8 and len(data) == 8 + int.from_bytes(data[:8], "little"):
        answer: Answer = pickle.loads(data[8:])
        return replace(answer, seconds=seconds)
    return Answer(task.key, failure=_dead(status, current_work.read(board)), seconds=seconds)


def _work(task: Task, desk: int, reading: int, writing: int, board: mmap.mmap) -> None:
    """In the fork: do the task, send the answer, and end."""
    code = 1
    try:
        os.setpgid(0, 0)
        exit_with_parent(desk)
        os.close(reading)
        current_work.board = board
        with os.fdopen(writing, "wb") as stream:
            send(stream, do(task))
        code = 0
    finally:
        os._exit(code)


def do(task: Task) -> Answer:
    """The answer to a task, done here; whatever is raised becomes a failure."""
    module, _, name = task.function.partition(":")
    try:
        if task.code and task.code != code_of_here():
            return Answer(task.key, failure=_other_code())
        return Answer(task.key, getattr(importlib.import_module(module), name)(**task.arguments))
    except InputError as error:
        return Answer(task.key, failure=Failure(INPUT, error.problems))
    except ResultsError as error:
        return Answer(task.key, failure=Failure(INPUT, (error.problem,)))
    except KinformError as error:
        return Answer(task.key, failure=Failure(INPUT, (Problem(str(error)),)))
    except MemoryError:
        return Answer(task.key, failure=failed(MEMORY, "out of memory", "use coarser meshes, or a larger machine"))
    except OSError as error:
        place = None if error.filename is None else str(error.filename)
        return Answer(task.key, failure=Failure(INPUT, (Problem(error.strerror or str(error), place),)))
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        message = f"{type(error).__name__}: {error} ({os.path.basename(where.filename)}:{where.lineno})"
        return Answer(task.key, failure=failed(INTERNAL, message, "run it alone with --debug, and report it"))


def code_of_here() -> str:
    """What tells the code of this kinform from other versions: equal codes give equal bytes."""
    from kinform.reuse import lineage

    return lineage.of_code()


def _other_code() -> Failure:
    import platform

    from kinform.version import __version__

    message = f"the worker on {platform.node()} has another kinform ({__version__}), which could give other results"
    return failed(INPUT, message, "install there the version of who asks")


def _wait(stream: Any, child: int, limits: Limits, asker: int | None, began: float) -> tuple[bytes, Failure | None]:
    """What the fork sends until it ends, or which limit it broke."""
    data = bytearray()
    watched = [stream.fileno()] + ([] if asker is None else [asker])
    limited = limits.seconds is not None or limits.memory is not None
    while True:
        ready, _, _ = select.select(watched, [], [], LOOK if limited else None)
        if stream.fileno() in ready:
            piece = stream.read(1 << 20)
            if not piece:
                return bytes(data), None
            data += piece
        elif asker in ready:  # one task at a time is sent: this is its end
            raise EOFError
        if limits.seconds is not None and time.monotonic() - began > limits.seconds:
            message = f"not done after {number(limits.seconds)} s, the limit of a design"
            return b"", failed(TIME, message, "give it longer with --time, or simplify it")
        if limits.memory is not None and (used := memory_of(child)) > limits.memory:
            message = f"took {used / 1e6:.0f} MB of memory, the limit of a design is {limits.memory / 1e6:.0f} MB"
            return b"", failed(MEMORY, message, "give it more with --memory, or coarser meshes")


def memory_of(process: int) -> int:
    """Bytes of memory that a process and those below it have for themselves or share; 0 where it is gone."""
    import psutil

    total = 0
    with contextlib.suppress(psutil.Error):
        top = psutil.Process(process)
        for each in (top, *top.children(recursive=True)):
            with contextlib.suppress(psutil.Error):
                total += each.memory_info().rss
    return total


def _dead(status: int, subject: str) -> Failure:
    """The failure of a fork that ended without an answer."""
    at = f" at work on {subject}" if subject else ""
    killed = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL
    why = ", from outside or for want of memory" if killed else ""
    remedy = "look at its meshes, or leave the part out" if not killed else "run it alone, with fewer --jobs"
    return failed(DIED, f"its process was ended by {cause_of(status)}{why}{at}", remedy)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
