"""Fuzz the readers of kinform: see README.md beside this file."""

from __future__ import annotations

import argparse
import resource
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "pipeline")]
import counts  # noqa: E402 - from this folder

SECONDS = 600.0
"""Of all targets together."""


def main() -> int:
    """The exit code: 1 where something was found."""
    arguments = _arguments()
    folder: Path = arguments.folder
    if arguments.table:
        print(counts.table(folder))
        return 0
    if arguments.driver == "atheris":
        import atheris_driver

        if len(arguments.targets) != 1:
            sys.exit("atheris takes one target a process")
        name = arguments.targets[0]
        atheris_driver.run(name, folder / name, runs=arguments.runs, seconds=arguments.seconds, seed=arguments.seed)
    import own_driver  # after the path is set, and not for a table
    from targets import TARGETS

    unknown = [name for name in arguments.targets if name not in TARGETS]
    if unknown:
        sys.exit(f"there is no target {', '.join(unknown)}; there are {', '.join(TARGETS)}")
    chosen = [TARGETS[name] for name in arguments.targets or TARGETS]
    if arguments.again is not None:
        for target in chosen:
            target.run(arguments.again.read_bytes())
        return 0
    shares = sum(target.share for target in chosen)
    print(f"{'target':<10} {'executions':>11} {'refused':>11} {'seconds':>8} {'findings':>9} {'MB':>6}")
    found = 0
    for target in chosen:
        seconds = arguments.seconds
        if seconds is None and arguments.runs is None:
            seconds = SECONDS * target.share / shares
        before = _processor()
        outcome = own_driver.run(
            target, folder / target.name, runs=arguments.runs, seconds=seconds, seed=arguments.seed
        )  # fmt: skip
        found += len(outcome.findings)
        counts.add(
            folder, target.name, "own", executions=outcome.executions, refused=outcome.refused,
            seconds=_processor() - before, findings=len(outcome.findings),
        )  # fmt: skip
        memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1000
        print(
            f"{outcome.name:<10} {outcome.executions:>11,} {outcome.refused:>11,} {outcome.seconds:>8.0f} "
            f"{len(outcome.findings):>9} {memory:>6}", flush=True,
        )  # fmt: skip
    return 1 if found else 0


def _processor() -> float:
    """Seconds that ended children took of the processor."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*", help="formats; default all")
    parser.add_argument("--runs", type=int, help="executions a target")
    parser.add_argument("--seconds", type=float, help="seconds a target; default ten minutes for all")
    parser.add_argument("--seed", type=int, default=0, help="of the random numbers")
    parser.add_argument("--driver", choices=("own", "atheris"), default="own")
    parser.add_argument("--folder", type=Path, default=Path("build/fuzz"), help="for findings and corpora")
    parser.add_argument("--again", type=Path, help="run this input once, and show what is raised")
    parser.add_argument(
        "--table", action="store_true", help="print what was executed so far, of all runs in the folder"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
