"""How far joints go where parts stay in touch all the way, or have many facets beside each other:
`python benchmarks/ranges.py`.

Screws cut as twisted sections, as `random_assemblies` makes them: their threads leave scraps that belong to no surface,
and scrape along each other over the whole of the way. Hinges of 3 to 31 knuckles, each leaf's in turn, whose pin is one
with the first leaf: their time should grow no faster than they do. Processor seconds of finding the ranges, everything
before it done. Beside: bare FCL, whether any facets of both parts cross, at as many places as are asked at most.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(Path(__file__).resolve().parent), str(ROOT / "fixtures"), str(ROOT / "tests")]
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "cli")]

import numpy as np  # noqa: E402
import random_assemblies  # noqa: E402
from random_assemblies.shapes import union  # noqa: E402
from support.solids import box, rod, save  # noqa: E402
from table import Row, peak, processor, show  # noqa: E402

SCREWS = {9: 5.0, 12: 9.0, 16: 4.0, 18: 6.0}
"""Seeds of screws, with the most seconds that each should take."""
KNUCKLES = (3, 7, 15, 31)
GROWTH = 1.0
"""Of the time of hinges with the number of their knuckles, the greatest exponent."""
WIDE = 10.0
"""mm of a knuckle."""
PLACES = 40
"""At which bare FCL is asked; its time is told of a hundred times as many."""


def leaves(knuckles: int):
    """Two leaves of a hinge (mm), the second opened by 40 degrees."""
    high, out = knuckles * WIDE, []
    for side, sense in enumerate((-1.0, 1.0)):
        ends = sorted((sense * 4.5, sense * 30.0))
        solids = [box(ends[0], ends[1], -4.0, -2.0, 0.0, high)]
        for k in range(side, knuckles, 2):
            z = k * WIDE + 0.01, (k + 1) * WIDE - 0.01
            tab = sorted((0.0, sense * 5.0))
            solids += [rod(4.0, *z, 32 + 4 * side, 3.0 * side), box(tab[0], tab[1], -4.0, -2.0, *z)]
        out.append(union(*solids))
    first, second = out
    first += rod(2.0, 1.0, high - 1.0, 32)
    return {"first": first, "second": (second - rod(2.02, -1.0, high + 1.0, 40, 5.0)).rotate((0, 0, 40.0))}


def hinge(knuckles: int, folder: Path) -> Path:
    """The manifest of a hinge."""
    lines = ["schema = 1", "[assembly]", 'name = "hinge"', 'units = "mm"', 'ground = "first"']
    for name, solid in leaves(knuckles).items():
        save(solid, folder / f"{name}.stl")
        lines += ["[[part]]", f'name = "{name}"', f'mesh = "{name}.stl"', "density = 7800.0"]
    path = folder / "hinge.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def measured(manifest: Path, repeats: int = 1):
    """Processor seconds of the ranges of a manifest, what they are, and its design."""
    from kinform import collisions, stages

    design = stages.joints(stages.contacts(stages.import_(manifest)))
    seconds, found = processor(
        lambda: collisions.ranges(design.assembly, design.surfaces, design.contacts, design.kinematics), repeats
    )
    return seconds, found, design


def bare(design) -> float:
    """Processor seconds of FCL alone, at PLACES of the first joint."""
    import fcl

    from kinform.foundation.algebra.displacements import displacements_along
    from kinform.foundation.meshes.fcl_adapter import fcl_model, fcl_pose
    from kinform.kinematics.mobility.guides import joint_twist

    first, second = design.assembly.parts[:2]
    objects = [fcl.CollisionObject(fcl_model(part.mesh.vertices, part.mesh.faces)) for part in (first, second)]
    moved = displacements_along(joint_twist(design.kinematics.joints[0]))

    def asked() -> None:
        for s in np.linspace(-math.pi, math.pi, PLACES):
            pose = np.linalg.inv(first.X_WP) @ moved(float(s)) @ second.X_WP
            objects[1].setTransform(fcl_pose(pose))
            request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)
            fcl.collide(*objects, request, fcl.CollisionResult())

    return processor(asked)[0]


def of_screw(seed: int) -> Row:
    """The row of one screw."""
    with tempfile.TemporaryDirectory() as scratch:
        case = random_assemblies.case(seed, "screw")
        seconds, found, design = measured(case.write(Path(scratch)))
    ends = ", ".join(end.status for end in (found[0].lower, found[0].upper))
    words = f"{case.facets:,} facets, {ends}; bare FCL {100.0 * bare(design):.1f} s at {100 * PLACES:,} places"
    return Row(f"ranges of screw {seed}", seconds, SCREWS[seed], "s", words, peak())


def of_hinges() -> Row:
    """The row of all hinges."""
    times = []
    for knuckles in KNUCKLES:
        with tempfile.TemporaryDirectory() as scratch:
            seconds, found, _ = measured(hinge(knuckles, Path(scratch)), 3)
        assert all(end.status == "found" for end in (found[0].lower, found[0].upper))
        times.append(seconds)
    growth = float(np.polyfit(np.log(KNUCKLES), np.log(times), 1)[0])
    words = ", ".join(f"{n} in {1e3 * seconds:.0f} ms" for n, seconds in zip(KNUCKLES, times, strict=True))
    return Row("growth of the ranges of hinges with their knuckles", growth, GROWTH, "exponent", words, peak())


def rows(quick: bool) -> Iterator[Row]:
    """One of each screw, and one of all hinges."""
    yield of_hinges()
    for seed in list(SCREWS)[: 1 if quick else None]:
        yield of_screw(seed)


if __name__ == "__main__":
    show(rows(quick=False))
