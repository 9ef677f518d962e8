"""Bodies from function on random machines of bolted stacks, bearings, pins and horns: `python benchmarks/machines.py`.

Each joint names any part of either side at random. Exact: every part is in its body, but for pins, bushes, balls and
cages, which may be in either of two, and the mobility is the number of joints. Fused: two bodies are one. Silent: a
part in the wrong body is not listed as one that could go either way. Proposed: joints that would be proposed without
function. `--rings`: four-bars of such decks instead, with cages in their bearings, whose mobility is 1. `--largest`:
their joints name the largest part of either side. `--sides 1`: joints name one side only, `--sides 0` none; where it is
not clear what they part, which is an error that lists the ways, it counts as asked. `--size 0.001`: each so large (m),
else 0.1 to 10 mm a unit at random.
`--parts 1000` instead derives one chain of decks of about so many parts, and prints the row of each of its stages.
Exit 0: at least 99 % exact or asked, none fused.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies.draw import Draw
from random_assemblies.machine_verdict import assembly_of, judge
from random_assemblies.machines import machine
from random_assemblies.rings import ring
from table import Row, peak, processor, show

from kinform import collisions, contacts, kinematics, surfaces
from kinform.errors import OpenSidesError
from kinform.kinematics import propose
from kinform.kinematics.partition import Proposal, partition
from kinform.model.function import IntendedJoint

PAIR = 4.0
"""Aim of contacts (ms a pair)."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--first", type=int, default=10_000)
    parser.add_argument("--parts", type=int)
    parser.add_argument("--rings", action="store_true")
    parser.add_argument("--largest", action="store_true")
    parser.add_argument("--sides", type=int, choices=(0, 1, 2), default=2)
    parser.add_argument("--size", type=float, help="m, of each machine's box; else at random")
    options = parser.parse_args()
    if not options.parts:
        return cases(options)
    show(row for _, row in large(options.parts))
    return 0


def cases(options: argparse.Namespace) -> int:
    """All cases, and what came of them."""
    first, count = options.first, options.cases
    exact = fused = silent = asked = joints = hit = proposed = true = 0
    for seed in range(first, first + count):
        made = ring(Draw([seed]), options.largest) if options.rings else machine(Draw([seed]))
        assembly = assembly_of(made, seed, options.size, options.sides)
        found = {p.mesh.digest: surfaces.recover(p.mesh, assembly.tolerances) for p in assembly.parts if p.mesh}
        touching = contacts.find(assembly, found)
        try:
            verdict = judge(made, kinematics.derive(assembly, found, touching))
        except OpenSidesError:
            asked += 1
        else:
            exact += verdict.exact
            fused += verdict.fused
            silent += bool(verdict.silent)
            if not verdict.exact:
                print(f"{seed}: {verdict}")
        ways = propose(assembly, found, touching)
        hits = [[j.name for j in assembly.function.joints if _on(way, j)] for way in ways]
        joints += len(made.joints)
        proposed += len(ways)
        true += sum(bool(names) for names in hits)
        hit += len({name for names in hits for name in names})
    asked_ = f", asked {asked}" if options.sides < 2 else ""
    print(f"exact {exact} of {count}{asked_}, fused {fused}, silent {silent}")
    print(f"joints proposed without function: {hit} of {joints}; true {true} of {proposed}")
    return 0 if exact + asked >= 0.99 * count and not fused else 1


def _on(way: Proposal, joint: IntendedJoint) -> bool:
    if way.axis is None or joint.point is None or joint.axis is None:
        return False
    gap = way.point - joint.point
    off = float(((gap - (gap @ way.axis) * way.axis) ** 2).sum()) ** 0.5
    return abs(float(way.axis @ joint.axis)) > 0.9998 and off < 1e-6


def large(parts: int) -> Iterator[tuple[str, Row]]:
    """(stage, row) of one long chain of decks: contacts, bodies from function, all of kinematics, ranges by default."""
    made = machine(Draw([1]), decks=max(2, parts // 9))
    assembly = assembly_of(made, 1)
    what = f"chain of decks, {len(assembly.parts)} parts"
    found = {p.mesh.digest: surfaces.recover(p.mesh, assembly.tolerances) for p in assembly.parts if p.mesh}
    seconds, touching = processor(lambda: contacts.find(assembly, found))
    pairs = len(touching.candidates)
    words = f"{seconds:.2f} s, {pairs} pairs, {len(touching.patches)} patches"
    yield "contacts", Row(f"contacts of a {what}", 1e3 * seconds / pairs, PAIR, "ms a pair", words, peak())
    seconds, bodies = processor(lambda: partition(assembly, touching, assembly.function.joints, found))
    words = f"{len(made.joints)} joints, {len(bodies.names)} bodies"
    yield "bodies", Row(f"bodies from function of a {what}", seconds, None, "s", words, peak())
    seconds, derived = processor(lambda: kinematics.derive(assembly, found, touching))
    yield "kinematics", Row(f"all of kinematics of a {what}", seconds, None, "s", "the bodies among it", peak())
    seconds, reach = processor(lambda: collisions.ranges(assembly, found, touching, derived))
    words = f"{sum(end.status == 'found' for item in reach for end in (item.lower, item.upper))} ends found"
    yield "ranges", Row(f"ranges of a {what}", seconds, None, "s", words, peak())


def rows(quick: bool) -> Iterator[Row]:
    """The rows of chains of decks of some sizes, and how each stage grows with their parts."""
    sizes = (36, 72) if quick else (100, 200, 400, 800)
    took: dict[str, list[float]] = {}
    for size in sizes:
        for stage, row in large(size):
            took.setdefault(stage, []).append(row.value)
            yield row
    for stage, seconds in took.items():
        power = float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0]) + (stage == "contacts")
        yield Row(f"chain of decks: {stage} grow with parts to the power", power, None, "")


if __name__ == "__main__":
    sys.exit(main())
