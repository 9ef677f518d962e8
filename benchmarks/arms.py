"""Ranges of the joints of two real arms: `python benchmarks/arms.py MANIFEST …`, or in the folders of KINFORM_ARMS.

Processor seconds of finding how far each joint goes, everything before it done. Nothing is printed where there are no
arms. Beside: bare FCL, the trees of all meshes and one distance of each pair.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "pipeline"), str(ROOT / "cli")]

from table import HEADER, Row, line, peak, processor  # noqa: E402

AIM = 3.0


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


def rows(quick: bool) -> Iterator[Row]:
    for folder in filter(None, os.environ.get("KINFORM_ARMS", "").split(os.pathsep)):
        for manifest in sorted(Path(folder).glob("*.toml")):
            yield of_arm(manifest)


def main(arguments: list[str]) -> None:
    print(HEADER)
    for row in (of_arm(Path(name)) for name in arguments) if arguments else rows(False):
        print(line(row), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
