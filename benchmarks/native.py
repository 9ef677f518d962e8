"""The compiled kernel by bare addresses (`kernel/native.py`) beside ordinary signatures: python benchmarks/native.py

Ordinary: the same functions, with tuples of two-dimensional arrays, jitted with explicit signatures in the order of
their calls, with the same options. Each way in processes of its own with a cache of its own: first compiling, then
from the cache (processor seconds of the whole process, interpreter and numba included), and microseconds of one
evaluation of the equations of motion: of ten four-bars, and of a chain of 200 links.
"""

from __future__ import annotations

import inspect
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "tests")]

from support.port_models import DOWN, chain, four_bars  # noqa: E402
from table import Row, peak, show  # noqa: E402

WAYS = ("addresses", "arrays")
GAIN = 2.0
"""By addresses stays for a gain of more than this."""


def ordinary():
    """The unit `derivative`, with all that it calls, and `advance`, compiled for arrays."""
    import numba

    from kinform.simulation.kernel import compiled
    from kinform.simulation.kernel.native import Table  # noqa: F401  its templates are numba's in both ways

    whole, real, types = numba.types.int64, numba.types.float64, numba.types
    table, index = types.Array(real, 2, "C"), types.Array(whole, 2, "C")
    kinds = {
        "int": whole, "float": real, "bool": types.boolean, "None": types.none, "Row": types.Array(real, 1, "C"),
        "Counts": types.Array(whole, 1, "C"), "Table": table, "Index": index, "Ints": types.UniTuple(index, 10),
        "Nums": types.UniTuple(table, 12), "Work": types.UniTuple(table, 12),
    }  # fmt: skip
    copy, made = compiled._Copy(), {}
    config = numba.config
    config.OPT = type(config.OPT)(1)
    config.LOOP_VECTORIZE = config.SLP_VECTORIZE = 0
    options = {"nopython": True, "error_model": "numpy", "no_rewrites": True}
    for module in compiled._MODULES:
        for name, function in list(vars(module).items()):
            if not inspect.isfunction(function) or function.__module__ != module.__name__:
                continue
            taken = tuple(kinds[given.annotation] for given in inspect.signature(function).parameters.values())
            if name in ("advance", "pass_through"):
                # outputs are a pair of tables
                taken = (*taken[:-1], types.UniTuple(table, 2))
            keep = function in compiled._UNITS
            made[name] = numba.jit(taken, cache=keep, **options)(copy.of(function, "ordinary"))
            copy.mean(function, made[name])
    return made["derivative"]


def evaluated(evaluate, tables, y, way):
    """Microseconds of one evaluation."""
    slopes, count = np.zeros_like(y), 0
    nums = tuple(np.array(table) for table in tables.nums)  # all may be written to: one type
    start = time.process_time()
    while time.process_time() - start < 0.3:
        for _ in range(20):
            if way == "arrays":
                evaluate(tables.ints, nums, tables.work, 0.0, y, slopes)
            else:
                evaluate.call("derivative", tables, 0.0, y, slopes)
        count += 20
    return (time.process_time() - start) / count * 1e6


def one(way: str) -> None:
    """Load one way, and time it; a line of JSON."""
    from kinform.simulation import Course, simulate_system
    from kinform.simulation.kernel.calls import engine
    from kinform.simulation.solver.run_state import Run

    evaluate = ordinary() if way == "arrays" else engine(compiled=True, articulated_bodies=True)
    loaded = time.process_time()
    out = {"loaded": loaded}
    begin, runs = Run.begin, []
    Run.begin = lambda run: runs.append(run) or begin(run)
    for name, model in (("ten four-bars", four_bars(10)), ("200 links", chain(200))):
        simulate_system(model.system(), Course(1e-6, 1e-6, DOWN))
        run = runs[-1]
        out[name] = evaluated(evaluate, run.dynamics.tables, run.y.copy(), way)
    print(json.dumps(out))


def rows(quick: bool) -> Iterator[Row]:
    found = {}
    with tempfile.TemporaryDirectory() as scratch:
        for way in WAYS:
            environment = os.environ | {
                "XDG_CACHE_HOME": str(Path(scratch) / way),
                "NUMBA_CACHE_DIR": str(Path(scratch) / way),
            }
            command = [sys.executable, __file__, "--one", way]
            found[way] = [
                json.loads(subprocess.run(command, capture_output=True, text=True, check=True, env=environment).stdout)
                for _ in range(2)
            ]
    (cold, cached), (plain_cold, plain_cached) = (found[way] for way in WAYS)
    for what, ours, theirs, unit, aim in (
        ("kernel compiled afresh", cold["loaded"], plain_cold["loaded"], "s", 8.0),
        ("kernel from the cache", cached["loaded"], plain_cached["loaded"], "s", None),
        ("one evaluation, ten four-bars", cached["ten four-bars"], plain_cached["ten four-bars"], "µs", None),
        ("one evaluation, 200 links", cached["200 links"], plain_cached["200 links"], "µs", None),
    ):
        words = f"ordinary signatures: {theirs:.3g} {unit}, {theirs / ours:.2f} times"
        yield Row(what, ours, aim, unit, words, peak())


def main(arguments: list[str]) -> None:
    show(rows("--quick" in arguments))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(sys.argv[2])
    else:
        main(sys.argv[1:])
