"""URDFs from single parts and a function, against the robots that they were.

`python benchmarks/written_back.py CORPUS [robot …]`: CORPUS is what `../shared/robots/make_robots.py` makes, with
<robot>/truth.json (parts, rigid groups, joints) and the meshes of the parts. Of each robot the parts alone, all of
one density, and the intended joints (`complete = true`, the largest part of either side named) go through import,
contacts, joints, mass and `export --to urdf`. Every joint of the original is looked for in that URDF (which calls
joints by their bodies), each once: its axis at the pose of the meshes within 0.5° and 0.2 mm, and the mass of the
link that it carries within 2 % of that of the original's parts. Closing joints of loops are stated last and do not
count: no URDF has them. Of a ball its centre is compared. `--contacts FOLDER` takes contacts that were made before,
from `<robot>-score-function.h5` there. `-v` lists what disagrees, with both masses; a link with an open mesh has no
mass that is known. Exit 0 when all agree, or, with the reason, where there is no corpus.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

DENSITY = 1200.0
ROBOTS = ("so100", "so101", "2wheels", "finger_edu", "lekiwi", "mini_pupper", "rotom", "spot_mini_mini")
ANGLE, OFFSET, MASS = 0.5, 2e-4, 0.02


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("corpus", type=Path)
    parser.add_argument("robots", nargs="*", default=ROBOTS)
    parser.add_argument("--contacts", type=Path, help="folder of results files that have contacts")
    parser.add_argument("-v", action="store_true", dest="verbose", help="list what disagrees")
    options = parser.parse_args()
    if not options.corpus.is_dir():
        print(f"skipped: {options.corpus} is no folder; ../shared/robots/make_robots.py makes one")
        return 0
    print("| robot | joints | axes agree | worst angle | worst offset | links | masses agree | worst mass |")
    print("|---|---|---|---|---|---|---|---|")
    return max(row(options.corpus / robot, options.contacts, options.verbose) for robot in options.robots)


def row(robot: Path, contacts: Path | None, verbose: bool) -> int:
    """One robot; 0 where all agrees."""
    if not (robot / "truth.json").exists():
        print(f"| {robot.name} | not there | | | | | | |")
        return 0
    truth = json.loads((robot / "truth.json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        written, why = urdf(robot, truth, Path(folder), contacts)
    if written is None:
        print(f"| {robot.name} | {why} | | | | | | |")
        return 1
    joints, masses = written
    weight = {p["name"]: DENSITY * abs(trimesh.load_mesh(robot / p["file"]).volume) for p in truth["parts"]}
    moving = [joint for joint in truth["joints"] if joint["type"] != "fixed"]
    unused = dict(joints)
    angles, offsets, shares, said = [], [], [], []
    # what is there first: a joint that is not takes one that no other is
    there = {joint["name"]: any(_near(away(joint, found)) for found in joints.values()) for joint in moving}
    for joint in sorted(moving, key=lambda joint: not there[joint["name"]]):
        expected = sum(weight[name] for name in truth["rigid_groups"][joint["child_group"]])
        ways = sorted(
            (*away(joint, found), abs(masses.get(found[2], 0.0) / expected - 1.0), name)
            for name, found in unused.items()
        )
        near = [way for way in ways if _near(way[:2])]
        angle, offset, share, name = min(near, key=lambda way: way[2]) if near else ways[0]
        del unused[name]
        angles.append(angle)
        offsets.append(offset)
        shares.append(share)
        if angle > ANGLE or offset > OFFSET or share > MASS:
            own = f"{masses.get(joints[name][2], math.nan):.4g} kg for {expected:.4g} kg"
            said.append(f"  {joint['name']}: {angle:.2g}°, {1e3 * offset:.2g} mm, link {joints[name][2]}: {own}")
    right = sum(a <= ANGLE and o <= OFFSET for a, o in zip(angles, offsets, strict=True))
    heavy = sum(share <= MASS for share in shares)
    worst = (max(angles, default=0.0), 1e3 * max(offsets, default=0.0), 100.0 * max(shares, default=0.0))
    print(
        f"| {robot.name} | {len(moving)} | {right} | {worst[0]:.2g}° | {worst[1]:.2g} mm | {len(shares)} | {heavy} "
        f"| {worst[2]:.2g} % |",
        flush=True,
    )
    for line in said if verbose else ():
        print(line, flush=True)
    return int(right < len(moving) or heavy < len(moving))


def _near(off: tuple[float, float]) -> bool:
    return off[0] <= ANGLE and off[1] <= OFFSET


def away(joint: dict[str, Any], found: tuple[Any, Any, str]) -> tuple[float, float]:
    """Degrees and metres by which the axis of a URDF's joint is off; of a ball, whose three turns have one centre, the
    metres by which the centre is.
    """
    axis, point, _ = found
    wanted = np.array(joint["axis"], float) / np.linalg.norm(joint["axis"])
    angle = math.degrees(math.asin(min(1.0, float(np.linalg.norm(np.cross(axis, wanted))))))
    gap = point - np.array(joint["origin"], float)
    if joint["type"] == "spherical":
        return 0.0, float(np.linalg.norm(gap))
    slides = joint["type"] in ("prismatic", "planar")
    return angle, 0.0 if slides else float(np.linalg.norm(gap - (gap @ wanted) * wanted))


def urdf(robot: Path, truth: dict[str, Any], folder: Path, contacts: Path | None) -> tuple[Any, str]:
    """Joints (axis, point, child link) and masses of links in the URDF that kinform writes; None and why not."""
    made = None if contacts is None else contacts / f"{robot.name}-score-function.h5"
    steps = []
    if made is not None and made.exists():
        shutil.copy(made, folder / "r.h5")
    else:
        (folder / "m.toml").write_text(manifest(robot, truth))
        shutil.copytree(robot / "parts", folder / "parts")
        steps = [["import", "m.toml", "-o", "r.h5"], ["contacts", "r.h5", "-o", "r.h5"]]
    steps += [[stage, "r.h5", "-o", "r.h5"] for stage in ("joints", "mass")]
    steps += [["export", "r.h5", "--to", "urdf", "-o", "out"]]
    for step in steps:
        ran = subprocess.run([sys.executable, "-m", "kinform_cli", *step], cwd=folder, capture_output=True, text=True)
        if ran.returncode:
            return None, f"{step[0]}: exit {ran.returncode}: {' '.join(ran.stderr.split())[:240]}"
    (file,) = folder.glob("**/*.urdf")
    return placed(ET.parse(file).getroot()), ""


def manifest(robot: Path, truth: dict[str, Any]) -> str:
    """All parts, no group, and the joints."""
    box = {p["name"]: float(np.prod(trimesh.load_mesh(robot / p["file"]).extents)) for p in truth["parts"]}
    largest = [max(group, key=lambda name: (box[name], name)) for group in truth["rigid_groups"]]
    lines = ["schema = 1", "[assembly]", 'name = "robot"', 'units = "m"', f"ground = {json.dumps(largest[0])}"]
    for part in truth["parts"]:
        mesh = json.dumps(part["file"])
        lines += ["[[part]]", f"name = {json.dumps(part['name'])}", f"mesh = {mesh}", f"density = {DENSITY}"]
    lines += ["[function]", "complete = true"]
    sides = [(joint, joint["parent_group"], joint["child_group"]) for joint in truth["joints"]]
    # those that close loops come last: a tree is written of the joints that are stated first
    sides += [(loop, loop["group_a"], loop["group_b"]) for loop in truth["loops"]]
    for joint, first, second in sides:
        type_ = {"continuous": "revolute"}.get(joint.get("type"), joint.get("type"))
        if type_ in (None, "unstated", "weld", "fixed"):
            continue
        between = json.dumps([largest[first], largest[second]])
        lines += ["[[function.joint]]", f"name = {json.dumps(joint['name'])}", f"between = {between}"]
        lines += [f'type = "{type_}"']
        if joint.get("axis") and type_ != "spherical":
            lines += [f"axis = {json.dumps(joint['axis'])}"]
        if type_ not in ("prismatic", "planar"):
            lines += [f"point = {json.dumps(joint.get('origin', joint.get('point')))}"]
    return "\n".join(lines) + "\n"


def placed(root: ET.Element) -> tuple[dict[str, Any], dict[str, float]]:
    """Joints of a URDF in the frame of its first link at zero, and the masses of its links."""
    masses = {link.get("name"): float(link.find("inertial/mass").get("value")) for link in root.iter("link")
              if link.find("inertial/mass") is not None}  # fmt: skip
    joints = list(root.findall("joint"))
    children = {joint.find("child").get("link") for joint in joints}
    poses = {link.get("name"): np.eye(4) for link in root.iter("link") if link.get("name") not in children}
    out = {}
    while len(poses) < len(children) + 1:
        for joint in joints:
            parent, child = joint.find("parent").get("link"), joint.find("child").get("link")
            if parent in poses and child not in poses:
                poses[child] = poses[parent] @ pose(joint.find("origin"))
                axis = np.array(
                    (joint.find("axis").get("xyz") if joint.find("axis") is not None else "1 0 0").split(), float
                )
                out[joint.get("name")] = (poses[child][:3, :3] @ axis, poses[child][:3, 3], child)
    return out, masses


def pose(origin: ET.Element | None) -> np.ndarray:
    """(4, 4) of an <origin>."""
    X = np.eye(4)
    if origin is not None:
        r, p, y = (float(v) for v in (origin.get("rpy") or "0 0 0").split())
        X = trimesh.transformations.euler_matrix(r, p, y, "sxyz")
        X[:3, 3] = [float(v) for v in (origin.get("xyz") or "0 0 0").split()]
    return X


if __name__ == "__main__":
    sys.exit(main())
