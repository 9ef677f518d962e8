"""The same answer wherever, how large, in which unit and order a design is described: `python benchmarks/places.py`.

Of each fixture, or of the random assemblies with the seeds after `--random`, or of manifests, copies are written
below a temporary folder: moved and turned, at other sizes and in other units, mirrored, with other names and orders
of parts and facets. Each is run from its manifest to its findings, and compared with a copy that changes nothing;
physics scales with the copy (`tests/support/elsewhere.py`). One line a difference; those that begin with ~ are of
less weight.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import traceback
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "tests"), str(ROOT / "fixtures")]

from random_assemblies import case  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402
from support.elsewhere import Elsewhere, described_elsewhere  # noqa: E402
from support.places import manifests  # noqa: E402
from support.whole_answers import answer, differences  # noqa: E402


def turned(seed: int) -> np.ndarray:
    return Rotation.random(random_state=np.random.default_rng(seed)).as_matrix()


def other_ground(tables):
    """The last group or part that is not the ground."""
    now = tables["assembly"].get("ground")
    grouped = {part for group in tables.get("group", ()) for part in group["parts"]}
    if "simulation" in tables or "mobility" not in tables.get("function", {}):
        return now
    groups = [g["name"] for g in tables.get("group", ())]
    own = [p["name"] for p in tables.get("part", ()) if p["name"] not in grouped]
    held = {g["name"] for g in tables.get("group", ()) if now in g["parts"]}
    return next((n for n in reversed(own + groups) if n != now and n not in held), now)


CHANGES = {
    "turned": Elsewhere(rotation=turned(11)),
    "1 m": Elsewhere(offset=(0.6, -0.64, 0.48)),
    "10 m, turned": Elsewhere(offset=(6.0, -6.4, 4.8), rotation=turned(12)),
    "100 m": Elsewhere(offset=(-48.0, 60.0, 64.0)),
    "a tenth": Elsewhere(scale=0.1),
    "tenfold, turned": Elsewhere(scale=10.0, rotation=turned(13)),
    "in inches": Elsewhere(scale=25.4, units="in"),
    "in metres": Elsewhere(scale=1000.0, units="m"),
    "renamed": Elsewhere(reordered=True),
    "retold": Elsewhere(retold=True),
    "reframed": Elsewhere(reframed=True),
    "mirrored": Elsewhere(mirrored=True),
    "on end": Elsewhere(rotation=np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])),
    "upside down": Elsewhere(rotation=np.diag([1.0, -1.0, -1.0])),
    "all": Elsewhere(0.37, "ft", True, turned(14), (3.0, 2.0, -1.0), True, True, True),
    "other ground": Elsewhere(ground=other_ground),
}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("paths", nargs="*", type=Path, help="manifests, in place of the fixtures")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--leave", nargs="*", default=[])
    parser.add_argument("--changes", nargs="*", default=[])
    parser.add_argument("--random", type=int, nargs="*", default=None, help="seeds, in place of fixtures")
    parser.add_argument("--heavy", action="store_true", help="differences of less weight too")
    parser.add_argument("--no-ranges", action="store_true", help="how far joints go is not found")
    parser.add_argument("--most", type=float, default=20.0, help="s a run; slower designs are left out")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as root:
        if args.paths:
            designs = args.paths
        elif args.random is None:
            designs = [m for m in manifests() if not args.only or m.stem in args.only]
        else:
            designs = [case(seed).write(Path(root) / f"random{seed}") for seed in args.random]
        bad = 0
        for manifest in designs:
            if manifest.stem not in args.leave:
                bad += compared(manifest, Path(root), args)
    print(f"{len(designs)} designs, {bad} differ")
    return 1 if bad else 0


def compared(manifest: Path, root: Path, args: argparse.Namespace) -> int:
    title, ranges = manifest.parent.name, False if args.no_ranges else None
    folder = root / f"copies of {title}"
    start = time.perf_counter()
    try:
        plain = Elsewhere()
        known = answer(*_copy(manifest, folder / "plain", plain), ranges=ranges)
    except Exception as error:
        print(f"{title}: {type(error).__name__} {str(error)[:200]}", flush=True)
        return 0
    took = time.perf_counter() - start
    if took > args.most:
        print(f"{title}: left out, {took:.0f} s", flush=True)
        return 0
    bad = 0
    for number, (name, change) in enumerate(CHANGES.items()):
        if args.changes and name not in args.changes:
            continue
        try:
            other = answer(*_copy(manifest, folder / str(number), change), ranges=ranges)
        except Exception as error:
            print(f"{title} | {name} | {type(error).__name__}: {str(error)[:300]}", flush=True)
            if args.only:
                traceback.print_exc()
            bad = 1
            continue
        for key, (a, b) in differences(known, other).items():
            if key.startswith("~") and not args.heavy:
                continue
            bad = 1
            print(f"{title} | {name} | {key}: {a} -> {b}", flush=True)
    print(f"{title}: {time.perf_counter() - start:.1f} s", flush=True)
    return bad


def _copy(manifest: Path, folder: Path, change: Elsewhere):
    path, originals = described_elsewhere(manifest, folder, change)
    return path, change, originals


if __name__ == "__main__":
    sys.exit(main())
