"""A function in a process that has nothing but questions to its parent: no environment, no files, no network.

The process is a fork. Before the function runs in it, its environment is cleared and every file that it inherited is
closed but two pipes. The system is told that it may open no file, write to none and start no process (limits of 0 for
RLIMIT_NOFILE, RLIMIT_FSIZE, RLIMIT_NPROC), and how much time and memory it has. An audit hook ends the process at
whatever else Python reports (imports, code objects, sockets, signals, directories, …) but the few events in `HARMLESS`.
Whatever the function needs it asks for in bytes; the parent decides what it answers, and takes its answer as bytes too.

Where the system cannot fork the function is called here, and asks in the same way.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from typing import Any

from kinform.foundation import current_work
from kinform.foundation.processes import Crash, cause_of

Ask = Callable[[bytes], bytes]
"""The answer of the parent to a question."""

HARMLESS = frozenset(("compile", "builtins.id"))
"""Events of Python that a confined process may cause: parsing, and the identity of an object. Running a code object
that was compiled is `exec`, which is not among them."""
REFUSED = 77
"""Exit code of a process that did what it may not do."""
MESSAGE_BYTES = 256 << 20
"""Of one question or answer: more is a process out of control. Chosen, not measured."""
_QUESTION, _ANSWER = b"?", b"="


class Confined(Crash):
    """The process was ended because it did what it may not do."""


def confined(
    function: Callable[[Ask], bytes],
    answer: Callable[[bytes], bytes],
    prepare: Callable[[], object],
    *,
    seconds: int,
    memory: int,
) -> bytes:
    """What `function(ask)` gives, in a process of its own; `answer` is called here with what it asks.

    `prepare` is called in that process before it is closed: for imports. It may take so many `seconds` of processor
    time, and so many bytes of `memory` more than this process has. Raises Crash where it ends without an answer,
    Confined where it did what it may not do, and what `answer` raises.
    """
    if not hasattr(os, "fork"):
        prepare()
        return function(answer)
    from_child, to_parent = os.pipe()
    from_parent, to_child = os.pipe()
    child = os.fork()
    if child == 0:
        _work(function, prepare, from_parent, to_parent, seconds, memory)
    os.close(to_parent)
    os.close(from_parent)
    try:
        with os.fdopen(from_child, "rb") as heard, os.fdopen(to_child, "wb", buffering=0) as said:
            out = _talk(heard, said, answer)
    except BaseException:
        _end(child)
        raise
    if out is not None:
        _end(child)
        return out
    status = _status(child)
    raise (Confined if os.waitstatus_to_exitcode(status) == REFUSED else Crash)(cause_of(status))


def _end(child: int) -> None:
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def _status(child: int) -> int:
    """Of a process that has closed its pipes; one that lives on a second later is ended."""
    for _ in range(100):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    return os.waitpid(child, 0)[1]


def _talk(heard: Any, said: Any, answer: Callable[[bytes], bytes]) -> bytes | None:
    """Answer until the process has said what its function gives; None where it ends before."""
    while (message := _heard(heard)) is not None:
        kind, body = message
        if kind == _ANSWER:
            return body
        reply = answer(body)
        left = memoryview(len(reply).to_bytes(8, "big") + reply)
        try:
            while left:
                left = left[said.write(left) :]
        except BrokenPipeError:
            return None
    return None


def _heard(stream: Any) -> tuple[bytes, bytes] | None:
    """The next message; None where there is no whole one."""
    head = stream.read(9)
    if len(head) < 9:
        return None
    size = int.from_bytes(head[1:], "big")
    if size > MESSAGE_BYTES:
        return None
    body = stream.read(size)
    return (head[:1], body) if len(body) == size else None


def _work(
    function: Callable[[Ask], bytes], prepare: Callable[[], object], hear: int, say: int, seconds: int, memory: int
) -> None:
    """In the fork: close it, run the function, say what it gives, and end without touching anything of the parent."""
    code = 1
    try:
        current_work.board = None  # what ends this process is told by who asked for it
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        prepare()
        heard, said = os.fdopen(hear, "rb"), os.fdopen(say, "wb")

        def tell(kind: bytes, body: bytes) -> None:
            said.write(kind + len(body).to_bytes(8, "big") + body)
            said.flush()

        def ask(question: bytes) -> bytes:
            tell(_QUESTION, question)
            size = int.from_bytes(heard.read(8), "big")
            return heard.read(size)

        signal.alarm(10 * seconds)  # of the clock: whoever waits takes no processor time
        _close(hear, say)
        _limit(seconds, memory)
        sys.addaudithook(_end_at_harm)
        tell(_ANSWER, function(ask))
        code = 0
    finally:
        os._exit(code)


def _end_at_harm(event: str, arguments: tuple[Any, ...]) -> None:
    if event not in HARMLESS:
        os._exit(REFUSED)


def _close(*kept: int) -> None:
    """Leave nothing open but these, and nothing in the environment."""
    os.environ.clear()
    nowhere = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(nowhere, standard)
    most = 3
    for folder in ("/proc/self/fd", "/dev/fd"):
        try:
            most = 1 + max(int(name) for name in os.listdir(folder))
            break
        except OSError:
            continue
    else:
        most = os.sysconf("SC_OPEN_MAX")
    start = 3
    for one in (*sorted(kept), most):
        os.closerange(start, one)
        start = one + 1


def _limit(seconds: int, memory: int) -> None:
    """No files, no processes; so much time and memory."""
    import resource

    limits = {"RLIMIT_CPU": seconds, "RLIMIT_AS": _taken() + memory, "RLIMIT_CORE": 0, "RLIMIT_FSIZE": 0,
              "RLIMIT_NPROC": 0, "RLIMIT_NOFILE": 0}  # fmt: skip
    for name, most in limits.items():
        kind = getattr(resource, name, None)
        if kind is None:
            continue
        _, hard = resource.getrlimit(kind)
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        try:
            resource.setrlimit(kind, (most, most))
        except (OSError, ValueError):  # macOS has no limit of the address space
            if name in ("RLIMIT_NOFILE", "RLIMIT_CPU"):
                raise


def _taken() -> int:
    """Bytes of address space of this process; 4 GB where the system does not say."""
    try:
        with open("/proc/self/statm", "rb") as stream:
            return int(stream.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError):
        return 4 << 30
