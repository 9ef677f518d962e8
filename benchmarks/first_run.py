"""Ten seconds of the seeker with two axes on a fresh machine, and later: `python benchmarks/first_run.py [SECONDS]`.

Runs `kinform run` from the meshes as a user does, in processes of their own: first without any cache of bytecode or of
compiled functions, then with those that the first run left, then once the compiled functions are in the cache, as
after a longer run. Once with the drives of the fixture, once left to itself. Prints processor seconds of the solver,
importing and compiling included, which a busy machine changes less than seconds of the clock; both of the whole
command; and whether the results are the same bytes each time.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from table import Row, peak

ROOT = Path(__file__).resolve().parents[1]
SEEKER = ROOT / "fixtures" / "seekers" / "seeker_2dof"

RUN = """
import sys, time
from kinform.simulation import system_simulation
run = system_simulation.run_dynamic
def timed(*given):
    start = time.process_time()
    out = run(*given)
    print("solver", time.process_time() - start, "numba" in sys.modules, len(out.time), file=sys.stderr)
    return out
system_simulation.run_dynamic = timed
from kinform_cli.main import main
sys.exit(main(sys.argv[1:]))
"""
COMPILE = "from kinform.simulation.kernel.calls import engine; engine(compiled=True)"


def started(caches, *command):
    """Python on the command with caches of its own: seconds by the clock, of all processors, and stderr."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPYCACHEPREFIX": str(caches / "bytecode"), "XDG_CACHE_HOME": str(caches / "user")}
    environment["PYTHONPATH"] = os.pathsep.join([str(ROOT / "pipeline"), str(ROOT / "cli")])
    start, before = time.perf_counter(), os.times()
    ran = subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, encoding="utf-8", check=False, env=environment
    )
    seconds, after = time.perf_counter() - start, os.times()
    if ran.returncode not in (0, 1):
        sys.exit(ran.stderr)
    worked = after.children_user + after.children_system - before.children_user - before.children_system
    return seconds, worked, ran.stderr


def written(folder, seconds, driven):
    """The seeker's manifest for so many seconds in a copy of its folder."""
    shutil.copytree(SEEKER, folder)
    manifest = folder / "seeker_2dof.toml"
    text = manifest.read_text(encoding="utf-8")
    if not driven:
        text = re.sub(r"\[\[function\.drive\]\][^\[]*", "", text)
    text, found = re.subn(r"(?m)^duration = .*$", f"duration = {seconds:g}", text)
    if found != 1:
        sys.exit(f"{manifest}: one line with the duration is expected")
    manifest.write_text(text, encoding="utf-8")
    return manifest


LONG = 200.0
"""s of motion that are compiled."""
FLOOR = "import numpy, h5py, fcl, manifold3d, pydantic, typer"


def rows(quick: bool) -> Iterator[Row]:
    """The seeker from its meshes to the verdict: the least of some runs. `native` has what compiling takes."""
    repeats = 3 if quick else 7
    with tempfile.TemporaryDirectory() as scratch:
        caches = Path(scratch) / "caches"
        for design in ("seeker_1dof", "seeker_2dof"):
            manifest = SEEKER.with_name(design) / f"{design}.toml"
            worked, floor = [], []
            for k in range(repeats + 1):
                output = Path(scratch) / f"{design}{k}.h5"
                worked.append(started(caches, "-m", "kinform_cli", "run", str(manifest), "-o", str(output))[1])
                floor.append(started(caches, "-c", FLOOR)[1])
            words = f"importing the packages alone {min(floor[1:]):.2f} s; without bytecode {worked[0]:.2f} s"
            aim = 1.2 if design == "seeker_2dof" else None
            yield Row(f"{design} from nothing to the verdict", min(worked[1:]), aim, "s", words, peak())
        yield compiling(Path(scratch) / "long", caches)


def compiling(folder: Path, caches: Path) -> Row:
    """The solver in the first run on a machine that is long enough to be compiled; beside it the same run again."""
    manifest, solver, whole = written(folder, LONG, driven=True), [], []
    shutil.rmtree(caches / "numba", ignore_errors=True)
    for k in range(2):
        _, worked, told = started(caches, "-c", RUN, "run", str(manifest), "-o", str(folder / f"{k}.h5"))
        found = re.search(r"^solver (\S+) True", told, re.M)
        if found is None:
            raise RuntimeError(f"{LONG:g} s of {SEEKER.name} are too short to be compiled:\n{told}")
        solver.append(float(found[1]))
        whole.append(worked)
    words = f"compiled before {solver[1]:.2f} s; whole commands {whole[0]:.1f} and {whole[1]:.1f} s"
    return Row(f"{LONG:g} s of {SEEKER.name}, solver, compiling", solver[0], 8.0, "s", words, peak())


def main(arguments) -> None:
    seconds = float(arguments[0]) if arguments else 10.0
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("driven", "left to itself"):
            folder = Path(scratch) / name
            manifest, caches, kept = written(folder, seconds, name == "driven"), folder / "caches", []
            print(f"{seconds:g} s of {SEEKER.name}, {name}")
            for when in ("first run", "later", "compiled before"):
                if when == "compiled before":
                    started(caches, "-c", COMPILE)
                output = folder / f"{when}.h5"
                clock, worked, told = started(caches, "-c", RUN, "run", str(manifest), "-o", str(output))
                found = re.search(r"^solver (\S+) (\w+) (\d+)$", told, re.M)
                if found is None:
                    sys.exit(f"the solver was not called:\n{told}")
                solver, numba, outputs = found.groups()
                how = "compiled" if numba == "True" else "plain"
                print(
                    f"  {when:16s} solver {float(solver):6.2f} s of processor ({how}, {outputs} outputs); "
                    f"whole command {worked:6.2f} s of processors, {clock:6.2f} s by the clock",
                    flush=True,
                )
                for line in told.splitlines():
                    if "compiling" in line:
                        print(f"    said: {line.strip()}")
                kept.append(output.read_bytes())
            print("  the same bytes" if len(set(kept)) == 1 else "  OTHER BYTES", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
