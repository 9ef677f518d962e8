"""Bodies from function on random machines of bolted stacks, bearings, pins and horns: `python benchmarks/machines.py`.

Each joint names any part of either side at random. Exact: every part is in its body, but for pins, bushes, balls and
cages, which may be in either of two, and the mobility is the number of joints. Fused: two bodies are one. Silent: a
part in the wrong body is not listed as one that could go either way. Proposed: joints that would be proposed without
function. `--rings`: four-bars of such decks instead, with cages in their bearings, whose mobility is 1. `--largest`:
their joints name the largest part of either side. `--sides 1`: joints name one side only, `--sides 0` none; where it is
not clear what they part, which is an error that lists the ways, it counts as asked. `--size 0.001`: each so large (m),
else 0.1 to 10 mm a unit at random.
`--parts 1000` instead derives one chain of about so many parts, and prints how long contacts and bodies take.
Exit 0: at least 99 % exact or asked, none fused.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies.draw import Draw
from random_assemblies.machine_verdict import assembly_of, judge
from random_assemblies.machines import machine
from random_assemblies.rings import ring

from kinform import contacts, kinematics, surfaces
from kinform.errors import OpenSidesError
from kinform.kinematics import propose
from kinform.kinematics.partition import Proposal, partition
from kinform.model.function import IntendedJoint


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
    return large(options.parts) if options.parts else cases(options)


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


def large(parts: int) -> int:
    """One long chain of decks."""
    made = machine(Draw([1]), decks=max(2, parts // 9))
    assembly = assembly_of(made, 1)
    found = {p.mesh.digest: surfaces.recover(p.mesh, assembly.tolerances) for p in assembly.parts if p.mesh}
    begun = time.perf_counter()
    touching = contacts.find(assembly, found)
    between = time.perf_counter()
    bodies = partition(assembly, touching, assembly.function.joints, found)
    done = time.perf_counter()
    print(f"{len(assembly.parts)} parts, {len(made.joints)} joints, {len(bodies.names)} bodies")
    first, second = between - begun, done - between
    print(f"contacts {first:.1f} s, bodies {second:.1f} s, ratio {second / first:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
