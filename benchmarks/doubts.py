"""What each threshold between determined and ambiguous is worth: `python benchmarks/doubts.py CORPUS --cases 300`.

CORPUS holds robots: `<robot>/truth.json` (parts with their files, rigid groups, joints with type, axis and origin, in
metres) and the meshes. Beside them, random assemblies of `fixtures/random_assemblies` are taken, by their kinds. For
every threshold and each of a few values of it, with all others as they are: joints that come out right, that are left
in doubt, and that are stated and wrong (or stand where none is). Then cross-validation: for each robot and each kind
the value is chosen on all others (fewest wrong, then most right, then nearest to that in use) and judged on it.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "fixtures"))

from random_assemblies import case
from random_assemblies.case import Case
from random_assemblies.scene import TrueJoint
from random_assemblies.verdict import tally

from kinform import contacts, form, surfaces
from kinform.kinematics.joints.bodies.classification import Pairs, decide_all
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.readings import choose_readings
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import body_of_part, only_bodies

GRID: dict[str, tuple[float, ...]] = {
    "VAGUE_AXIS": tuple(math.radians(v) for v in (0.05, 0.2, 0.5, 1.0, 3.0)),
    "VAGUE_PLACE": (0.003, 0.01, 0.03, 0.06, 0.2),
    "SLIVER_ARC": tuple(math.radians(v) for v in (0.0, 15.0, 30.0, 45.0, 90.0)),
    "SLIVER_SHARE": (0.0, 0.003, 0.01, 0.03, 0.1),
    "SLIVER_ARC_ONE_SIDED": tuple(math.radians(v) for v in (0.0, 45.0, 90.0, 120.0, 180.0)),
    "DIP": (0.02, 0.05, 0.1, 0.2, 1.0),
    "DIP_SHARE": (0.0, 0.02, 0.05, 0.1, 0.3),
    "SLIDES_FROM": (0.0, 0.25, 0.5, 0.8, 3.0),
    "INSIDE_GUIDE": (0.9, 1.0, 1.05, 1.2, 1.5),
    "BESIDE_AXIS": tuple(math.radians(v) for v in (90.0, 150.0, 200.0, 270.0, 360.0)),
    "MOST_LEFT_OUT": (0.1, 0.18, 0.25, 0.35, 0.5),
    "STRAY_AREA": (0.0, 2e-4, 5e-4, 1e-3, 3e-3),
    "STRAY_AREA_APART": (0.0, 1e-2, 2e-2, 4e-2, 1e-1),
}
"""Values that are tried; that in use is among them."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One assembly with its contacts and its truth; `group` is the robot or the kind that it belongs to."""

    group: str
    truth: Case
    assembly: Assembly
    contacts: Contacts


def robot(folder: Path) -> Case:
    """The truth of a robot, as a case without shapes."""
    truth = json.loads((folder / "truth.json").read_text())
    groups = [tuple(sorted(group)) for group in truth["rigid_groups"]]
    joints = []
    for item in [*truth["joints"], *truth["loops"]]:
        kind = {"continuous": "revolute"}.get(item["type"], item["type"])
        sides = item.get("parent_group", item.get("group_a")), item.get("child_group", item.get("group_b"))
        if None in sides or kind not in ("revolute", "prismatic", "cylindrical", "spherical", "planar"):
            continue
        axis = None if kind == "spherical" else np.asarray(item["axis"], dtype=float)
        roles = (groups[sides[0]][0], groups[sides[1]][0])
        unit = None if axis is None else axis / np.linalg.norm(axis)
        joints.append(TrueJoint(roles, kind, unit, np.asarray(item.get("origin", item.get("point")), dtype=float)))
    stated = tuple(group for group in groups if len(group) > 1)
    # 0.2 % of this size is 0.2 mm
    return Case(0, f"robot/{folder.name}", "m", 0.1, (), stated, tuple(groups), tuple(joints))


def robot_manifest(folder: Path, truth: Case) -> str:
    """Its parts and groups as a manifest."""
    parts = json.loads((folder / "truth.json").read_text())["parts"]
    lines = ["schema = 1", "[assembly]", f"name = {json.dumps(folder.name)}", 'units = "m"']
    for part in parts:
        lines += [
            "[[part]]",
            f"name = {json.dumps(part['name'])}",
            f"mesh = {json.dumps(part['file'])}",
            "density = 1.0",
        ]
    for number, group in enumerate(truth.groups):
        lines += ["[[group]]", f'name = "group {number}"', f"parts = {json.dumps(list(group))}"]
    return "\n".join(lines) + "\n"


