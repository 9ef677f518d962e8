"""Chains of hundreds of bars, each with a pin in the bore of the next: `python benchmarks/linked.py [--quick]`.

Processor seconds of `kinform init`, which proposes their joints, and of `kinform simulate` with all joints driven and
nothing asked of ranges: what the bars run into. A chain that waves keeps clear of itself; one that curls up, all joints
turning the same way, is in its own way by thousands of pairs. Beside: the bytes of the results file read and hashed
once.
"""

from __future__ import annotations

import hashlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "cli")]

from scale import write  # noqa: E402
from table import Row, peak, processor, show  # noqa: E402
from views import worked  # noqa: E402

PITCH = 40.0
"""mm from pin to pin."""
TURN = 3.0
"""Degrees that each joint turns to either side."""
CURLED = 200
"""Bars of the chain that curls up."""


def chain(folder: Path, bars: int, *, curls: bool = False) -> Path:
    """The manifest of a chain in two layers, its joints stated and driven."""
    from manifold3d import Manifold

    head = Manifold.cylinder(2, 4.5, 4.5, 32)
    parts, joints = [], []
    for k in range(bars):
        low = 6.0 * (k % 2)
        bar = Manifold.cube((PITCH + 16, 16, 5.9)).translate((-8, -8, low))
        bar -= Manifold.cylinder(6.2, 3.0, 3.0, 32).translate((0, 0, low - 0.1))
        begin, end = (low, 11.95) if k % 2 == 0 else (-0.05, -2.05)
        bar += Manifold.cylinder(12, 2.95, 2.95, 32).translate((PITCH, 0, begin)) + head.translate((PITCH, 0, end))
        pose = np.eye(4)
        pose[0, 3] = PITCH * k
        write(folder / f"bar{k}.stl", bar, pose)
        parts.append(f'[[part]]\nname = "bar{k}"\nmesh = "bar{k}.stl"\ndensity = 2700\n')
    for k in range(bars - 1):
        joints.append(
            f'[[function.joint]]\nname = "j{k}"\nbetween = ["bar{k}", "bar{k + 1}"]\ntype = "revolute"\n'
            f"axis = [0, 0, 1]\npoint = [{PITCH * (k + 1)}, 0, 0]\n"
            f'[[function.drive]]\njoint = "j{k}"\nkind = "motion"\n'
            f'law = {{type = "sine", amplitude = {TURN if curls or k % 2 else -TURN}, frequency = 0.5}}\n'
        )
    path = folder / "chain.toml"
    whole = 'schema = 1\n[assembly]\nname = "chain"\nunits = "mm"\nground = "bar0"\n'
    motion = "[simulation]\nduration = 1\nstep = 0.01\n"
    path.write_text("".join([whole, *parts, f"[function]\nmobility = {bars - 1}\n", *joints, motion]))
    return path


def simulated(folder: Path, bars: int, *, curls: bool) -> Row:
    """The row of one chain in motion."""
    manifest, stages = chain(folder, bars, curls=curls), [folder / f"{k}.h5" for k in range(5)]
    worked("import", str(manifest), "-o", str(stages[0]))
    for k, stage in enumerate(("contacts", "joints", "mass")):
        worked(stage, str(stages[k]), "-o", str(stages[k + 1]))
    seconds = worked("simulate", str(stages[3]), "--no-ranges", "-o", str(stages[4]))
    floor, _ = processor(lambda: hashlib.sha256(stages[4].read_bytes()), 3)
    words = f"{stages[4].stat().st_size / 1e6:.0f} MB read and hashed in {floor:.2f} s"
    how = "curls up" if curls else "waves"
    return Row(f"simulate a chain of {bars} bars that {how}", seconds, None, "s", words, peak())


def rows(quick: bool) -> Iterator[Row]:
    """The time of `init` and how it grows, and chains in motion."""
    sizes, times = (25, 50, 100, 200) if quick else (100, 200, 400, 800), []
    for bars in sizes:
        with tempfile.TemporaryDirectory() as folder:
            chain(Path(folder), bars)
            meshes = sorted(str(path) for path in Path(folder).glob("*.stl"))
            command = ("init", *meshes, "--units", "mm", "--force", "-o", str(Path(folder) / "new.toml"))
            times.append(min(worked(*command) for _ in range(2)))
    growth = float(np.polyfit(np.log(sizes), np.log(times), 1)[0])
    words = ", ".join(f"{n} in {seconds:.1f} s" for n, seconds in zip(sizes, times, strict=True))
    yield Row("growth of init with the bars of a chain", growth, None, "exponent", words, peak())
    for bars in sizes[:2] if quick else sizes[:3]:
        with tempfile.TemporaryDirectory() as folder:
            yield simulated(Path(folder), bars, curls=False)
    with tempfile.TemporaryDirectory() as folder:
        yield simulated(Path(folder), CURLED // 4 if quick else CURLED, curls=True)


if __name__ == "__main__":
    show(rows("--quick" in sys.argv[1:]))
