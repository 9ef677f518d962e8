"""Random assemblies with known answers, through the whole geometric part: `python benchmarks/sweep.py --cases 2000`.

Sizes are 1 mm to 100 m. Two in five cases are OBJ in doubles, most of these up to 100 km from the origin, the rest
float32 near it; every fourth has noise on its vertices, up to a thousandth of the part, and some have circles of 7 to
11 segments. `--plain` leaves all that out.

Prints a table by family and kind (right, ambiguous, honest, …), one by size, noise and kind of file, the time of each
stage, and every case that is not right with its seed and one line on why. `--write FOLDER` keeps those cases as
manifests with meshes and truth. Exit 0: nothing wrong, false or fused, no crash, and of the cases that have neither
noise nor coarse circles nothing loose, and at most 1 % short of right.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies import FAMILIES, OPTIONAL, Wear, case
from random_assemblies.verdict import OUTCOMES, Verdict, judge

from kinform import contacts, form, kinematics, surfaces

Work = tuple[int, str | None, str | None, Wear]
STAGES = ("form", "surfaces", "contacts", "joints")


@dataclass(frozen=True)
class Result:
    seed: int
    kind: str
    size: float
    facets: int
    wear: Wear
    verdict: Verdict
    seconds: tuple[float, ...]


def run_case(seed: int, family: str | None, kind: str | None, wear: Wear) -> Result:
    """One case through the stages, in a folder of its own."""
    made = case(seed, family, kind, wear)
    ticks = [time.perf_counter()]
    with tempfile.TemporaryDirectory() as folder:
        try:
            path = made.write(Path(folder))
            ticks = [time.perf_counter()]
            assembly = form.load(path)
            ticks.append(time.perf_counter())
            meshes = {part.mesh.digest: part.mesh for part in assembly.parts if part.mesh is not None}
            found = {key: surfaces.recover(mesh, assembly.tolerances) for key, mesh in meshes.items()}
            ticks.append(time.perf_counter())
            touching = contacts.find(assembly, found)
            ticks.append(time.perf_counter())
            verdict = judge(made, kinematics.derive(assembly, found, touching))
            ticks.append(time.perf_counter())
        except Exception as error:  # a crash is a result of the sweep
            verdict = Verdict("crash", f"{type(error).__name__}: {error}")
    seconds = tuple(b - a for a, b in zip(ticks, ticks[1:], strict=False))
    return Result(seed, made.kind, made.size, made.facets, wear, verdict, seconds)


def run_all(work: list[Work], jobs: int) -> Iterator[Result]:
    """All cases in order. A worker that dies is a crash of its case (with several jobs: of that or a later one)."""
    while work:
        with ProcessPoolExecutor(jobs) as pool:
            futures = [pool.submit(run_case, *one) for one in work]
            for number, (one, future) in enumerate(zip(work, futures, strict=True)):
                try:
                    yield future.result()
                except BrokenProcessPool:
                    made = case(*one)
                    lost = Verdict("crash", "the process was killed: out of memory?")
                    yield Result(one[0], made.kind, made.size, made.facets, made.wear, lost, ())
                    work = work[number + 1 :]
                    break
            else:
                return


def kinds_of(result: Result) -> set[str]:
    """The rows of the first table that a case counts in: its family and its kind."""
    family = result.kind.partition("/")[0]
    return {family, "chain/…" if family == "chain" else result.kind}


def circumstances_of(result: Result) -> set[str]:
    """The rows of the second table: size, noise, kind of file and distance."""
    wear, decade = result.wear, math.floor(math.log10(result.size))
    noise = "none" if not wear.noise else "below 1e-4 of the part" if wear.noise < 1e-4 else "up to 1e-3 of the part"
    far = "near the origin" if not wear.far else "up to 1 km away" if wear.far < 1e3 else "up to 100 km away"
    rows = {f"size {10.0**decade:g} to {10.0 ** (decade + 1):g} m", f"file {wear.files}, {far}"}
    rows |= {f"noise {noise}"} if not wear.coarse else set()
    return rows | ({"coarse circles"} if wear.coarse else {"neither noise nor coarse"} if wear.clean else set())


def table(results: list[Result], rows_of: Callable[[Result], set[str]]) -> None:
    """Counts of outcomes by row."""
    rows: dict[str, Counter[str]] = defaultdict(Counter)
    for result in results:
        for row in rows_of(result) | {"~"}:
            rows[row][result.verdict.outcome] += 1
    print(f"\n{'':34s}" + "".join(f"{name:>10s}" for name in ("cases", *OUTCOMES)))
    for row in sorted(rows):
        counts = [rows[row].total(), *(rows[row][name] for name in OUTCOMES)]
        print(f"{'all' if row == '~' else row:34s}" + "".join(f"{count or '':>10}" for count in counts))


def times(results: list[Result]) -> None:
    """Seconds by stage, and the errors of axes that are right."""
    done = [result for result in results if len(result.seconds) == len(STAGES) and result.wear.clean]
    if not done:
        return
    facets = sum(result.facets for result in done)
    print(f"\n{len(done)} clean cases, {facets} facets; seconds in all and in the slowest case")
    for number, stage in enumerate(STAGES):
        spent = [result.seconds[number] for result in done]
        print(f"  {stage:10s}{sum(spent):9.1f}{max(spent):9.2f}")
    angle = max(done, key=lambda r: r.verdict.angle)
    offset = max(done, key=lambda r: r.verdict.offset)
    print(f"greatest error of a right axis: {angle.verdict.angle:.2g} rad (seed {angle.seed}, {angle.kind})")
    print(
        f"greatest error of a right line: {offset.verdict.offset:.2g} of the size (seed {offset.seed}, {offset.kind})"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--seeds", type=int, nargs="+", help="these seeds only")
    parser.add_argument("--family", choices=(*FAMILIES, *OPTIONAL, "chain"))
    parser.add_argument("--kind", help="name of a function of that family")
    parser.add_argument("--plain", action="store_true", help="float32 near the origin, no noise, no coarse circles")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", type=Path, metavar="FOLDER", help="keep what is not right as manifests")
    parser.add_argument("--json", type=Path, metavar="FILE", help="all results as JSON lines")
    arguments = parser.parse_args()
    seeds = arguments.seeds or list(range(arguments.first, arguments.first + arguments.cases))
    wears = [Wear() if arguments.plain else Wear.drawn(seed) for seed in seeds]
    work = [(seed, arguments.family, arguments.kind, wear) for seed, wear in zip(seeds, wears, strict=True)]
    results = []
    for result in run_all(work, arguments.jobs):
        results.append(result)
        if result.verdict.outcome != "right":
            worn = "" if result.wear == Wear() else f" {result.wear}"
            print(f"{result.seed:6d} {result.kind}: {result.verdict.outcome}: {result.verdict.why}{worn}", flush=True)
            if arguments.write is not None:
                made = case(result.seed, arguments.family, arguments.kind, result.wear)
                made.write(arguments.write / f"{result.seed}")
    table(results, kinds_of)
    table(results, circumstances_of)
    times(results)
    if arguments.json is not None:
        lines = [json.dumps({**vars(r), "wear": vars(r.wear), "verdict": vars(r.verdict)}) for r in results]
        arguments.json.write_text("\n".join(lines) + "\n", encoding="utf-8")
    counts = Counter(result.verdict.outcome for result in results)
    bad = sum(counts[name] for name in ("false", "fused", "wrong", "crash"))
    clean = [result for result in results if result.wear.clean]
    bad += sum(result.verdict.outcome == "loose" for result in clean)
    short = sum(result.verdict.outcome != "right" for result in clean)
    return int(bad > 0 or short > 0.01 * len(clean))


if __name__ == "__main__":
    sys.exit(main())
