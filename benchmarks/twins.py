"""What a rule says of a robot in which one number was broken: `python benchmarks/twins.py ROBOTS [--only so101 …]`.

ROBOTS holds public repositories by owner+name, checked out, such as `TheRobotStudio+SO-ARM100/`; a robot that is not
there is left out. Of each, twins are made below a temporary folder: the same URDF with one number broken. A twin is
right where it has findings (errors and warnings) of the expected rule about the broken thing that the robot has not,
and of no other rule. One line a twin, and at the end a table of robots and rules; the exit code is 1 where one is not
right. Without `--only` and `--breaks` three robots and more are taken for each rule (`CHOSEN`).
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree
from scipy.spatial import ConvexHull

import kinform
from kinform.consistency.comparisons.answers import answers
from kinform.consistency.comparisons.sides import Pair, sides_of
from kinform.design import Design
from kinform.formats.description.mesh_files import MeshFiles
from kinform.model.descriptions import DescribedLink
from kinform.model.findings import Finding

ROBOTS = {
    "so101": "TheRobotStudio+SO-ARM100/Simulation/SO101/so101_new_calib.urdf",
    "duck_bdx": "apirrone+Open_Duck_Mini/mini_bdx/robots/bdx/robot.urdf",
    "toddler_active": "hshi74+toddlerbot/toddlerbot/descriptions/assemblies/toddlerbot_active/toddlerbot_active.urdf",
    "so100": "TheRobotStudio+SO-ARM100/Simulation/SO100/so100.urdf",
    "finger_edu": "Gepetto+example-robot-data/robots/finger_edu_description/robots/finger_edu.urdf",
    "2wheels": "Rhoban+onshape-to-robot-examples/2wheels_urdf/robot.urdf",
    "cassie_like": "Gepetto+example-parallel-robots/robots/cassie_like/robot.urdf",
    "robot_delta": "Gepetto+example-parallel-robots/robots/robot_delta/robot.urdf",
    "adjustable_height_arm": "Rhoban+onshape-to-robot-examples/adjustable_height_arm_urdf/robot.urdf",
    "spot_mini_mini": "OpenQuadruped+spot_mini_mini/spotmicro/util/pybullet_data/assets/urdf/spot.urdf",
    "toddler_xm430": "hshi74+toddlerbot/toddlerbot/descriptions/assemblies/sysID_XM430/sysID_XM430.urdf",
    "solo12": "Gepetto+example-robot-data/robots/solo_description/robots/solo12.urdf",
}
AXIS_OFF = 0.003
"""m."""
NEAR = math.radians(3.0)
"""Ends of joints that are nearer to the drawn pose are left alone."""

Break = Callable[["Twin"], tuple[str, str] | None]
"""Breaks a number; the code that is expected and the name that it is about, or None where the robot has no place."""


@dataclass
class Twin:
    """The XML of a robot to be broken, and what is known of the whole one."""

    root: Any
    whole: Design

    def link(self, name: str) -> Any:
        """The element of a link."""
        return next(e for e in self.root.iter("link") if e.get("name") == name)

    def joint(self, name: str) -> Any:
        """The element of a joint."""
        return next(e for e in self.root.iter("joint") if e.get("name") == name)

    def heaviest(self) -> Any:
        """The link with geometry and the largest mass, of those of which nothing is told as they are."""
        told = {name for f in self.whole.report.findings if "KF110" <= f.code <= "KF132" for name in f.subject}
        links = [
            e for e in self.root.iter("link")
            if e.find("inertial") is not None and e.find("visual") is not None and e.get("name") not in told
        ]  # fmt: skip
        return max(links, key=lambda e: float(e.find("inertial/mass").get("value")))

    def inside(self, link: DescribedLink, centre: np.ndarray) -> bool:
        """Whether a point in the frame of a link is in the hull of its geometry."""
        parts = [part for part in self.whole.assembly.parts if part.name in link.parts and part.mesh is not None]
        if not parts:
            return False
        points = np.concatenate([p.mesh.vertices @ p.X_WP[:3, :3].T + p.X_WP[:3, 3] for p in parts if p.mesh])
        sides = ConvexHull(points).equations
        return bool((sides[:, :3] @ (link.rotation @ centre + link.position) + sides[:, 3]).max() <= 0.0)

    def weight(self, pair: Pair) -> float:
        """The stated mass of the right one of two links; 0 without."""
        return 0.0 if pair.right.stated is None else pair.right.stated.value

    def agreeing(self) -> Iterator[str]:
        """Joints that contact confirms."""
        held = {answer.name for answer in answers(self.whole) if answer.answer == "agrees"}
        turning = {joint.name for joint in self.whole.assembly.function.joints if joint.type == "revolute"}
        return (e.get("name") for e in self.root.iter("joint") if e.get("name") in held & turning)


def _scale(element: Any, key: str, factor: float) -> None:
    element.set(key, repr(float(element.get(key) or 0.0) * factor))


def _numbers(element: Any, key: str) -> np.ndarray:
    return np.array([float(v) for v in (element.get(key) or "0 0 0").split()])


def _put(element: Any, key: str, values: np.ndarray) -> None:
    element.set(key, " ".join(repr(float(v)) for v in values))


def axis_off(twin: Twin) -> tuple[str, str] | None:
    """A joint 3 mm beside its axis, and everything on it back where it was."""
    name = next(twin.agreeing(), None)
    if name is None:
        return None
    joint = twin.joint(name)
    axis = _numbers(joint.find("axis"), "xyz")
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across *= AXIS_OFF / np.linalg.norm(across)  # in the frame of the child
    origin = joint.find("origin")
    roll, pitch, yaw = _numbers(origin, "rpy")
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    R = np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                  [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], [-sp, cp * sr, cp * cr]])  # fmt: skip
    _put(origin, "xyz", _numbers(origin, "xyz") + R @ across)
    child = joint.find("child").get("link")
    below = [
        e for e in twin.root.iter("joint") if e.find("parent") is not None and e.find("parent").get("link") == child
    ]
    inside = twin.link(child).xpath("visual|collision|inertial")
    for element in (*below, *inside):
        place = element.find("origin")
        if place is None:
            place = etree.SubElement(element, "origin")
        _put(place, "xyz", _numbers(place, "xyz") - across)
    return "KF404", name


def inertia_in_gram_millimetres(twin: Twin) -> tuple[str, str] | None:
    """Inertias of a link in g·mm²."""
    link = twin.heaviest()
    for key in link.find("inertial/inertia").keys():  # noqa: SIM118 - an element, not a dict
        _scale(link.find("inertial/inertia"), key, 1e9)
    return "KF123", link.get("name")


def mass_in_grams(twin: Twin) -> tuple[str, str] | None:
    """Mass and inertia of a link in grams."""
    link = twin.heaviest()
    _scale(link.find("inertial/mass"), "value", 1e3)
    for key in link.find("inertial/inertia").keys():  # noqa: SIM118
        _scale(link.find("inertial/inertia"), key, 1e3)
    return "KF123", link.get("name")


def mesh_in_millimetres(twin: Twin) -> tuple[str, str] | None:
    """The meshes of a link a thousand times too large."""
    link = twin.heaviest()
    for mesh in link.xpath("visual/geometry/mesh|collision/geometry/mesh"):
        scale = _numbers(mesh, "scale") if mesh.get("scale") else np.ones(3)
        _put(mesh, "scale", 1e3 * scale)
    return "KF110", link.get("name")


def limit_too_wide(twin: Twin) -> tuple[str, str] | None:
    """A limit 30° beyond the end that the parts leave."""
    told = [finding for finding in twin.whole.report.findings if finding.code in ("KF412", "KF415")]
    known = {name for finding in told for name in finding.subject}
    run = twin.whole.simulation
    derived = {a.joint: a.name for a in answers(twin.whole) if a.answer in ("agrees", "not held", "no contact")}
    for reach in () if run is None or run.ranges is None else run.ranges:
        name = derived.get(reach.joint)
        limit = None if name is None else twin.joint(name).find("limit")
        ends = [end.value for end in (reach.lower, reach.upper) if end is not None and end.status == "found"]
        if limit is not None and name not in known and ends and NEAR < max(map(abs, ends)) < math.radians(150.0):
            wide = max(map(abs, ends)) + math.radians(30.0)
            limit.set("lower", repr(-wide))
            limit.set("upper", repr(wide))
            return "KF412", str(name)
    return None


def limits_exchanged(twin: Twin) -> tuple[str, str] | None:
    """The limits of a joint the wrong way round."""
    for joint in twin.root.iter("joint"):
        limit = joint.find("limit")
        if joint.get("type") == "revolute" and limit is not None and limit.get("lower") != limit.get("upper"):
            lower, upper = limit.get("lower"), limit.get("upper")
            limit.set("lower", upper)
            limit.set("upper", lower)
            return "KF415", joint.get("name")
    return None


def limits_zero(twin: Twin) -> tuple[str, str] | None:
    """A joint that may not move."""
    for joint in twin.root.iter("joint"):
        limit = joint.find("limit")
        if joint.get("type") == "revolute" and limit is not None and limit.get("lower") != limit.get("upper"):
            limit.set("lower", "0")
            limit.set("upper", "0")
            return "KF415", joint.get("name")
    return None


def centre_in_millimetres(twin: Twin) -> tuple[str, str] | None:
    """The centre of mass of a link 0.5 m away."""
    link = twin.heaviest()
    origin = link.find("inertial/origin")
    _put(origin, "xyz", _numbers(origin, "xyz") + [0.5, 0.0, 0.0])
    return "KF124", link.get("name")


def inertia_impossible(twin: Twin) -> tuple[str, str] | None:
    """A moment of inertia of a link that is larger than the sum of the others."""
    link = twin.heaviest()
    inertia = link.find("inertial/inertia")
    inertia.set("ixx", repr(2.5 * (float(inertia.get("iyy")) + float(inertia.get("izz")))))
    return "KF121", link.get("name")


def collision_small(twin: Twin) -> tuple[str, str] | None:
    """The collision geometry of a link a small box at its centre of mass."""
    link = twin.heaviest()
    for collision in link.findall("collision"):
        link.remove(collision)
    made = etree.SubElement(link, "collision")
    made.append(etree.fromstring(etree.tostring(link.find("inertial/origin"))))
    etree.SubElement(etree.SubElement(made, "geometry"), "box").set("size", "0.01 0.01 0.01")
    return "KF130", link.get("name")


def collision_missing(twin: Twin) -> tuple[str, str] | None:
    """A collision mesh that is not there."""
    link = twin.heaviest()
    made = etree.SubElement(etree.SubElement(etree.SubElement(link, "collision"), "geometry"), "mesh")
    made.set("filename", "gone.stl")
    return "KF131", "gone.stl"


def visual_missing(twin: Twin) -> tuple[str, str] | None:
    """One more visual mesh of a link, which is not there."""
    link = twin.heaviest()
    made = etree.SubElement(etree.SubElement(etree.SubElement(link, "visual"), "geometry"), "mesh")
    made.set("filename", "gone.stl")
    return "KF131", "gone.stl"


def not_mirrored(twin: Twin) -> tuple[str, str] | None:
    """A right link with the centre of mass of the left one, as far to the wrong side."""
    for description in twin.whole.assembly.descriptions:
        sides = sides_of(description)
        for pair in () if sides is None else sorted(sides.pairs, key=twin.weight, reverse=True):
            origin = twin.link(pair.right.name).find("inertial/origin")
            shift = pair.right.rotation.T @ (sides.mirror.A @ [0.0, 1.0, 0.0])
            if origin is None or not sides.agrees(pair):
                continue
            for way in (0.012, -0.012):  # where the link is thin, the other way stays in it
                moved = _numbers(origin, "xyz") + way * shift
                if twin.inside(pair.right, moved):
                    _put(origin, "xyz", moved)
                    return "KF132", pair.right.name
    return None


BREAKS: tuple[Break, ...] = (
    axis_off, inertia_in_gram_millimetres, mass_in_grams, mesh_in_millimetres, limit_too_wide, limits_exchanged,
    limits_zero, centre_in_millimetres, inertia_impossible, collision_small, collision_missing, visual_missing,
    not_mirrored,
)  # fmt: skip
_OF_LINKS = tuple(make.__name__ for make in BREAKS if make not in (axis_off, limit_too_wide, not_mirrored))
_OF_JOINTS = ("limits_exchanged", "limits_zero")
CHOSEN: dict[str, tuple[str, ...]] = {
    "toddler_xm430": ("axis_off",),
    "finger_edu": _OF_LINKS,
    "2wheels": tuple(name for name in _OF_LINKS if name not in _OF_JOINTS),
    "robot_delta": (*_OF_LINKS, "limit_too_wide"),
    "so100": ("axis_off", "limits_exchanged", "limits_zero"),
    "solo12": ("limits_exchanged", "limits_zero", "not_mirrored"),
    "so101": ("axis_off",),
    "toddler_active": ("limit_too_wide", "not_mirrored"),
    "duck_bdx": ("axis_off", "limit_too_wide", "not_mirrored"),
}
"""What is broken of which robot where nothing is asked for: robots that have a place for it, the quick ones first."""


def absolute(root: Any, path: Path) -> None:
    """Meshes by their full paths, so that the twin may lie anywhere."""
    files = MeshFiles(path.resolve(), {})
    for mesh in root.iter("mesh"):
        found = files.find(mesh.get("filename") or "")
        if found.path is not None:
            mesh.set("filename", str(found.path.resolve()))


def told(design: Design) -> set[tuple[str, tuple[str, ...]]]:
    """Errors and warnings, by rule and what they are about."""
    findings: tuple[Finding, ...] = design.report.findings
    return {(f.code, f.subject) for f in findings if f.severity != "note"}


def twins_of(name: str, path: Path, folder: Path, only: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Make, run and tell all twins of one robot: what was broken, the rule, and what came of it."""
    parser = etree.XMLParser(remove_comments=True, recover=True)
    text = etree.parse(str(path), parser)
    absolute(text.getroot(), path)
    source = folder / "robot.urdf"
    source.write_bytes(etree.tostring(text))
    output = folder / "robot.h5"
    whole = kinform.run(source, output, allow_outside=True, ranges=True).design
    before = told(whole)
    for make in BREAKS:
        if only and make.__name__ not in only:
            continue
        twin = Twin(etree.fromstring(etree.tostring(text)), whole)
        expected = make(twin)
        if expected is None:
            print(f"{name:22} {make.__name__:28} no place for it", flush=True)
            yield make.__name__, "", "-"
            continue
        source.write_bytes(etree.tostring(twin.root))
        after = told(kinform.run(source, output, allow_outside=True, ranges=True).design)
        new = after - before
        code, subject = expected
        about = any(c == code and any(subject in word for word in s) for c, s in new)
        # a rule with many findings tells three of them: where one of these goes, another of the robot's own comes up
        known = {c for c, _ in before}
        others = sorted({c for c, s in new if c not in known or any(subject in word for word in s)} - {code})
        print(f"{name:22} {make.__name__:28} {code} {'told' if about else 'NOT TOLD'} of {subject}"
              + (f"; ALSO {', '.join(others)}" if others else ""), flush=True)  # fmt: skip
        yield make.__name__, code, "yes" if about and not others else "NO"