def samples(corpus: Path | None, cases: int) -> Iterator[Sample]:
    """All robots, then random assemblies."""
    for folder in sorted(f.parent for f in corpus.glob("*/truth.json")) if corpus is not None else []:
        truth = robot(folder)
        manifest = folder / "doubts.toml"
        manifest.write_text(robot_manifest(folder, truth), encoding="utf-8")
        yield sample(truth.kind, truth, manifest)
    for seed in range(cases):
        truth = case(seed)
        with tempfile.TemporaryDirectory() as folder_name:
            yield sample(truth.kind if "/" in truth.kind else "other", truth, truth.write(Path(folder_name)))


def sample(group: str, truth: Case, manifest: Path) -> Sample:
    """An assembly with its contacts."""
    assembly = form.load(manifest)
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts if part.mesh is not None}
    found = {key: surfaces.recover(mesh, assembly.tolerances) for key, mesh in meshes.items()}
    return Sample("chain" if group.startswith("chain") else group, truth, assembly, contacts.find(assembly, found))


def judged(one: Sample) -> Counter[str]:
    """What its joints are worth with the constants as they are now."""
    merger, pairs = Merger(one.assembly), Pairs(one.assembly, one.contacts)
    decided = decide_all(pairs, merger)
    bodies = merger.bodies()
    chosen = choose_readings(one.assembly, body_of_part(bodies), decided, pairs.patches, pairs.size)
    kinematics = replace(only_bodies(bodies), joints=tuple(joint for _, joint in chosen.values()))
    return tally(one.truth, kinematics, ("planar", "general") if one.group.startswith("robot") else ())


def outcomes(counts: Counter[str]) -> tuple[int, int, int]:
    """Right, in doubt, wrong."""
    bad = sum(counts[name] for name in ("wrong", "false", "fused", "loose"))
    return counts["right"], counts["ambiguous"] + counts["honest"], bad


def value_of(name: str) -> float:
    """The value of a constant of the kinematics."""
    return next(getattr(module, name) for module in holders(name))


def holders(name: str) -> list[ModuleType]:
    """The modules that define a constant or import it."""
    return [m for key, m in sorted(sys.modules.items()) if key.startswith("kinform.kinematics") and hasattr(m, name)]


def set_everywhere(name: str, value: float) -> None:
    """Give a constant another value in all modules that use it."""
    for module in holders(name):
        setattr(module, name, value)


def table(every: list[Sample]) -> None:
    """One block of lines a threshold."""
    names = sorted({one.group for one in every})
    for name, values in GRID.items():
        used = value_of(name)
        by_value: dict[float, dict[str, Counter[str]]] = {}
        for value in values:
            set_everywhere(name, value)
            by_value[value] = {group: Counter() for group in names}
            for one in every:
                by_value[value][one.group].update(judged(one))
        set_everywhere(name, used)
        picks: Counter[float] = Counter()
        held_out: Counter[str] = Counter()
        for group in names:
            totals = {
                v: outcomes(sum((c for g, c in by.items() if g != group), Counter())) for v, by in by_value.items()
            }
            pick = min(values, key=lambda v: (totals[v][2], -totals[v][0], abs(math.log((v + 1e-9) / (used + 1e-9)))))
            picks[pick] += 1
            held_out.update(by_value[pick][group])
        print(f"{name} = {used:.4g}")
        for value in values:
            right, doubt, bad = outcomes(sum(by_value[value].values(), Counter()))
            print(f"    {value:10.4g}  right {right:5d}  in doubt {doubt:4d}  wrong {bad:3d}")
        right, doubt, bad = outcomes(held_out)
        chosen = ", ".join(f"{value:.4g} ({count})" for value, count in sorted(picks.items()))
        print(f"    held out    right {right:5d}  in doubt {doubt:4d}  wrong {bad:3d}  chosen: {chosen}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("corpus", type=Path, nargs="?", help="folder of robots with their truth")
    parser.add_argument("--cases", type=int, default=300, help="random assemblies")
    arguments = parser.parse_args()
    every = list(samples(arguments.corpus, arguments.cases))
    total = outcomes(sum((judged(one) for one in every), Counter()))
    groups = len({one.group for one in every})
    print(f"{len(every)} assemblies of {groups} robots and kinds; right, in doubt, wrong: {total}")
    table(every)
    return 0


if __name__ == "__main__":
    sys.exit(main())
