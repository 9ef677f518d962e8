"""Mutates seeds and runs a target on them in a process that may die, without any package.

The process writes each input where its parent can read it before it is run, and counts. Where it ends, or counts no
further, the input is a finding, and another process goes on behind it. The same seed gives the same inputs.
"""

from __future__ import annotations

import contextlib
import gc
import itertools
import mmap
import os
import random
import resource
import signal
import struct
import time
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from mutations import MOST, mutated
from targets import REFUSED, Target, cheaper

HANGS = 10.0
"""Seconds of processor time after which an input takes too long."""
STUCK = 120.0
"""Seconds of the clock after which native code that does not hear of it is ended."""
BEGINS = 600.0
"""Seconds within which the first seed is read: importing and deriving take long on a machine with other work."""
SLOW = 5.0
"""Seconds of processor time within which an input is refused: 2 s are promised, and other work on the machine slows."""
MEMORY = 1 << 30
"""Bytes that reading may take beside what the process has; an input that takes more is a finding."""
KEPT = 64
"""Inputs that were read and are mutated further, at most; each new one takes the place of another."""
FURTHER = 0.4
"""Share of inputs that are made of these; the others are made of seeds."""
SWEPT = 500
"""Inputs after which unreachable objects are looked for: seldom, since that takes long with all that is imported."""
_HEAD = struct.Struct("<QI")
"""Twice on the board: inputs done and size of the present one; inputs refused and whether the first seed is read."""


class Hang(Exception):
    """An input took too long."""


@dataclass
class Outcome:
    """What a run of a target came to."""

    name: str
    executions: int = 0
    refused: int = 0
    seconds: float = 0.0
    findings: dict[str, Path] = field(default_factory=dict)
    """By what happened: the input."""


def run(target: Target, folder: Path, *, runs: int | None, seconds: float | None, seed: int) -> Outcome:
    """Mutate and run until there were so many executions, or so many seconds."""
    folder.mkdir(parents=True, exist_ok=True)
    outcome, begun = Outcome(target.name), time.monotonic()
    end = begun + (seconds if seconds is not None else 1e9)
    board = mmap.mmap(-1, 2 * _HEAD.size + MOST)
    given = [data[:MOST] for data in target.seeds()]
    most = runs if runs is not None else 1 << 62
    while outcome.executions < most and time.monotonic() < end:
        _HEAD.pack_into(board, _HEAD.size, _HEAD.unpack_from(board, _HEAD.size)[0], 0)
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            _work(
                target,
                given,
                board,
                writing,
                random.Random(f"{seed} {outcome.executions}"),
                outcome.executions,
                most,
                end,
            )
        os.close(writing)
        status = _watch(child, board, reading, outcome, folder)
        done, size = _HEAD.unpack_from(board, 0)
        outcome.executions = done
        if status != 0:
            place = 2 * _HEAD.size
            _keep(outcome, folder, f"process ended: status {status}", board[place : place + size])
            outcome.executions += 1
    outcome.seconds = time.monotonic() - begun
    outcome.refused = _HEAD.unpack_from(board, _HEAD.size)[0]
    return outcome


