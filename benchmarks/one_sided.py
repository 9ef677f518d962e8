"""Pairs that only push, with known motions: `python benchmarks/one_sided.py --cases 500`.

Each pair is at an end stop, under a lid, in a pocket, in a V, on three points or under a hook
(`fixtures/random_assemblies/one_sided.py`), 1 mm to 10 m across, with circles of 12 to 96 segments and gaps within the
contact tolerance. What the contact of the pair keeps (`Joint.at_rest`) must be within the span of its true motions, and
these within what the contact does not hold (`Joint.closed`), both to 2 %.

Prints a table by kind with the types and statuses that were found, and each case that is not in order with its seed.
"one sense" counts cases at rest with a motion that goes in one sense only: it is within the true ones, and in order.
Exit 1 where a case is out of order or crashes.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies.one_sided import KINDS, one_sided
from random_assemblies.one_sided_verdict import OUTCOMES, Verdict, joint_of, judge

from kinform import contacts, form, surfaces

COLUMNS = (*OUTCOMES, "crash")
OUT_OF_ORDER = ("at rest", "closed", "no joint", "crash")


@dataclass(frozen=True)
class Result:
    seed: int
    kind: str
    verdict: Verdict


def run_case(seed: int, kind: str) -> Result:
    """One pair through the geometric stages."""
    try:
        made = one_sided(seed, kind)
        with tempfile.TemporaryDirectory() as folder:
            assembly = form.load(made.case.write(Path(folder)))
        meshes = {part.mesh.digest: part.mesh for part in assembly.parts if part.mesh is not None}
        found = {key: surfaces.recover(mesh, assembly.tolerances) for key, mesh in meshes.items()}
        touching = contacts.find(assembly, found)
        verdict = judge(made, joint_of(assembly, found, touching), touching)
    except Exception as error:  # a crash is a result
        verdict = Verdict("crash", why=f"{type(error).__name__}: {error}")
    return Result(seed, kind, verdict)


def table(results: Sequence[Result]) -> None:
    """Outcomes, types and statuses by kind."""
    rows: dict[str, list[Result]] = defaultdict(list)
    for result in results:
        rows[result.kind].append(result)
    print(f"\n{'':16s}{'cases':>7s}" + "".join(f"{name:>10s}" for name in (*COLUMNS, "one sense")) + "  found")
    for kind, some in [*rows.items(), ("all", list(results))]:
        counts = Counter(result.verdict.outcome for result in some)
        counts["one sense"] = sum(result.verdict.one_sense for result in some)
        cells = "".join(f"{counts[name] or '':>10}" for name in (*COLUMNS, "one sense"))
        found = Counter(result.verdict.found for result in some if result.verdict.found)
        words = ", ".join(f"{name} {count}" for name, count in found.most_common()) if kind != "all" else ""
        print(f"{kind:16s}{len(some):>7d}{cells}  {words}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=50, help="of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--seeds", type=int, nargs="+", help="these seeds only")
    parser.add_argument("--kind", choices=tuple(KINDS), nargs="+", default=list(KINDS))
    parser.add_argument("--minutes", type=float, help="start no case after so long")
    arguments = parser.parse_args()
    seeds = arguments.seeds or range(arguments.first, arguments.first + arguments.cases)
    until = None if arguments.minutes is None else time.monotonic() + 60.0 * arguments.minutes
    results = []
    for seed in seeds:
        if until is not None and time.monotonic() > until:
            break
        for kind in arguments.kind:
            results.append(result := run_case(seed, kind))
            if result.verdict.outcome != "in order":
                print(f"{seed:6d} {kind}: {result.verdict.outcome}: {result.verdict.why}", flush=True)
    table(results)
    return int(any(result.verdict.outcome in OUT_OF_ORDER for result in results))


if __name__ == "__main__":
    sys.exit(main())
