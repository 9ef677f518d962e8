"""A robot as the tables of a manifest: links are groups, shapes parts, joints function, inertials stated masses.

A link without geometry is a stick body. Lengths are in the unit that is asked for, angles in degrees, as in any
manifest; the meshes keep their own metres.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from kinform.form.constants import LARGEST_NUMBER
from kinform.form.readers.places import Places
from kinform.form.sources import Source, SourceTables
from kinform.formats.description.facts import facts_of
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.robot import At, Inertial, Link, Robot, RobotJoint, Shape, Solid
from kinform.formats.description.tree import distinct
from kinform.formats.registry import ROBOT_FORMATS, reader_of
from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.name_hints import first_names, in_quotes
from kinform.foundation.regular_files import not_a_file
from kinform.foundation.rounding import ARITHMETIC
from kinform.foundation.units import METRES_PER_UNIT, metres_per
from kinform.model.arrays import Array


def tables(source: Source) -> SourceTables | None:
    """The tables of a robot description; every problem is noted."""
    fault = not_a_file(source.path)
    if fault is not None:
        source.problems.add(fault, source.file, None, "write the description to a file")
        return None
    try:
        data = source.boundary.read(source.path)
    except OSError as error:
        source.problems.add(f"cannot be read: {error.strerror}", source.file, None, "name a robot description")
        return None
    read = reader_of(source.path, data)
    if read is None:
        roots = first_names(
            f"<{f.root}> ({f.title})" for f in ROBOT_FORMATS if source.path.suffix.lower() in f.suffixes
        )
        source.problems.add(f"is no robot description: its root is none of {roots}", source.file, 1,
                            "name a manifest (TOML), or a description")  # fmt: skip
        return None
    packages = {name: Path(folder) for name, folder in source.reading.packages}
    meshes = MeshFiles(source.path, packages, boundary=source.boundary)
    meshes.runs_xacro = source.reading.allow_xacro
    before = len(source.problems)
    robot = read(source.path, data, source.file, source.problems, meshes)
    if robot is None or len(source.problems) > before:
        return None
    writer = _Writer(source)
    writer.write(robot)
    facts = facts_of(robot, source.file, source.reading.geometry, writer.parts, writer.absent)
    return SourceTables(writer.raw, Places(writer.places), (*robot.notes, *writer.notes), robot.files,
        facts=facts, unsettled=robot.unsettled,
    )  # fmt: skip


class _Writer:
    """Fills the tables; each with the place at which the description says it."""

    def __init__(self, source: Source):
        self.source = source
        self.metres = metres_per(source.units or "m")
        self.raw: dict[str, Any] = {"schema": 1, "assembly": {}, "part": [], "group": [], "function": {}}
        self.places: dict[tuple[str | int, ...], tuple[str | None, int]] = {}
        self.notes: list[str] = []
        self.parts: dict[str, list[str]] = {}
        self.absent: dict[str, tuple[Shape, ...]] = {}

    def write(self, robot: Robot) -> None:
        """All of a robot."""
        self._put(robot.at, ("assembly",))
        self.raw["assembly"] = {"name": robot.name, "units": self.source.units or "m"}
        geometry = self.source.reading.geometry
        self.absent = absent_shapes(robot, geometry)
        self._note_absent()
        taken = {link.name for link in robot.links}
        free, held = distinct(taken), {link.name for link in robot.links if self._shapes(link, geometry)}
        for link in robot.links:
            self._link(link, geometry, free)
        if robot.root is not None and (robot.root in held or any(p["name"] == robot.root for p in self.raw["part"])):
            self.raw["assembly"]["ground"] = robot.root
        function = self.raw["function"]
        self._put(robot.at, ("function",))
        function["complete"] = True
        for key in ("joint", "coupling", "drive", "require"):
            function[key] = []
        for joint in robot.joints:
            self._joint(joint)
        kinds = {joint.name: joint.type for joint in robot.joints}
        for ratio in robot.ratios:
            strange = [name for name in ratio.joints if name not in kinds]
            if strange:
                message = f"a coupling names {in_quotes(strange[0])}, which is no joint"
                self.source.problems.add(message, ratio.at.file, ratio.at.line, "name two joints")
                continue
            first, second = (self._value(kinds[name]) for name in ratio.joints)
            self._add("coupling", ratio.at, {"joints": list(ratio.joints), "ratio": ratio.ratio * second / first})
        if not held:
            other = [name for name in ("visual", "collision") if any(link.shapes(name) for link in robot.links)]
            hint = f": it has {other[0]} geometry (--geometry {other[0]})" if other else ""
            self.notes.append(f"{self.source.file}: no link has {geometry} geometry{hint}")

    def _put(self, at: At, path: tuple[str | int, ...]) -> None:
        self.places[path] = (at.file, at.line)

    def _add(self, array: str, at: At, table: dict[str, Any]) -> dict[str, Any]:
        """Add a table to an array of the manifest, or of its function."""
        top = array in ("part", "group")
        tables = self.raw[array] if top else self.raw["function"][array]
        self._put(at, (array, len(tables)) if top else ("function", array, len(tables)))
        tables.append(table)
        return table

    def _shapes(self, link: Link, geometry: str) -> tuple[Shape, ...]:
        """The shapes of a link that can be had."""
        absent = self.absent.get(link.name, ())
        return tuple(shape for shape in link.shapes(geometry) if shape not in absent)

    def _note_absent(self) -> None:
        shapes = [(name, shape) for name, shapes in self.absent.items() for shape in shapes]
        if shapes:
            files = first_names(dict.fromkeys(Path(str(shape.geometry)).name for _, shape in shapes))
            links = first_names(dict.fromkeys(in_quotes(name) for name, _ in shapes))
            self.notes.append(f"{self.source.file}: meshes that do not exist are left out: {files} (of {links})")

    def _link(self, link: Link, geometry: str, free: Any) -> None:
        shapes = self._shapes(link, geometry)
        if not shapes:
            part = self._add("part", link.at, {"name": link.name, **self._posed(link.X_FL)})
            self.parts[link.name] = [link.name]
            if link.inertial is not None and not link.inertial.inertia.any():
                self.notes.append(f"link {in_quotes(link.name)}, a frame, states no inertia: it has no mass")
            elif link.inertial is not None:
                part |= self._mass(link.inertial, link.X_FL)
                self._put(link.inertial.at, ("part", len(self.raw["part"]) - 1, "mass"))
            return
        names = self.parts[link.name] = [self._part(link, shape, free) for shape in shapes]
        group = self._add("group", link.at, {"name": link.name, "parts": names})
        if link.inertial is not None:
            group |= self._mass(link.inertial, np.eye(4))
            for key in ("mass", "centre_of_mass", "inertia"):
                self._put(link.inertial.at, ("group", len(self.raw["group"]) - 1, key))

    def _part(self, link: Link, shape: Shape, free: Any) -> str:
        name = free(_label(link, shape))
        table: dict[str, Any] = {"name": name}
        if isinstance(shape.geometry, Solid):
            table["shape"] = shape_table(shape.geometry, self.metres)
        else:
            path = os.path.relpath(shape.geometry, self.source.folder.resolve())
            table["mesh"] = Path(path).as_posix()
            unit, scale = _unit_and_scale(shape.metres, shape.scale)
            if unit != (self.source.units or "m"):
                table["units"] = unit
            if scale != (1.0, 1.0, 1.0):
                table["scale"] = list(scale)
        if shape.colour is not None:
            table["colour"] = shape.colour
        self._add("part", shape.at, table | self._posed(shape.X_FG))
        return str(name)

    def _posed(self, X: Array) -> dict[str, Any]:
        out: dict[str, Any] = {}
        if X[:3, 3].any():
            out["position"] = [float(v) / self.metres for v in X[:3, 3]]
        if not np.array_equal(X[:3, :3], np.eye(3)):
            out["quaternion"] = [float(v) for v in quaternions(X[None, :3, :3])[0]]
        return out

    def _mass(self, inertial: Inertial, X_FP: Array) -> dict[str, Any]:
        """Mass keys about the frame P."""
        R, p = X_FP[:3, :3], X_FP[:3, 3]
        inertia = R.T @ inertial.inertia @ R
        return {
            "mass": float(inertial.mass),
            "centre_of_mass": [float(v) / self.metres for v in R.T @ (inertial.centre - p)],
            "inertia": [[float(v) for v in row] for row in 0.5 * (inertia + inertia.T)],
        }

    def _value(self, kind: str) -> float:
        """SI in one unit of a joint's value in the manifest."""
        return self.metres if kind == "prismatic" else math.pi / 180.0

    def _joint(self, joint: RobotJoint) -> None:
        table: dict[str, Any] = {"name": joint.name, "between": list(joint.between), "type": joint.type}
        for key, value in (("axis", joint.axis), ("axis2", joint.axis2)):
            if value is not None:
                table[key] = [float(v) for v in value]
        if joint.point is not None:
            table["point"] = [float(v) / self.metres for v in joint.point]
        if joint.pitch is not None:
            table["pitch"] = joint.pitch / self.metres
        if joint.range is not None:
            bounds = (bound / self._value(joint.type) for bound in joint.range)
            # what writers put in place of no bound is the largest number that they know
            free = (math.copysign(math.inf, bound) if abs(bound) > LARGEST_NUMBER else bound for bound in bounds)
            table["range"] = list(free)
        if joint.closure:
            table["closure"] = True
        self._add("joint", joint.at, table)
        if joint.damping is not None:
            self._add("drive", joint.at, {"joint": joint.name, "kind": "damper", "damping": joint.damping})
        if joint.stiffness is not None:
            rest = joint.rest / self._value(joint.type)
            self._add("drive", joint.at,
                      {"joint": joint.name, "kind": "spring", "stiffness": joint.stiffness, "rest": rest})  # fmt: skip
        if joint.effort is not None:
            self._limit(joint, "torque", "effort", joint.effort)
        if joint.speed is not None:
            self._limit(joint, "speed", "speed", joint.speed / self._value(joint.type))

    def _limit(self, joint: RobotJoint, kind: str, word: str, limit: float) -> None:
        if limit > LARGEST_NUMBER:
            return
        table = {"name": f"{word} of {joint.name}", "kind": kind, "joint": joint.name, "limit": limit}
        self._add("require", joint.at, table | {"when_run": True})


