"""`[function]`, `[simulation]`, `[check]` and `[[assume]]` of one manifest, in SI, the world, and with full names.

Requirements are read in `requirements`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from kinform.form.constants import LARGEST_NUMBER
from kinform.form.files import DesignFiles
from kinform.form.readers.csv_tables import law_rows
from kinform.form.readers.drive_keys import complain_of_drive, efficiencies
from kinform.form.readers.open_manifest import Scope
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SINGLE
from kinform.model.assembly import Assumption
from kinform.model.checks import CheckSettings, Ignore, Profile
from kinform.model.function import (
    Coupling,
    Drive,
    InitialValue,
    IntendedJoint,
    Law,
    Load,
    MaterialFriction,
    SimulationRequest,
)

OUTPUTS = 1_000_000
"""Output times of a run: more would fill the memory before anything is solved: with 100 columns they are 800 MB."""


NEEDED = {
    "axis": ("revolute", "prismatic", "cylindrical", "planar", "screw", "universal"),
    "point": ("revolute", "cylindrical", "spherical", "screw", "universal"),
    "axis2": ("universal",),
    "pitch": ("screw",),
}
"""Types of joints that need each key."""

LINEAR = ("prismatic",)
"""Types of joints whose value is a length."""


class FunctionReader:
    """Reads one manifest; `places` are the full names of all parts and groups, `joints` of all intended joints
    with their types, `grounds` of sub-assemblies with what holds them; `meshed`: whether any part has a mesh."""

    def __init__(
        self,
        scope: Scope,
        files: DesignFiles,
        places: set[str],
        joints: dict[str, str],
        grounds: dict[str, str] | None = None,
        meshed: bool = True,
    ):
        self.scope, self.files, self.places, self.joints = scope, files, places, joints
        self.grounds, self.meshed = grounds or {}, meshed

    def place(self, name: str, *path: str | int) -> str:
        """Full name of a part or group; a problem when there is none."""
        return self._full_name(name, self.places, "part or group", "the parts and groups", *path)

    def joint(self, name: str, *path: str | int) -> str:
        """Full name of an intended joint, or a name that kinform will give ("a~b")."""
        if "~" in name:
            return self.scope.prefix + name
        return self._full_name(name, set(self.joints), "[[function.joint]]", "[[function.joint]]", *path)

    def _full_name(self, name: str, names: set[str], what: str, all_of: str, *path: str | int) -> str:
        full = self.scope.prefix + name
        if full not in names and name not in self.scope.refused:
            remedy = did_you_mean(name, self.scope.local_names(names), all_of)
            self.scope.complain(f"there is no {what} {in_quotes(name)}", remedy, *path)
        return full

    def file(self, stated: str, what: str, *path: str | int) -> Path | None:
        """A file that the manifest names; a problem when there is none."""
        return self.files.find(stated, self.scope.folder, self.scope.file, self.scope.line(*path), what)

    def pair(self, names: list[str], resolve: Callable[..., str], *path: str | int) -> tuple[str, str]:
        """Two full names that differ."""
        first, second = (resolve(name, *path) for name in names)
        if first == second:
            self.scope.complain(f"both sides are {in_quotes(names[0])}", "name two different ones", *path)
        return first, second

    def geometry(self, table: Any, kind: str, what: str, *path: str | int) -> tuple[Any, Any, Any, float | None]:
        """axis, axis2, point, pitch of a joint of this type; a problem for each that is missing."""
        scope = self.scope
        for key, kinds in NEEDED.items():
            if kind in kinds and getattr(table, key) is None:
                scope.complain(f"{what}: a {kind} joint needs {key}", f"add {key}", *path)
        for key in ("axis2", "pitch"):
            if kind not in NEEDED[key] and getattr(table, key, None) is not None:
                right = f"remove it, or state type = {in_quotes(NEEDED[key][0])}"
                scope.complain(f"{what}: {key} does nothing: a {kind} joint has none", right, *path, key)
        axis = scope.direction(table.axis, *path, "axis")
        axis2 = scope.direction(table.axis2, *path, "axis2")
        if axis is not None and axis2 is not None and np.linalg.norm(np.cross(axis, axis2)) < SINGLE:
            scope.complain(f"{what}: axis and axis2 are parallel", "give two different axes", *path, "axis2")
        pitch = None if table.pitch is None else table.pitch * scope.metres
        if pitch == 0.0:
            scope.complain(f"{what}: the pitch is zero", "give the length a turn", *path, "pitch")
        return axis, axis2, scope.point(table.point), pitch

    def assumptions(self) -> Iterator[Assumption]:
        """`[[assume]]`."""
        for path, table in self.scope.tables("assume"):
            what = f"[[assume]] {path[1] + 1}"
            if table.ignore == (table.type is not None):
                self.scope.complain(f"{what}: give either type or ignore = true", "remove one of them", *path)
            between = self.pair(table.between, self.place, *path, "between")
            axis = point = pitch = None
            if table.type is not None:
                axis, _, point, pitch = self.geometry(table, table.type, what, *path)
            source = self.scope.source(*path)
            yield Assumption(between, table.type, table.ignore, axis, point, pitch, table.reason, source)

    def intended(self) -> Iterator[IntendedJoint]:
        """`[[function.joint]]`."""
        for path, table in self.scope.tables("function", "joint"):
            what = f"[[function.joint]] {in_quotes(table.name)}"
            between = self._sides(table, what, *path)
            geometry = self.geometry(table, table.type, what, *path)
            bounds = self._range(table, what, *path)
            name = self.scope.prefix + table.name
            where = self.scope.where(*path)
            named = len(table.between)
            yield IntendedJoint(
                name, between, table.type, *geometry, bounds, *where, closure=table.closure, named=named
            )

    def _sides(self, table: Any, what: str, *path: str | int) -> tuple[str, str]:
        """Full names of what a joint joins; "" for what contact is to tell, which it cannot without meshes."""
        if len(table.between) == 2:
            return self.pair(table.between, self.side, *path, "between")
        if table.type == "fixed" or not self.meshed:
            why = "a fixed joint" if table.type == "fixed" else "a joint of parts without meshes"
            self.scope.complain(f"{what}: {why} needs both sides", "name two parts or groups in `between`", *path)
        return next((self.side(name, *path, "between") for name in table.between), ""), ""

    def side(self, name: str, *path: str | int) -> str:
        """Full name of a part or group; of a sub-assembly, that of its ground, or of its largest part."""
        return self.grounds.get(self.scope.prefix + name) or self.place(name, *path)

    def _range(self, table: Any, what: str, *path: str | int) -> tuple[float, float] | None:
        if table.range is None:
            return None
        lower, upper = table.range
        if math.isnan(lower) or math.isnan(upper):
            wrong = f"{what}: the range [{lower}, {upper}] has a number that is none"
            self.scope.complain(wrong, "write two numbers, and inf for a side that is free", *path, "range")
        elif not lower < upper:
            remedy = "swap it" if lower > upper else "state how far it goes, or a joint of type fixed"
            self.scope.complain(f"{what}: the range [{lower}, {upper}] is not ascending", remedy, *path, "range")
        if any(LARGEST_NUMBER < abs(value) < math.inf for value in table.range):
            wrong = f"{what}: the range reaches beyond {LARGEST_NUMBER:g}"
            self.scope.complain(wrong, "write inf for a side that is free", *path, "range")
        scale = self.scope.metres if table.type in LINEAR else math.pi / 180.0
        return lower * scale, upper * scale

    def couplings(self) -> Iterator[Coupling]:
        """`[[function.coupling]]`; the ratios from degrees and lengths to SI values."""
        for path, table in self.scope.tables("function", "coupling"):
            ratios = table.ratio if isinstance(table.ratio, list) else [table.ratio]
            if len(ratios) != len(table.joints) - 1:
                self.scope.complain(
                    f"a coupling of {len(table.joints)} joints has {len(ratios)} "
                    + ("ratio" if len(ratios) == 1 else "ratios"),
                    "give one ratio for each joint after the first: value(a) = ratio[0] · value(b) + ratio[1] · …",
                    *path, "ratio",
                )  # fmt: skip
                continue
            if 0.0 in ratios:
                self.scope.complain("the ratio of a coupling is zero", "give value(a) / value(b)", *path, "ratio")
            names = [*self.pair(table.joints[:2], self.joint, *path, "joints")]
            names += [self.joint(name, *path, "joints") for name in table.joints[2:]]
            twice = next((name for k, name in enumerate(names) if k > 1 and name in names[:k]), None)
            if twice is not None:
                named = in_quotes(twice.removeprefix(self.scope.prefix))
                self.scope.complain(f"a coupling names {named} twice", "name each joint once", *path, "joints")
            scales = [self.value_scale(name, *path, "joints") for name in names]
            ratio, *more = (value * scales[0] / scale for value, scale in zip(ratios, scales[1:], strict=True))
            others = dict(zip(names[2:], more, strict=True))
            shares = efficiencies(self.scope, table, *path)
            yield Coupling((names[0], names[1]), ratio, *self.scope.where(*path), others, *shares)

    def value_scale(self, joint: str, *path: str | int) -> float:
        """Radians or metres in a manifest's value of the joint; a problem where it is not stated which it is."""
        if joint not in self.joints and "~" in joint:
            name = in_quotes(joint.removeprefix(self.scope.prefix))
            self.scope.complain(
                f"whether {name} turns or slides is not stated, so its values have no unit",
                "state the joint as a [[function.joint]], and use its name here", *path,
            )  # fmt: skip
        return self.scope.metres if self.joints.get(joint) in LINEAR else math.pi / 180.0

    def drives(self) -> Iterator[Drive]:
        """`[[function.drive]]`."""
        for path, table in self.scope.tables("function", "drive"):
            stated = table.model_dump(
                exclude={"joint", "kind", "law", "freedom"}, exclude_none=True, exclude_unset=True
            )
            law = self._law(getattr(table, "law", None), *path, "law")
            joint = self.joint(table.joint, *path, "joint")
            complain_of_drive(self.scope, table, law is not None, self.joints.get(joint), *path)
            parameters = {key: float(value) for key, value in stated.items()}
            where = self.scope.where(*path)
            yield Drive(joint, table.kind, law, parameters, self.scope.metres, *where, table.freedom or "")

    def frictions(self, materials: Collection[str]) -> Iterator[MaterialFriction]:
        """`[[friction]]`, of these materials; each pair is stated once in a file."""
        lines: dict[tuple[str, ...], int] = {}
        for path, table in self.scope.tables("friction"):
            what = f"[[friction]] {path[1] + 1}"
            for name in table.materials:
                if name not in materials:
                    remedy = did_you_mean(name, materials, "the materials")
                    self.scope.complain(f"{what}: there is no material {in_quotes(name)}", remedy, *path, "materials")
            pair = tuple(sorted(table.materials))
            if pair in lines:
                names = " and ".join(in_quotes(name) for name in pair)
                wrong = f"{what}: the friction of {names} is stated twice: the first is at line {lines[pair]}"
                self.scope.complain(wrong, "keep one of them", *path, "materials")
            lines.setdefault(pair, self.scope.line(*path, "materials"))
            static = table.coefficient if table.static is None else table.static
            if static < table.coefficient:
                wrong = "friction at rest cannot be less than that in motion"
                self.scope.complain(f"{what}: {wrong}", "give static ≥ coefficient", *path, "static")
            first, second = table.materials
            where = self.scope.where(*path)
            yield MaterialFriction((first, second), table.coefficient, static, *where, self.scope.prefix)

    def _law(self, table: Any, *path: str | int) -> Law | None:
        if table is None:
            return None
        if table.type != "table":
            return Law(**table.model_dump())
        if (table.file is None) == (table.times is None or table.values is None):
            self.scope.complain("a table needs either file or times and values", "give one of them", *path)
            return Law("table")
        if table.file is None:
            return self._inline(table, *path)
        file = self.file(table.file, "the table", *path)
        if file is None:
            return Law("table", file=table.file)
        shown = self.files.shown(file)
        times, values = law_rows(self.scope, file, shown)
        return Law("table", times=times, values=values, file=shown)

    def _inline(self, table: Any, *path: str | int) -> Law:
        """A table that is written in the manifest."""
        if len(table.times) != len(table.values):
            wrong = f"the table has {len(table.times)} times and {len(table.values)} values"
            self.scope.complain(wrong, "give as many of both", *path)
        if any(later <= earlier for earlier, later in pairwise(table.times)):
            self.scope.complain("the times of the table do not increase", "sort them, each once", *path)
        return Law("table", times=tuple(table.times), values=tuple(table.values))

    def loads(self) -> Iterator[Load]:
        """`[[function.load]]`."""
        scope = self.scope
        for path, table in scope.tables("function", "load"):
            if table.force is None and table.torque is None:
                scope.complain("a load has neither force nor torque", "add force = [x, y, z] in N", *path)
            part, point = self.place(table.part, *path, "part"), scope.point(table.point)
            force, torque = scope.vector(table.force), scope.vector(table.torque)
            law = self._law(table.law, *path, "law")
            yield Load(part, force, torque, point, table.frame, *scope.where(*path), law)

    def check(self) -> CheckSettings:
        """`[check]` of the top manifest."""
        table = self.scope.manifest.check
        usual: Profile = "description" if self.scope.described else "design"
        if table is None:
            return CheckSettings(profile=usual)
        ignore = tuple(
            Ignore(entry.code, entry.subject, entry.reason, *self.scope.where(*path))
            for path, entry in self.scope.tables("check", "ignore")
        )
        severity = tuple(sorted(table.severity.items()))
        where = self.scope.where("check")
        return CheckSettings(tuple(table.select), severity, ignore, *where, table.profile or usual)

    def simulation(self) -> SimulationRequest | None:
        """`[simulation]` of the top manifest."""
        table = self.scope.manifest.simulation
        if table is None:
            return None
        if table.stops is None and "restitution" in table.model_fields_set:
            remedy = 'add stops = "range" or stops = "found", or remove it'
            self.scope.complain("restitution is of stops, which are not asked for", remedy, "simulation", "restitution")
        if table.step > table.duration:
            self.scope.complain("the step is longer than the duration", "give a shorter step", "simulation", "step")
        elif table.duration / table.step > OUTPUTS:
            self.scope.complain(
                f"the step gives {table.duration / table.step:.3g} output times, and {OUTPUTS:,} are the most",
                "give a longer step: it is the time between outputs, and the solver chooses its own steps",
                "simulation", "step",
            )  # fmt: skip
        initial = []
        for name, value in sorted(table.initial.items()):
            path = ("simulation", "initial", name)
            joint, where = self.joint(name, *path), self.scope.where(*path)
            solved = isinstance(value.position, str)
            position = 0.0 if isinstance(value.position, str) else value.position
            numbers = position, value.velocity, self.scope.metres
            initial.append(InitialValue(joint, *numbers, *where, value.freedom or "", solved))
        gravity = np.array(table.gravity, dtype=float)
        defaults = tuple(sorted({"duration", "step", "gravity"} - table.model_fields_set))
        where = self.scope.where("simulation")
        return SimulationRequest(
            table.level,
            table.duration,
            table.step,
            gravity,
            tuple(initial),
            *where,
            table.partial,
            table.stops or "",
            table.restitution,
            defaults,
        )
