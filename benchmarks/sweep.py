"""Random assemblies with known answers, through the whole geometric part: `python benchmarks/sweep.py --cases 2000`.

Prints a table by family and kind (right, ambiguous, honest, …), the time of each stage, and every case that is not
right with its seed and one line on why. `--write FOLDER` keeps those cases as manifests with meshes and truth.
Exit 0: nothing wrong, false, fused or loose, no crash, and at most 1 % short of right.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies import FAMILIES, OPTIONAL, case
from random_assemblies.verdict import OUTCOMES, Verdict, judge

from kinform import contacts, form, kinematics, surfaces

Work = tuple[int, str | None, str | None]
STAGES = ("form", "surfaces", "contacts", "joints")


@dataclass(frozen=True)
class Result:
    seed: int
    kind: str
    size: float
    facets: int
    verdict: Verdict
    seconds: tuple[float, ...]


def run_case(seed: int, family: str | None, kind: str | None) -> Result:
    """One case through the stages, in a folder of its own."""
    made = case(seed, family, kind)
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
    return Result(seed, made.kind, made.size, made.facets, verdict, seconds)


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
                    yield Result(one[0], made.kind, made.size, made.facets, lost, ())
                    work = work[number + 1 :]
                    break
            else:
                return


def table(results: list[Result]) -> None:
    """Counts by kind and by family."""
    rows: dict[str, Counter[str]] = defaultdict(Counter)
    for result in results:
        family = result.kind.partition("/")[0]
        for row in {family, "chain/…" if family == "chain" else result.kind}:
            rows[row][result.verdict.outcome] += 1
    print(f"{'':34s}" + "".join(f"{name:>10s}" for name in ("cases", *OUTCOMES)))
    for row in sorted(rows):
        counts = [rows[row].total(), *(rows[row][name] for name in OUTCOMES)]
        print(f"{row:34s}" + "".join(f"{count or '':>10}" for count in counts))
    counts = Counter(result.verdict.outcome for result in results)
    print(f"{'all':34s}" + "".join(f"{count or '':>10}" for count in (len(results), *(counts[n] for n in OUTCOMES))))


def times(results: list[Result]) -> None:
    """Seconds by stage, and the errors of axes that are right."""
    done = [result for result in results if len(result.seconds) == len(STAGES)]
    if not done:
        return
    facets = sum(result.facets for result in done)
    print(f"\n{len(done)} cases, {facets} facets; seconds in all and in the slowest case")
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
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", type=Path, metavar="FOLDER", help="keep what is not right as manifests")
    parser.add_argument("--json", type=Path, metavar="FILE", help="all results as JSON lines")
    arguments = parser.parse_args()
    seeds = arguments.seeds or list(range(arguments.first, arguments.first + arguments.cases))
    work = [(seed, arguments.family, arguments.kind) for seed in seeds]
    results = []
    for result in run_all(work, arguments.jobs):
        results.append(result)
        if result.verdict.outcome != "right":
            print(f"{result.seed:6d} {result.kind}: {result.verdict.outcome}: {result.verdict.why}", flush=True)
            if arguments.write is not None:
                case(result.seed, arguments.family, arguments.kind).write(arguments.write / f"{result.seed}")
    print()
    table(results)
    times(results)
    if arguments.json is not None:
        lines = [json.dumps({**vars(r), "verdict": vars(r.verdict)}) for r in results]
        arguments.json.write_text("\n".join(lines) + "\n", encoding="utf-8")
    counts = Counter(result.verdict.outcome for result in results)
    bad = sum(counts[name] for name in ("loose", "false", "fused", "wrong", "crash"))
    return int(bad > 0 or counts["ambiguous"] + counts["honest"] > 0.01 * len(results))


if __name__ == "__main__":
    sys.exit(main())