def absent_shapes(robot: Robot, geometry: str) -> dict[str, tuple[Shape, ...]]:
    """By link the shapes whose meshes are not there, where some others are: the robot is judged without them, which a
    rule tells. Without any mesh there is nothing to judge: then each one is wrong input."""
    shapes = {link.name: [s for s in link.shapes(geometry) if isinstance(s.geometry, Path)] for link in robot.links}
    there = {s.geometry for own in shapes.values() for s in own if isinstance(s.geometry, Path) and s.geometry.exists()}
    if not there:
        return {}
    absent = {name: tuple(s for s in own if s.geometry not in there) for name, own in shapes.items()}
    return {name: own for name, own in absent.items() if own}


def _label(link: Link, shape: Shape) -> str:
    """The name of a part before it is made distinct: as the description says, else that of its file."""
    if shape.name:
        return shape.name if shape.name != link.name else f"{shape.name} shape"
    if isinstance(shape.geometry, Solid):
        return f"{link.name} {shape.geometry.type}"
    stem = shape.geometry.stem or f"{link.name} mesh"  # a folder, which is told later, may have none
    return stem if stem != link.name else shape.geometry.name


def shape_table(solid: Solid, metres: float) -> dict[str, Any]:
    """A primitive as `[[part]] shape` says it, in units of `metres`."""
    sizes = [float(size) / metres for size in solid.sizes]
    if solid.type == "box":
        return {"type": "box", "size": sizes}
    if solid.type == "ellipsoid":
        return {"type": "ellipsoid", "radii": sizes}
    out = {"type": solid.type, "radius": sizes[0]}
    return out if solid.type == "sphere" else out | {"length": sizes[1]}


def _unit_and_scale(metres: float, scale: tuple[float, float, float]) -> tuple[str, tuple[float, ...]]:
    """A unit of length, and what is left of the scale of a mesh that is in it: 0.001 is said as mm."""
    for unit in ("m", "mm", "cm"):
        if all(math.isclose(abs(s) * metres, METRES_PER_UNIT[unit], rel_tol=ARITHMETIC) for s in scale):
            return unit, tuple(math.copysign(1.0, s) for s in scale)
    return "m", tuple(s * metres for s in scale)
