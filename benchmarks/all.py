"""Every aim of speed in one table: `python benchmarks/all.py [--quick] [NAME …]`.

Each benchmark runs in a process of its own, one after the other, with one thread of BLAS. NAME: only these modules.
To add a row: yield it from `rows(quick)` of a module here, and name the module in MODULES.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(HERE), str(ROOT / "pipeline"), str(ROOT / "cli"), str(ROOT / "tests")]

from table import HEADER, line  # noqa: E402

MODULES = (
    "pace", "geometry", "machines", "chains", "native", "first_run", "mobility", "views", "linked", "ranges", "arms",
    "batch",
)  # fmt: skip
"""Those that have `rows`."""


def one(name: str, quick: bool) -> None:
    """The rows of one module, as lines."""
    for row in importlib.import_module(name).rows(quick):
        print(line(row), flush=True)


def main(arguments: list[str]) -> int:
    quick = "--quick" in arguments
    wanted = [a for a in arguments if not a.startswith("--")] or list(MODULES)
    print(HEADER, flush=True)
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    failed = 0
    for name in wanted:
        command = [sys.executable, __file__, "--one", name, *(["--quick"] * quick)]
        ran = subprocess.run(command, check=False, env=environment)
        failed += ran.returncode != 0
        if ran.returncode:
            print(f"{name}: did not end (exit {ran.returncode})", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(sys.argv[2], "--quick" in sys.argv)
    else:
        sys.exit(main(sys.argv[1:]))
