"""Finding designs among many by what they do: `python benchmarks/catalog.py [--designs 100000]`.

A catalog of synthetic entries (chains and loops of up to eight joints, four types, sizes from 1 mm to 10 m) is written,
and asked as the command asks; times are of the answer with its entries, the best of three.
"""

from __future__ import annotations

import argparse
import random
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from kinform import catalog
from kinform.catalog.entry import CatalogJoint, Entry, graph_of

TYPES = ("revolute", "prismatic", "cylindrical", "spherical")
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.8, 0.0))


def entry(k: int) -> Entry:
    """The design of this number."""
    draw = random.Random(k)
    count, size = draw.randint(1, 8), 10 ** draw.uniform(-3, 1)
    loop = count > 2 and draw.random() < 0.3
    bodies = count if loop else count + 1
    edges = [(draw.choice(TYPES), j, (j + 1) % bodies) for j in range(count)]
    joints = tuple(
        CatalogJoint(f"b{a}~b{b}", kind, "determined", 1, draw.choice(AXES),
                     (size * draw.random(), size * draw.random(), 0.0), None, None, None, f"j{j}", None, None)
        for j, (kind, a, b) in enumerate(edges)
    )  # fmt: skip
    graph = graph_of([j == 0 for j in range(bodies)], edges)
    return Entry(
        f"designs/d{k:06d}.h5", f"{k:064x}", f"design {k}", "mm", tuple(f"p{j}" for j in range(bodies)), bodies, count,
        None, max(count - 5 * loop, 0), 0, int(loop), draw.uniform(0.01, 100.0), (size, size / 2, size / 3), "verified",
        joints, (), graph,
    )  # fmt: skip


def best(function: Callable[[], object]) -> tuple[float, object]:
    """The shortest of three times (s), and the answer."""
    times = []
    for _ in range(3):
        began = time.perf_counter()
        answer = function()
        times.append(time.perf_counter() - began)
    return min(times), answer


def main() -> None:
    """Print a line a question."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=100_000)
    many = parser.parse_args().designs
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "catalog.sqlite"
        entries = tuple(entry(k) for k in range(many))
        began = time.perf_counter()
        catalog.write(catalog.Catalog((), entries), file)
        print(f"{many} designs written in {time.perf_counter() - began:.1f} s, {file.stat().st_size / 1e6:.0f} MB")
        questions = {
            "6 revolute, mobility 6": catalog.Wanted((catalog.joint_count("revolute:6"),), mobility=6),
            "7+ prismatic, at most 50 mm": catalog.Wanted((catalog.joint_count("prismatic:7+"),), greatest_size=0.05),
            "loop, mobility 3, at most 1 kg": catalog.Wanted(mobility=3, loops=1, greatest_mass=1.0),
            "named 'design 4711'": catalog.Wanted(text=("design 4711",)),
        }
        for words, wanted in questions.items():
            seconds, (found, _) = best(lambda wanted=wanted: catalog.find(file, wanted))
            print(f"{words}: {len(found)} found in {1000 * seconds:.0f} ms")
        seconds, (near, _) = best(lambda: catalog.like(file, entries[4711]))
        print(f"like design 4711: {len(near)} found in {1000 * seconds:.0f} ms, nearest {near[0][1].name}")


if __name__ == "__main__":
    main()