def _work(
    target: Target,
    given: list[bytes],
    board: mmap.mmap,
    writing: int,
    rng: random.Random,
    done: int,
    most: int,
    end: float,
) -> None:
    """In the process: run inputs until enough are, and tell each finding through the pipe."""
    refused = _HEAD.unpack_from(board, _HEAD.size)[0]
    code = 0
    try:
        signal.signal(signal.SIGPROF, _hang)
        cheaper()
        warnings.simplefilter("error", RuntimeWarning)
        told: set[str] = set()
        with contextlib.suppress(Exception):
            target.run(given[0])  # imports and derives, which takes longer than any input may
        _HEAD.pack_into(board, _HEAD.size, refused, 1)
        _bound_memory()
        gc.collect()
        gc.freeze()
        gc.disable()
        kept: list[bytes] = []
        longest = 2 * max(map(len, given))
        while done < most and time.monotonic() < end:
            data = given[done] if done < len(given) else _next(target, given, kept, rng)
            place = 2 * _HEAD.size
            board[place : place + len(data)] = data
            _HEAD.pack_into(board, 0, done, len(data))
            what = attempt(target.run, data)
            if what == "refused":
                refused += 1
                _HEAD.pack_into(board, _HEAD.size, refused, 1)
            elif what and what not in told:
                told.add(what)
                text = what.encode()
                os.write(writing, struct.pack("<II", len(text), len(data)) + text + data)
            elif not what and len(data) <= longest:
                if len(kept) < KEPT:
                    kept.append(data)
                else:
                    kept[rng.randrange(KEPT)] = data
            done += 1
            _HEAD.pack_into(board, 0, done, 0)
            if done % SWEPT == 0:
                gc.collect()
    except BaseException:
        traceback.print_exc()
        code = 3
    finally:
        os._exit(code)


def _next(target: Target, given: list[bytes], kept: list[bytes], rng: random.Random) -> bytes:
    """Another input."""
    further = target.grammar is not None and kept and rng.random() < FURTHER
    return mutated(rng.choice(kept if further else given), given, target.words, target.grammar, rng)


def _bound_memory() -> None:
    """Let this process take no more than MEMORY."""
    pages = int(Path("/proc/self/statm").read_text().split()[0]) if Path("/proc/self/statm").exists() else None
    if pages is not None:
        resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MEMORY, resource.RLIM_INFINITY))


def attempt(function: Callable[[bytes], None], data: bytes) -> str:
    """ "" where the bytes were read, "refused", or what happened instead."""
    signal.setitimer(signal.ITIMER_PROF, HANGS)
    begun = time.process_time()
    try:
        function(data)
    except REFUSED as error:
        seconds = time.process_time() - begun
        return "refused" if seconds < SLOW else f"{where(error)}, after more than {SLOW:g} s"
    except Exception as error:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        return where(error)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    return ""


def where(error: BaseException) -> str:
    """An exception in a line: its type, the innermost place of ours, what it says."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "/kinform/" in f.filename]
    place = f"{Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else "?"
    return (
        f"{type(error).__name__} at {place}: {str(error)[:80]}"
        if place == "?"
        else f"{type(error).__name__} at {place}"
    )


def _hang(number: int, frame: object) -> None:
    raise Hang


def _watch(child: int, board: mmap.mmap, reading: int, outcome: Outcome, folder: Path) -> int:
    """Wait for the process, keeping what it tells; ends it where it is stuck. Returns its status."""
    os.set_blocking(reading, False)
    held, last, since = b"", -1, time.monotonic()
    while True:
        with contextlib.suppress(BlockingIOError):
            held += os.read(reading, 1 << 20)
        while len(held) >= 8 and len(held) >= 8 + sum(struct.unpack_from("<II", held)):
            text, data = struct.unpack_from("<II", held)
            _keep(outcome, folder, held[8 : 8 + text].decode(), held[8 + text : 8 + text + data])
            held = held[8 + text + data :]
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            if held:
                continue
            os.close(reading)
            return status
        done = _HEAD.unpack_from(board, 0)[0]
        if done != last:
            last, since = done, time.monotonic()
        elif time.monotonic() - since > (STUCK if _HEAD.unpack_from(board, _HEAD.size)[1] else BEGINS):
            os.kill(child, signal.SIGKILL)
        time.sleep(0.05)


def _keep(outcome: Outcome, folder: Path, what: str, data: bytes) -> None:
    """Keep the first input of each finding."""
    if what in outcome.findings and what.startswith("process ended") is False:
        return
    path = next(p for k in itertools.count() if not (p := folder / f"finding-{k:03d}").exists())
    path.write_bytes(data)
    path.with_suffix(".txt").write_text(what + "\n")
    key = what if what not in outcome.findings else f"{what} ({len(outcome.findings)})"
    outcome.findings[key] = path
    print(f"{outcome.name}: {what}: {path}", flush=True)
