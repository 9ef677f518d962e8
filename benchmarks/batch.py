"""Many designs in one batch: `python benchmarks/batch.py [--designs 500] [--quick]`.

Designs of a second and more (an arm of plates on pins, each of another size) in folders of their own. The batch runs
them with one worker and with two (the aim is 1.6 times the throughput), and again when nothing has changed (the aim is
5 s for 500); then a part of them through the address of a scheduler with two workers started by hand, with `--send`;
through `kinform run` one by one, whose bytes all others must have; and once more while one worker of Dask after the
other is killed. Wall-clock seconds; each run is a process of its own, with one thread of BLAS a worker.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from scale import plate_with_pins
from table import Row, show

ROOT = Path(__file__).resolve().parents[1]
CHECKED = 20
"""Designs that are also run one by one, through a scheduler, and under fire."""


def environment() -> dict[str, str]:
    path = os.pathsep.join([str(ROOT / "pipeline"), str(ROOT / "cli")])
    return os.environ | {"PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def make(folder: Path, count: int) -> None:
    """So many designs, no two alike."""
    for k in range(count):
        here = folder / f"group{k // 20:02d}" / f"d{k:03d}"
        here.mkdir(parents=True)
        plate_with_pins(here, 16 + k % 5, 48 + k)


def kinform(*words: object) -> tuple[float, subprocess.CompletedProcess[str]]:
    """Seconds of a command, and how it ended; RuntimeError where it could not do its work."""
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "kinform_cli", *map(str, words)], env=environment(), capture_output=True, text=True
    )  # fmt: skip
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{words}: exit {done.returncode}\n{done.stderr[-2000:]}")
    return time.perf_counter() - began, done


def digests(folder: Path) -> dict[str, str]:
    """What the results below a folder are, by their path."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*.h5"))
    }


def part_of(designs: Path, to: Path, count: int) -> Path:
    """The first designs, beside the others."""
    import shutil

    for source in sorted(designs.rglob("*.toml"))[:count]:
        shutil.copytree(source.parent, to / source.parent.relative_to(designs))
    return to


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[str]:
    """The address of a scheduler with so many workers, each a process started as a person would."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port)]
    started = [subprocess.Popen([*command, "--no-dashboard"], env=environment(), stderr=subprocess.DEVNULL)]
    try:
        for _ in range(workers):
            command = [
                sys.executable,
                "-m",
                "distributed.cli.dask_worker",
                address,
                "--nthreads",
                "1",
                "--no-dashboard",
            ]
            started.append(subprocess.Popen(command, env=environment(), stderr=subprocess.DEVNULL))
        yield address
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait(timeout=30)


def under_fire(designs: Path, to: Path, shots: int = 3) -> tuple[int, subprocess.CompletedProcess[str]]:
    """A batch with two workers, one of which is killed every four seconds, some times: (killed, how it ended)."""
    import psutil

    batch = subprocess.Popen(
        [sys.executable, "-m", "kinform_cli", "batch", str(designs), "-o", str(to), "-j", "2"],
        env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    killed = 0
    for _ in range(shots):
        with contextlib.suppress(subprocess.TimeoutExpired):
            batch.wait(timeout=4.0)
        if batch.poll() is not None:
            break
        # a worker of Dask is a process that has a desk below it
        below = psutil.Process(batch.pid).children(recursive=True)
        desks = [each for each in below if "kinform.batch.desk" in " ".join(each.cmdline())]
        workers = sorted({desk.parent().pid for desk in desks if desk.parent() is not None} - {batch.pid})
        if workers:
            os.kill(workers[0], signal.SIGKILL)
            killed += 1
    out, err = batch.communicate()
    return killed, subprocess.CompletedProcess(batch.args, batch.returncode, out, err)


def rows(quick: bool, count: int | None = None) -> Iterator[Row]:
    """The table; RuntimeError where two ways do not give the same bytes, or a design is lost."""
    count = count or (24 if quick else 500)
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        designs = top / "designs"
        make(designs, count)
        times = {}
        for jobs in (1, 2):
            times[jobs], _ = kinform("batch", designs, "-o", top / f"results{jobs}", "-j", jobs)
            words = f"{count / times[jobs]:.2f} designs a second"
            yield Row(f"batch, {count} designs, {jobs} worker{'s' * (jobs > 1)}", times[jobs], beside=words)
        yield Row(
            "batch, time of two workers over that of one",
            times[2] / times[1],
            1 / 1.6,
            "",
            f"{times[1] / times[2]:.2f} times the throughput",
        )
        same(top / "results1", top / "results2", count)
        again, _ = kinform("batch", designs, "-o", top / "results2", "-j", 2)
        yield Row(f"batch, {count} designs, unchanged", again, 5.0)

        few = min(CHECKED, count)
        some, alone = part_of(designs, top / "some", few), top / "alone"
        for source in sorted(some.rglob("*.toml")):
            target = alone / source.relative_to(some).with_suffix(".h5")
            target.parent.mkdir(parents=True, exist_ok=True)
            kinform("run", source, "-o", target, "-q")
        with cluster(2) as address:
            far, _ = kinform("batch", some, "-o", top / "far", "--scheduler", address)
            sent, _ = kinform("batch", some, "-o", top / "sent", "--scheduler", address, "--send")
        yield Row(
            f"batch, {few} designs, by the address of a scheduler", far, beside=f"inputs sent along: {sent:.1f} s"
        )
        killed, ended = under_fire(some, top / "fire")
        if ended.returncode not in (0, 1):
            raise RuntimeError(f"under fire: exit {ended.returncode}\n{ended.stdout[-1500:]}\n{ended.stderr[-1500:]}")
        for other in ("far", "sent", "fire"):
            same(alone, top / other, few)
        kept = {path: digest for path, digest in digests(top / "results2").items() if path in digests(alone)}
        if kept != digests(alone):
            raise RuntimeError("a batch gives other bytes than `kinform run`")
        yield Row(
            "batch, workers killed in its midst, nothing lost",
            killed,
            unit="workers",
            beside=f"{few} designs; the same bytes as `run` in all ways",
        )


def same(one: Path, other: Path, count: int) -> None:
    """RuntimeError unless both have the same bytes for so many designs."""
    a, b = digests(one), digests(other)
    if len(a) != count or a != b:
        raise RuntimeError(f"{one.name} ({len(a)}) and {other.name} ({len(b)}) are not the same {count} results")


def main() -> None:
    """Print a line a measurement."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=None)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    show(rows(arguments.quick, arguments.designs))


if __name__ == "__main__":
    main()
