"""`[function]`, `[simulation]` and `[[assume]]` of one manifest, in SI, the world, and with full names."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pydantic import BaseModel

from kinform.form.files import Sources
from kinform.form.manifest.common import Quantity
from kinform.form.problems import did_you_mean, quoted
from kinform.form.readers.csv_tables import columns, path_rows
from kinform.form.readers.requirements import faults
from kinform.form.readers.scope import Scope
from kinform.model.assembly import Assumption
from kinform.model.checks import CheckSettings, Ignore
from kinform.model.function import (
    Coupling,
    Drive,
    InitialValue,
    IntendedJoint,
    Law,
    Load,
    Requirement,
    SimulationRequest,
)

__all__ = ["Purposes"]

OUTPUTS = 1_000_000
"""Output times of a run: more would fill the memory before anything is solved."""

AXIS = ("revolute", "prismatic", "cylindrical", "planar", "screw", "universal")
POINT = ("revolute", "cylindrical", "spherical", "screw", "universal")
LINEAR = ("prismatic",)


class Purposes:
    """Reads one scope; `places` are the full names of all parts and groups, `joints` of all intended joints
    with their types."""

    def __init__(self, scope: Scope, sources: Sources, places: set[str], joints: dict[str, str]):
        self.scope, self.sources, self.places, self.joints = scope, sources, places, joints

    def place(self, name: str, *path: str | int) -> str:
        """Full name of a part or group; a problem when there is none."""
        return self._known(name, self.places, "part or group", "the parts and groups", *path)

    def joint(self, name: str, *path: str | int) -> str:
        """Full name of an intended joint, or a name that kinform will give ("a~b")."""
        if "~" in name:
            return self.scope.prefix + name if self.scope.prefix else name
        return self._known(name, set(self.joints), "[[function.joint]]", "[[function.joint]]", *path)

    def _known(self, name: str, known: set[str], what: str, all_of: str, *path: str | int) -> str:
        full = self.scope.prefix + name
        if full not in known and name not in self.scope.refused:
            prefix = self.scope.prefix
            near = [k.removeprefix(prefix) for k in known if k.startswith(prefix)]
            self.scope.complain(f"there is no {what} {quoted(name)}", did_you_mean(name, near, all_of), *path)
        return full

    def pair(self, names: list[str], resolve: Callable[..., str], *path: str | int) -> tuple[str, str]:
        """Two full names that differ."""
        first, second = (resolve(name, *path) for name in names)
        if first == second:
            self.scope.complain(f"both sides are {quoted(names[0])}", "name two different ones", *path)
        return first, second

    def geometry(self, table: Any, kind: str, what: str, *path: str | int) -> tuple[Any, Any, Any, float | None]:
        """axis, axis2, point, pitch of a joint of this type; a problem for each that is missing."""
        scope = self.scope
        needed = {
            "axis": kind in AXIS, "point": kind in POINT, "axis2": kind == "universal", "pitch": kind == "screw",
        }  # fmt: skip
        for key, need in needed.items():
            if need and getattr(table, key) is None:
                scope.complain(f"{what}: a {kind} joint needs {key}", f"add {key}", *path)
        axis = scope.direction(table.axis, *path, "axis")
        axis2 = scope.direction(table.axis2, *path, "axis2")
        if axis is not None and axis2 is not None and np.linalg.norm(np.cross(axis, axis2)) < 1e-6:
            scope.complain(f"{what}: axis and axis2 are parallel", "give two different axes", *path, "axis2")
        pitch = None if table.pitch is None else table.pitch * scope.metres
        if pitch == 0.0:
            scope.complain(f"{what}: the pitch is zero", "give the length a turn", *path, "pitch")
        return axis, axis2, scope.point(table.point), pitch

    def assumptions(self) -> list[Assumption]:
        """`[[assume]]`."""
        out = []
        for k, table in enumerate(self.scope.manifest.assume):
            path = ("assume", k)
            what = f"[[assume]] {k + 1}"
            if table.ignore == (table.type is not None):
                self.scope.complain(f"{what}: give either type or ignore = true", "remove one of them", *path)
            between = self.pair(table.between, self.place, *path, "between")
            axis, _, point, pitch = (
                (None, None, None, None) if table.type is None else self.geometry(table, table.type, what, *path)
            )
            out.append(
                Assumption(
                    between,
                    table.type,
                    table.ignore,
                    axis,
                    point,
                    pitch,
                    table.reason,
                    self.scope.source(*path),
                )
            )
        return out

    def intended(self) -> list[IntendedJoint]:
        """`[[function.joint]]`."""
        function = self.scope.manifest.function
        out = []
        for k, table in enumerate(function.joint if function else []):
            path = ("function", "joint", k)
            what = f"[[function.joint]] {quoted(table.name)}"
            between = self.pair(table.between, self.place, *path, "between")
            axis, axis2, point, pitch = self.geometry(table, table.type, what, *path)
            out.append(
                IntendedJoint(
                    self.scope.prefix + table.name, between, table.type, axis, axis2, point, pitch,
                    self._range(table, what, *path), self.scope.file, self.scope.line(*path),
                )
            )  # fmt: skip
        return out

    def _range(self, table: Any, what: str, *path: str | int) -> tuple[float, float] | None:
        if table.range is None:
            return None
        lower, upper = table.range
        if not lower < upper:
            self.scope.complain(f"{what}: the range [{lower}, {upper}] is not ascending", "swap it", *path, "range")
        scale = self.scope.metres if table.type in LINEAR else math.pi / 180.0
        return lower * scale, upper * scale

    def couplings(self) -> list[Coupling]:
        """`[[function.coupling]]`; the ratio from degrees and lengths to SI values."""
        function = self.scope.manifest.function
        out = []
        for k, table in enumerate(function.coupling if function else []):
            path = ("function", "coupling", k)
            first, second = self.pair(table.joints, self.joint, *path, "joints")
            if table.ratio == 0.0:
                self.scope.complain("the ratio of a coupling is zero", "give value(a) / value(b)", *path, "ratio")
            scales = [self._value_scale(name, *path, "joints") for name in (first, second)]
            ratio = table.ratio * scales[0] / scales[1]
            out.append(Coupling((first, second), ratio, self.scope.file, self.scope.line(*path)))
        return out

    def _value_scale(self, joint: str, *path: str | int) -> float:
        """Radians or metres in a manifest's value of the joint; a problem where it is not stated which it is."""
        if joint not in self.joints and "~" in joint:
            self.scope.complain(
                f"whether {quoted(joint.removeprefix(self.scope.prefix))} turns or slides is not stated, so its values have no unit",
                "state the joint as a [[function.joint]], and use its name here", *path,
            )  # fmt: skip
        return self.scope.metres if self.joints.get(joint) in LINEAR else math.pi / 180.0

    def drives(self) -> list[Drive]:
        """`[[function.drive]]`."""
        function = self.scope.manifest.function
        out = []
        for k, table in enumerate(function.drive if function else []):
            path = ("function", "drive", k)
            given = table.model_dump(exclude={"joint", "kind", "law"}, exclude_none=True, exclude_unset=True)
            law = self._law(getattr(table, "law", None), *path, "law")
            if table.kind == "dc_motor":
                if (law is None) == (table.voltage is None):
                    self.scope.complain("a dc_motor needs either voltage or law", "give one of them", *path)
                if table.gear == 0.0:
                    self.scope.complain("the gear of a dc_motor is zero", "give motor turns a turn", *path, "gear")
            out.append(
                Drive(
                    self.joint(table.joint, *path, "joint"), table.kind, law,
                    {key: float(value) for key, value in given.items()},
                    self.scope.metres, self.scope.file, self.scope.line(*path),
                )
            )  # fmt: skip
        return out

    def _law(self, table: Any, *path: str | int) -> Law | None:
        if table is None:
            return None
        if table.type != "table":
            return Law(**table.model_dump())
        found = self.sources.find(table.file, self.scope.folder, self.scope.file, self.scope.line(*path), "the table")
        if found is None:
            return Law("table", file=table.file)
        shown = self.sources.shown(found)
        times, values = columns(self.scope, found, shown)
        return Law("table", times=times, values=values, file=shown)

    def _path(self, name: str, *path: str | int) -> list[list[float]]:
        scope = self.scope
        found = self.sources.find(name, scope.folder, scope.file, scope.line(*path), "the path")
        return [] if found is None else path_rows(scope, found, self.sources.shown(found))

    def loads(self) -> list[Load]:
        """`[[function.load]]`."""
        function = self.scope.manifest.function
        out = []
        for k, table in enumerate(function.load if function else []):
            path = ("function", "load", k)
            if table.force is None and table.torque is None:
                self.scope.complain("a load has neither force nor torque", "add force = [x, y, z] in N", *path)
            out.append(
                Load(
                    self.place(table.part, *path, "part"), self.scope.vector(table.force),
                    self.scope.vector(table.torque), self.scope.point(table.point), table.frame,
                    self.scope.file, self.scope.line(*path),
                )
            )  # fmt: skip
        return out

    def requirements(self) -> list[Requirement]:
        """`[[function.require]]`, the keys of its kind in SI, the world and full names."""
        function = self.scope.manifest.function
        out = []
        for k, table in enumerate(function.require if function else []):
            path = ("function", "require", k)
            for wrong, remedy, key in faults(table):
                at = path if key is None else (*path, key)
                self.scope.complain(f"requirement {quoted(table.name)}: {wrong}", remedy, *at)
            values = self._quantities(table, *path)
            values = {key: value for key, value in values.items() if key not in ("name", "kind") and value is not None}
            out.append(
                Requirement(
                    self.scope.prefix + table.name,
                    table.kind,
                    values,
                    self.scope.file,
                    self.scope.line(*path),
                )
            )
        return out

    def _quantities(self, table: BaseModel, *path: str | int) -> dict[str, Any]:
        out: dict[str, Any] = {}
        for key, field in type(table).model_fields.items():
            value = getattr(table, key)
            quantity = next((m for m in field.metadata if isinstance(m, Quantity)), None)
            if isinstance(value, BaseModel):
                out[key] = self._quantities(value, *path, key)
            elif quantity is None or value is None:
                out[key] = value
            else:
                out[key] = self._converted(quantity.kind, value, table, *path, key)
                if quantity.kind == "path":
                    out["rows"] = self._path(value, *path, key)
                if quantity.kind == "frame":
                    out["X_WF"] = self.scope.X_WF.tolist()
        return out

    def _converted(self, kind: str, value: Any, table: BaseModel, *path: str | int) -> Any:
        if kind in ("point", "direction", "vector") and (not value or isinstance(value[0], list)):
            return [self._converted(kind, item, table, *path) for item in value]
        if kind in ("place", "part", "joint"):
            resolve = self.joint if kind == "joint" else self.place
            return [resolve(v, *path) for v in value] if isinstance(value, list) else resolve(value, *path)
        if kind == "joint_value":
            return value * self._value_scale(self.scope.prefix + getattr(table, "joint", ""), *path)
        if kind == "joint_values":
            named = [{self.joint(j, *path): v for j, v in pose.items()} for pose in value]
            return [{j: v * self._value_scale(j, *path) for j, v in pose.items()} for pose in named]
        if kind == "path":
            found = self.sources.find(value, self.scope.folder, self.scope.file, self.scope.line(*path), "the path")
            return value if found is None else self.sources.shown(found)
        if kind in ("length", "frame"):
            return (np.array(value) * self.scope.metres).tolist()
        if kind == "angle":
            return math.radians(value)
        convert: dict[str, Callable[[Any], Any]] = {
            "point": self.scope.point,
            "vector": self.scope.vector,
            "direction": lambda v: self.scope.direction(v, *path),
        }
        converted = convert[kind](value)
        return None if converted is None else converted.tolist()

    def check(self) -> CheckSettings:
        """`[check]` of the top manifest."""
        table = self.scope.manifest.check
        if table is None:
            return CheckSettings()
        ignore = tuple(
            Ignore(entry.code, entry.subject, entry.reason, self.scope.file, self.scope.line("check", "ignore", k))
            for k, entry in enumerate(table.ignore)
        )
        return CheckSettings(
            tuple(table.select), tuple(sorted(table.severity.items())), ignore,
            self.scope.file, self.scope.line("check"),
        )  # fmt: skip

    def simulation(self) -> SimulationRequest | None:
        """`[simulation]` of the top manifest."""
        table = self.scope.manifest.simulation
        if table is None:
            return None
        if table.step > table.duration:
            self.scope.complain("the step is longer than the duration", "give a shorter step", "simulation", "step")
        elif table.duration / table.step > OUTPUTS:
            self.scope.complain(
                f"the step gives {table.duration / table.step:.3g} output times, and {OUTPUTS:,} are the most",
                "give a longer step: it is the time between outputs, and the solver chooses its own steps",
                "simulation", "step",
            )  # fmt: skip
        initial = tuple(
            InitialValue(
                self.joint(name, "simulation", "initial", name), value.position, value.velocity,
                self.scope.metres, self.scope.file, self.scope.line("simulation", "initial", name),
            )
            for name, value in sorted(table.initial.items())
        )  # fmt: skip
        return SimulationRequest(
            table.level, table.duration, table.step, np.array(table.gravity, dtype=float), initial,
            self.scope.file, self.scope.line("simulation"),
            tuple(sorted({"duration", "step", "gravity"} - table.model_fields_set)),
        )  # fmt: skip
