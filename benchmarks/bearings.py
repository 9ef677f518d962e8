"""Bearings whose rolling elements are parts: `python benchmarks/bearings.py [--kinds NAME ...] [--draws 3]`.

Every kind of `tests/support/bearings.py` at random poses, at three scales, in several tessellations, with and without
play. For each: what contact says of the joint of ring and shaft where the function states the right one, and whether
one that is not right is agreed with. Prints a row a case that is not right, and a table by kind: agrees (the right
joint), undecided, FALSE (an error of a function that is right), WRONG (a joint agreed with that is not right).
Exit 0: nothing FALSE or WRONG.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "tests"), str(ROOT / "fixtures")]

from support.bearings import KINDS, Size, answers_of  # noqa: E402

SCALES = (1e-4, 1e-3, 0.1)
PLAYS = (0.0, 0.002, 0.03)
"""Of the radius of the elements."""
OUTCOMES = ("agrees", "undecided", "FALSE", "WRONG")


def sizes(draws: int, counts: list[int]) -> Iterator[tuple[Size, float, int]]:
    """Sizes, with a scale and a seed of the pose."""
    rng = np.random.default_rng(20261)
    for draw in range(draws):
        for count in counts:
            element = float(rng.uniform(1.0, 2.5))
            # no two elements touch
            room = 1.25 * element / np.sin(np.pi / count) - element
            shaft = float(max(rng.uniform(5.0, 12.0), room))
            size = Size(
                count, shaft, element, float(rng.uniform(6.0, 14.0)), PLAYS[draw % 3] * element,
                int(rng.integers(48, 130)), int(rng.integers(24, 60)), float(rng.uniform(0.0, 90.0)),
            )  # fmt: skip
            yield size, SCALES[int(rng.integers(3))], int(rng.integers(1000))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), metavar="NAME")
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--counts", type=int, nargs="+", default=[3, 5, 8, 12])
    arguments = parser.parse_args()
    counts: dict[str, Counter[str]] = {}
    for kind in arguments.kinds:
        counts[kind] = Counter()
        for size, scale, seed in sizes(arguments.draws, arguments.counts):
            bearing = KINDS[kind](size)
            outcome, why = answers_of(bearing, np.random.default_rng(seed), scale).outcome()
            counts[kind][outcome] += 1
            if outcome != "agrees":
                shown = replace(size, shaft=round(size.shaft, 2), element=round(size.element, 2))
                print(f"{kind}: {outcome}: {why} [scale {scale:g}, pose {seed}, {shown}]", flush=True)
    print(f"\n{'':32s}" + "".join(f"{name:>11s}" for name in OUTCOMES))
    for kind, of_kind in counts.items():
        print(f"{kind:32s}" + "".join(f"{of_kind[name] or '':>11}" for name in OUTCOMES))
    return int(any(of_kind[name] for of_kind in counts.values() for name in ("FALSE", "WRONG")))


if __name__ == "__main__":
    sys.exit(main())
