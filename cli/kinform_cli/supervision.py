"""The command works in a process of its own, and this one watches it: so Ctrl-C is heard also while native code is at
work, which Python does not interrupt, and a crash of native code ends in words and an exit code.

The process that the user started waits for nothing but signals. On Ctrl-C, SIGTERM and SIGHUP it passes Ctrl-C on; who
has not ended after a moment is ended. After these, and after a crash, it also ends every process that the work started,
in any depth: orphans become children of this process. Where the user's process is killed the other goes with it: the
system sees to that. It is so on Linux; elsewhere the command works in the process that was started, and native code is
deaf for as long as it takes.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
import time
from typing import NoReturn

GRACE = 1.5
"""Seconds after a request to end in which the work may end by itself, with its own words; the promise is two."""


board: mmap.mmap | None = None
"""Where the process that does the work notes what native code is at work on (`kinform.foundation.current_work`)."""


_left = mmap.mmap(-1, 1)
"""1 where the command has started something that may outlive it, such as a browser."""


def leave_children() -> None:
    """Do not end what this command starts from now on, however it ends itself: a browser is the user's."""
    _left[0] = 1


def divide() -> None:
    """Returns in a new process, which does the work; this one ends with what that one ends with."""
    global board
    if sys.platform != "linux":
        return
    board = mmap.mmap(-1, mmap.PAGESIZE)
    awaited = {signal.SIGCHLD}
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as in the background of a shell, or by nohup: it stays so
            awaited.add(number)
    before = signal.pthread_sigmask(signal.SIG_BLOCK, awaited)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    watching = os.getpid()
    try:
        worker = os.fork()
    except OSError:  # no more processes are allowed: then without
        worker = 0
    if worker:
        _watch(worker, awaited)
    if os.getpid() != watching:
        from kinform.foundation.parent_death import exit_with_parent  # what the watching process does without

        exit_with_parent(watching)
    signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _watch(worker: int, awaited: set[signal.Signals]) -> NoReturn:
    """Wait until the worker has ended, and end as it did; never later than a moment after a request to end."""
    from kinform_cli import orphans

    orphans.adopt()
    asked: float | None = None
    request = signal.SIGINT
    while True:
        ended, status = _ended(worker)
        if ended:
            if asked is None and (late := signal.sigtimedwait(awaited - {signal.SIGCHLD}, 0)) is not None:
                asked, request = time.monotonic(), signal.Signals(late.si_signo)  # sent to both processes at once
            code = _code(status, asked is not None)
            if (asked is not None or os.WIFSIGNALED(status)) and not _left[0]:
                orphans.end_all()
            if request != signal.SIGINT:
                signal.signal(request, signal.SIG_DFL)
                signal.pthread_sigmask(signal.SIG_UNBLOCK, {request})
                os.kill(os.getpid(), request)  # as without a watching process; the first process of a container goes on
                code = 128 + request
            os._exit(code)
        if asked is None:
            heard: signal.struct_siginfo | None = signal.sigwaitinfo(awaited)
        else:
            left = asked + GRACE - time.monotonic()
            if left <= 0:
                os.kill(worker, signal.SIGKILL)
            heard = signal.sigtimedwait(awaited, max(left, GRACE / 10))
        if heard is not None and heard.si_signo != signal.SIGCHLD and asked is None:
            asked, request = time.monotonic(), signal.Signals(heard.si_signo)
            os.kill(worker, signal.SIGINT)


def _ended(worker: int) -> tuple[bool, int]:
    """Whether the worker has ended, and its exit status. Adopted children that have ended are collected too."""
    while True:
        try:
            child, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return True, signal.SIGKILL
        if child in (0, worker):
            return child == worker, status


def _code(status: int, asked: bool) -> int:
    """The exit code that is due, after words for an end that the worker could not find words for."""
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        return code
    if asked:
        _tell("interrupted; an output file that existed is as it was")
    elif -code in (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP):
        _tell("killed from outside, or for want of memory; an output file that existed is as it was")
    else:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = "unknown"
        _tell(
            f"native code crashed (signal {-code}, {name}){_subject()}; an output file that existed is as it was\n"
            "  remedy: run it again with KINFORM_DEBUG=1 to see where, and report it with its input"
        )
    return 2


def _subject() -> str:
    """Of which parts native code was at work, where that was noted."""
    if board is None:
        return ""
    length = int.from_bytes(board[:2], "little")
    text = board[2 : 2 + length].decode("utf-8", "replace")
    return f" at work on {''.join(c if c.isprintable() else '?' for c in text)}" if text else ""


def _tell(text: str) -> None:
    """A message, by the means of a process that has imported nothing."""
    try:
        os.write(2, f"kinform: error: {text}\n".encode())
    except OSError:
        return