def table(rows: dict[str, dict[str, tuple[str, str]]]) -> str:
    """Robots down, what was broken across."""
    kinds = [make.__name__ for make in BREAKS if any(make.__name__ in row for row in rows.values())]
    lines = [f"{k}: {kind} ({code_of(rows, kind)})" for k, kind in enumerate(kinds)]
    lines += ["", f"{'':22}" + "".join(f"{k:>5}" for k in range(len(kinds)))]
    for name, row in rows.items():
        lines.append(f"{name:22}" + "".join(f"{row.get(kind, ('', ''))[1]:>5}" for kind in kinds))
    right = [sum(row.get(kind, ("", ""))[1] == "yes" for row in rows.values()) for kind in kinds]
    return "\n".join([*lines, f"{'robots':22}" + "".join(f"{n:>5}" for n in right)])


def code_of(rows: dict[str, dict[str, tuple[str, str]]], kind: str) -> str:
    """The rule that is to tell of a break."""
    return next((row[kind][0] for row in rows.values() if row.get(kind, ("", ""))[0]), "no place")


def main() -> int:
    """Command line."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("robots", type=Path)
    options.add_argument("--only", nargs="*", default=[], help="robots")
    options.add_argument("--breaks", nargs="*", default=[], help="names of what is broken")
    asked = options.parse_args()
    chosen = {} if asked.only or asked.breaks else CHOSEN
    rows: dict[str, dict[str, tuple[str, str]]] = {}
    for name in chosen or ROBOTS:
        path = asked.robots / ROBOTS[name]
        if asked.only and name not in asked.only:
            continue
        if not path.is_file():
            print(f"{name:22} is not there: left out")
            continue
        with tempfile.TemporaryDirectory() as folder:
            made = twins_of(name, path, Path(folder), chosen.get(name, asked.breaks))
            rows[name] = {kind: (code, said) for kind, code, said in made}
    print(f"\n{table(rows)}")
    return 1 if any(said == "NO" for row in rows.values() for _, said in row.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
