"""Rows of the table that `python benchmarks/all.py` prints: what a benchmark measured, beside its aim and its floor.

A benchmark takes part when it has a function `rows(quick)` that yields `Row`s, and its name stands in `all.MODULES`.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """One measurement."""

    what: str
    value: float
    aim: float | None = None
    """The most that it should be, in the same unit; None where there is no aim."""
    unit: str = "s"
    """Seconds are of the processor, of all threads, unless the words say otherwise."""
    beside: str = ""
    """Its floor, or whatever it is to be compared with, measured in the same run."""
    megabytes: float | None = None
    """The greatest memory of the process so far."""


def peak() -> float:
    """The greatest memory of this process, or of the greatest that it has waited for (MB)."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return max(resource.getrusage(kind).ru_maxrss for kind in kinds) / (1e6 if sys.platform == "darwin" else 1024.0)


def processor(work: Callable[[], Any], repeats: int = 1) -> tuple[float, Any]:
    """(least seconds of the processor over the repeats, result)."""
    best, result = float("inf"), None
    for _ in range(repeats):
        start = time.process_time()
        result = work()
        best = min(best, time.process_time() - start)
    return best, result


def line(row: Row) -> str:
    """The row as the table has it."""
    aim = "" if row.aim is None else f"{row.aim:g}"
    met = "" if row.aim is None else ("yes" if row.value <= row.aim else "NO")
    memory = "" if row.megabytes is None else f"{row.megabytes:,.0f}"
    return f"{row.what:58s}{row.value:>10.3g} {row.unit:14s}{aim:>8s} {met:4s}{memory:>7s}  {row.beside}".rstrip()


HEADER = f"{'':58s}{'measured':>10s} {'':14s}{'aim':>8s} {'met':4s}{'MB':>7s}  beside"


def show(rows: Iterable[Row]) -> None:
    """Print them as a table, each as soon as it is known."""
    print(HEADER)
    for row in rows:
        print(line(row), flush=True)
