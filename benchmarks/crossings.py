"""Whether crossing singular poses hangs on last bits: `python benchmarks/crossings.py [RUNS]` (default 100 of each).

2, 10 and 40 four-bars in a row pass their flat pose seven times in 10 s. Each run starts off by 1e-15 to 1e-12, and its
hinges are off by their rounding. Prints how many came to their end with the motion that a pendulum of the same inertia
has (`tests/support/crossings.py` says within what), and the greatest errors; exit code 1 where any did not.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "tests")]

from support.crossings import WITHIN, perturbed_run  # noqa: E402

from kinform.simulation.kernel.calls import engine  # noqa: E402


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    engine(compiled=True)
    failed = 0
    for bars in (2, 10, 40):
        begin, good, worst = time.process_time(), 0, (0.0, 0.0)
        for seed in range(count):
            run, angle, rate = perturbed_run(bars, seed)
            if run.status == "done" and angle < WITHIN[0] and rate < WITHIN[1]:
                good += 1
            else:
                print(f"{bars} four-bars, seed {seed}: {run.status} {run.reason} {angle:.1e} rad {rate:.1e} rad/s")
            worst = max(worst[0], angle), max(worst[1], rate)
        failed += count - good
        spent = time.process_time() - begin
        print(
            f"{bars:3} four-bars: {good} of {count} pass with the same motion; worst {worst[0]:.1e} rad, "
            f"{worst[1]:.1e} rad/s; {spent:.0f} s",
            flush=True,
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
