"""The whole run of real arms, and ranges of their joints: `python benchmarks/arms.py MANIFEST …`, or in the folders of
KINFORM_ARMS, or so100 and so101 as `geometry` finds robots.

Seconds by the clock of `kinform run` on the processors that there are, the bytecode of all packages compiled by a run
before it, as an installed package has it; and processor seconds of finding how far each joint goes, everything before
it done. An arm that is not there is left out, and said so. Beside: the processor seconds of the run, and how long the
first one took; bare FCL, the trees of all meshes and one distance of each pair.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "cli")]

from change import run  # noqa: E402
from geometry import manifest_of  # noqa: E402
from table import Row, peak, processor, show  # noqa: E402

AIM = 3.0
ARMS = {"so100": None, "so101": 8.0}
"""Arms, with the most seconds that a whole run of them should take, on two processors."""


def whole(manifest: Path) -> Row:
    """The row of the whole run of one manifest."""
    with tempfile.TemporaryDirectory() as scratch:
        first, _, _ = run(manifest, Path(scratch) / "first.h5")
        seconds, worked, _ = run(manifest, Path(scratch) / "arm.h5")
    name = manifest.parent.name
    words = f"{worked:.1f} s of {os.cpu_count()} processors; without bytecode {first:.1f} s"
    return Row(f"whole run of {name}", seconds, ARMS.get(name), "s of the clock", words, peak())


def of_arm(manifest: Path) -> Row:
    """The row of one manifest."""
    import fcl

    from kinform import collisions, stages
    from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose

    design = stages.joints(stages.contacts(stages.import_(manifest)))
    seconds, found = processor(
        lambda: collisions.ranges(design.assembly, design.surfaces, design.contacts, design.kinematics)
    )

    def bare():
        objects = []
        for part in design.assembly.parts:
            model = fcl_model(part.mesh.vertices, part.mesh.faces)
            objects.append(fcl.CollisionObject(model, fcl_pose(part.X_WP)))
        return [fcl_distance(a, b) for a, b in combinations(objects, 2)]

    floor, _ = processor(bare)
    known = sum(end.status == "found" for item in found for end in (item.lower, item.upper))
    words = f"{len(found)} joints, {known} ends found; bare FCL {floor:.2f} s"
    return Row(f"ranges of {design.assembly.name}", seconds, AIM, "s", words, peak())


def manifests() -> Iterator[Path]:
    """Those of KINFORM_ARMS; without it, of the arms among the robots."""
    folders = [Path(folder) for folder in os.environ.get("KINFORM_ARMS", "").split(os.pathsep) if folder]
    for folder in folders:
        yield from sorted(folder.glob("*.toml"))
    robots = [Path(named)] if (named := os.environ.get("KINFORM_ROBOTS")) else []
    for name in () if folders else ARMS:
        places = [*(robot / name for robot in robots), ROOT.parent / "shared" / "data" / name]
        found = next((path for place in places if (path := manifest_of(place)) is not None), None)
        if found is None:
            print(f"{name}: not there; name the folder of the robots", flush=True)
        else:
            yield found


def rows(quick: bool) -> Iterator[Row]:
    """Two of each arm."""
    for manifest in manifests():
        yield whole(manifest)
        yield of_arm(manifest)


def main(arguments: list[str]) -> None:
    named = [Path(name) for name in arguments]
    show(row(manifest) for manifest in named or manifests() for row in (whole, of_arm))


if __name__ == "__main__":
    main(sys.argv[1:])
