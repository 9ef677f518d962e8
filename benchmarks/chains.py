"""Dynamics of many links: `python benchmarks/chains.py [--quick]`.

0.1 s of motion under gravity of rods hinged in a row: hanging from one end (`open`, horizontal at the start), from
both (`loop`, along a half circle), and four-bars side by side (`bars`, upright). Processor seconds of all that
`simulate` does (mechanism, rank, solver, reactions and their check), compiled functions loaded before; and of the
solver alone. Beside: MuJoCo, RK4 with steps of 1 ms, where it is installed, its integration alone.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "tests")]

from dynamics import mujoco_timed  # noqa: E402
from support.port_models import DOWN, chain, four_bars  # noqa: E402
from table import Row, peak, processor, show  # noqa: E402

from kinform.simulation import Course, simulate_system  # noqa: E402
from kinform.simulation.kernel.calls import engine  # noqa: E402
from kinform.simulation.solver.run_state import Run  # noqa: E402

SIZES = (25, 50, 100, 200, 400)
KINDS = {"open": chain, "loop": lambda n: chain(n, held=True), "bars": lambda n: four_bars(n // 2)}
AIMS = {200: 0.5}
DURATION = 0.1


def measured(system):
    """(seconds of all, seconds of the solver, run) of the motion."""
    advance, spent = Run.advance, [0.0]

    def timed(run):
        start = time.process_time()
        status = advance(run)
        spent[0] += time.process_time() - start
        return status

    Run.advance = timed
    try:
        seconds, run = processor(lambda: simulate_system(system, Course(DURATION, DURATION / 10, DOWN)))
    finally:
        Run.advance = advance
    return seconds, spent[0], run


def beside(kind, system, run):
    """MuJoCo's time, and where it has the end of the chain, in words."""
    try:
        import mujoco  # noqa: F401
    except ImportError:
        return ""
    if kind != "open":
        return ""
    last = run.body_names[-1]
    spent, place = mujoco_timed(system, DOWN, {}, (last, np.zeros(3)), DURATION, "RK4", 1e-3)
    apart = np.abs(place - run.p_WB[-1, -1]).max()
    return f"; MuJoCo {spent * DURATION / 1e3:.3f} s, {apart:.0e} m apart"


def rows(quick: bool) -> Iterator[Row]:
    engine(compiled=True, articulated_bodies=True)
    for kind, make in KINDS.items():
        sizes, times = SIZES[1:4] if quick else SIZES, []
        for n in sizes:
            system = make(n).system()
            measured(system)
            seconds, solver, run = measured(system)
            if run.status != "done":
                raise RuntimeError(f"{kind} {n}: {run.status}")
            times.append(seconds)
            words = f"solver alone {solver:.3f} s{beside(kind, system, run)}"
            yield Row(f"dynamics, {n} links, {kind}, 0.1 s", seconds, AIMS.get(n), beside=words, megabytes=peak())
        power = np.polyfit(np.log(sizes), np.log(times), 1)[0]
        yield Row(f"dynamics, {kind}: grows with links to the power", power, unit="")


def main(arguments: list[str]) -> None:
    show(rows("--quick" in arguments))


if __name__ == "__main__":
    main(sys.argv[1:])
