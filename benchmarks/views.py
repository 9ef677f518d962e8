"""`kinform run`, `show`, `report` and `export` of large assemblies: `python benchmarks/views.py [--quick]`.

A plate with 1,000 and 3,000 pins is derived once, and once with as many stated joints; then processor seconds of the
whole commands, output to a file.
Beside: the bytes of the results file read and hashed once.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "cli")]

from scale import plate_with_pins, with_turns_stated  # noqa: E402
from table import Row, peak, processor, show  # noqa: E402

AIMS = {("show", 3000): 1.0, ("report", 1000): 5.0}


def worked(*command: str) -> float:
    """Processor seconds of a kinform command, whose bytecode is kept, also where the environment forbids that: no user
    compiles the source in each run."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"PYTHONPATH": os.pathsep.join([str(ROOT / "pipeline"), str(ROOT / "cli")])}
    environment.setdefault("PYTHONPYCACHEPREFIX", str(Path(tempfile.gettempdir()) / "kinform-bytecode"))
    before = os.times()
    subprocess.run(
        [sys.executable, "-m", "kinform_cli", *command],
        check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment,
    )  # fmt: skip
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def rows(quick: bool) -> Iterator[Row]:
    for parts in (100, 300) if quick else (1000, 3000):
        with tempfile.TemporaryDirectory() as folder:
            manifest, results = plate_with_pins(Path(folder), parts, 24), Path(folder) / "pins.h5"
            yield run(manifest, results, f"run, {parts} parts", parts)
            yield from of_file(results, parts)
            stated, page = with_turns_stated(manifest, parts), results.with_suffix(".html")
            results = results.with_name("stated.h5")
            yield run(stated, results, f"run, {parts} stated joints", parts)
            seconds = worked("report", str(results), "-o", str(page))
            yield Row(f"report, {parts} stated joints", seconds, None, "s", "", peak())


def run(manifest: Path, results: Path, name: str, parts: int) -> Row:
    """A row of the whole run, to a file of results."""
    seconds = worked("run", str(manifest), "-o", str(results))
    return Row(name, seconds, None, "s", f"{1e3 * seconds / parts:.1f} ms a part", peak())


def of_file(results: Path, parts: int) -> Iterator[Row]:
    """Rows of one results file of so many parts."""
    floor, _ = processor(lambda: hashlib.sha256(results.read_bytes()), 3)
    words = f"{results.stat().st_size / 1e6:.0f} MB read and hashed in {floor:.2f} s"
    page = str(results.with_suffix(".html"))
    for name, command in (
        ("show", ("show", str(results))),
        ("show joints", ("show", str(results), "joints")),
        ("report", ("report", str(results), "-o", page)),
        ("export --to mjcf", ("export", str(results), "--to", "mjcf", "-o", str(results.with_suffix(".mjcf")))),
        ("export --to modelica", ("export", str(results), "--to", "modelica", "-o", str(results.with_suffix(".mo")))),
    ):
        seconds = min(worked(*command) for _ in range(3))
        yield Row(f"{name}, {parts} parts", seconds, AIMS.get((name, parts)), "s", words, peak())


def main(arguments: list[str]) -> None:
    """Of results files where they are named as FILE=PARTS, else of assemblies made here."""
    named = [argument.rpartition("=") for argument in arguments if not argument.startswith("--")]
    made = (row for path, _, parts in named for row in of_file(Path(path), int(parts)))
    show(made if named else rows("--quick" in arguments))


if __name__ == "__main__":
    main(sys.argv[1:])
