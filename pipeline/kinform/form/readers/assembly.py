"""Reads a manifest with its sub-assemblies and meshes into one flat assembly in SI and world axes."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.errors import InputError, Problem
from kinform.form.constants import FILES_DEEP, PARTS_MOST
from kinform.form.files import DesignFiles, MeshUse, earlier_meshes, no_file
from kinform.form.manifest.parts import Group as GroupTable
from kinform.form.manifest.parts import Part as PartTable
from kinform.form.manifest.parts import TolerancesTable
from kinform.form.materials import BUILT_IN, density_of
from kinform.form.meshes.primitives import primitive
from kinform.form.problems import Problems
from kinform.form.readers.function import FunctionReader
from kinform.form.readers.grounds import grounds_of
from kinform.form.readers.open_manifest import Parsed, Scope, parse
from kinform.form.readers.poses import pose, shift, unit_error
from kinform.form.readers.requirements import requirements_of
from kinform.form.readers.sensors import sensors_of
from kinform.form.readers.springs import springs_of
from kinform.form.sources import AS_IT_IS, Reading, is_source
from kinform.form.tables import Posed
from kinform.foundation.boundary import Boundary
from kinform.foundation.memory import keep_heap
from kinform.foundation.name_hints import bound_comparisons, did_you_mean, in_quotes
from kinform.foundation.regular_files import AS_A_FILE, not_a_file
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.foundation.units import metres_per
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Group, MassOverride, Part, Subassembly
from kinform.model.descriptions import Description
from kinform.model.function import Function, SimulationRequest
from kinform.model.names import PartName
from kinform.model.tolerances import Tolerances

SCOPES_MOST = 10_000
"""Sub-assemblies of a design, counted each time that they are placed, a tenth of `PARTS_MOST`: of files that place each
other twice there could be more than atoms."""


def load(path: str | Path, *, allow_outside: bool = False, reading: Reading = AS_IT_IS) -> Assembly:
    """As `load_with_contents`, without the contents."""
    return load_with_contents(path, allow_outside=allow_outside, reading=reading)[0]


def load_with_contents(
    path: str | Path,
    *,
    allow_outside: bool = False,
    reading: Reading = AS_IT_IS,
    earlier: Assembly | None = None,
    files: Mapping[str, str] | None = None,
) -> tuple[Assembly, dict[str, str]]:
    """The assembly that the manifest, or the description, at `path` describes: meshes read, sub-assemblies flattened.

    Raises InputError with every problem, each with file, line and remedy. Mesh and
    sub-assembly files outside the design's folder need `allow_outside`. Also gives the SHA-256 (hex) of every file
    that was read, by name, empty where one changed meanwhile. Meshes of files that are among the `files` of an
    `earlier` assembly, which the present code read, are taken from it.
    """
    path = Path(path)
    if not path.is_file():
        fault = f"{'the file' if is_source(path) else 'the manifest'} {no_file(path)}"
        remedy = AS_A_FILE if not_a_file(path) else "name a manifest (TOML); see kinform init"
        raise InputError([Problem(fault, str(path), None, remedy)])
    keep_heap()
    bound_comparisons()
    problems = Problems()
    meshes = {} if earlier is None else earlier_meshes(earlier, files or {})
    packages = (folder for _, folder in reading.packages)
    boundary = Boundary(path, allow_outside=allow_outside, packages=packages)
    design = DesignFiles(path.parent, problems, boundary, meshes, reading)
    reader = _AssemblyReader(design, problems)
    reader.read(path, path.name, "", np.eye(4), ())
    assembly = reader.assembly() if reader.scopes else None
    problems.raise_if_any()
    assert assembly is not None
    return assembly, design.contents()


class _AssemblyReader:
    """Collects scopes, then parts, groups and function of all of them."""

    def __init__(self, files: DesignFiles, problems: Problems):
        self.files, self.problems = files, problems
        self.scopes: list[Scope] = []
        self.stopped = False
        self._parsed: dict[Path, Parsed | None] = {}
        self.subassemblies: list[Subassembly] = []

    def read(self, path: Path, file: str, prefix: str, X_WF: Array, above: tuple[Path, ...]) -> None:
        """Read a manifest and all below it, depth first."""
        self.files.note(path)
        if path not in self._parsed:
            changes = () if above else self.files.reading.changes
            self._parsed[path] = parse(path, file, self.files, self.problems, changes)
        parsed = self._parsed[path]
        if parsed is None:
            return
        scope = Scope(
            parsed.manifest, parsed.lines, file, path.parent, prefix, X_WF, self.problems, parsed.refused, parsed.notes,
            parsed.described, parsed.facts, self.files.boundary,
        )  # fmt: skip
        self.scopes.append(scope)
        here = (*above, Path(os.path.realpath(path)))
        for at, table in scope.tables("subassembly"):
            if self.stopped:
                return
            below = self.files.find(table.file, path.parent, *scope.where(*at, "file"), "the sub-assembly")
            if below is None:
                continue
            shown = self.files.shown(below)
            if Path(os.path.realpath(below)) in here:
                chain = " → ".join([*(self.files.shown(p) for p in here), shown])
                scope.complain(f"sub-assemblies form a cycle: {chain}", "remove one of them", *at, "file")
                continue
            if len(here) > FILES_DEEP or len(self.scopes) >= SCOPES_MOST:
                self._too_many(scope, len(here) > FILES_DEEP, *at, "file")
                return
            name = prefix + table.name
            before = len(self.scopes)
            self.read(below, shown, name + "/", X_WF @ _pose(scope, table, *at), here)
            function = self.scopes[before].manifest.function if len(self.scopes) > before else None
            mobility = function.mobility if function else None
            self.subassemblies.append(Subassembly(name, shown, mobility, scope.source(*at)))

    def _too_many(self, scope: Scope, deep: bool, *path: str | int) -> None:
        """Note, once, that there are more sub-assemblies than a design may have."""
        if not self.stopped:
            how = f"more than {FILES_DEEP} deep in each other" if deep else f"more than {SCOPES_MOST:,} in all"
            scope.complain(f"sub-assemblies are placed {how}", "place fewer of them", *path)
        self.stopped = True

    def assembly(self) -> Assembly:
        """The flat assembly; problems are noted on the way."""
        top = self.scopes[0]
        count = sum(len(scope.manifest.part) for scope in self.scopes)
        if self.stopped or count > PARTS_MOST:
            if not self.stopped:
                top.complain(f"the design has {count:,} parts, and {PARTS_MOST:,} are the most", "divide it", "part")
            self.problems.raise_if_any()
        tolerances = _tolerances(top.manifest.tolerances, top.metres)
        parts = [
            self._part(scope, table, tolerances, *at) for scope in self.scopes for at, table in scope.tables("part")
        ]
        self._check_names()
        self._add_groups_of_scenes()
        stated = {scope.prefix + table.name for scope in self.scopes for table in scope.manifest.part}
        groups = self._groups(stated)
        places = stated | {group.name for group in groups}
        joints = {
            scope.prefix + table.name: table.type
            for scope in self.scopes
            for _, table in scope.tables("function", "joint")
        }
        grounds, meshed = (
            grounds_of(self.scopes, self.subassemblies, parts),
            any(part.mesh is not None for part in parts),
        )
        readers = [FunctionReader(scope, self.files, places, joints, grounds, meshed) for scope in self.scopes]
        intended = top.manifest.function
        materials = {*BUILT_IN, *(name for scope in self.scopes for name in scope.manifest.materials)}
        function = Function(
            mobility=intended.mobility if intended else None,
            mobility_line=top.line("function", "mobility") if intended else None,
            joints=tuple(joint for reader in readers for joint in reader.intended()),
            couplings=tuple(coupling for reader in readers for coupling in reader.couplings()),
            drives=tuple(drive for reader in readers for drive in reader.drives()),
            frictions=tuple(pair for reader in readers for pair in reader.frictions(materials)),
            loads=tuple(load for reader in readers for load in reader.loads()),
            springs=tuple(spring for reader in readers for spring in springs_of(reader)),
            requirements=tuple(requirement for reader in readers for requirement in requirements_of(reader)),
            complete=tuple(scope.prefix for scope in self.scopes if _complete(scope)),
        )
        ground = top.manifest.assembly.ground
        if ground is not None:
            readers[0].place(ground, "assembly", "ground")
        if not stated and not len(self.problems):
            top.complain("the assembly has no part", "add a [[part]]")
        return Assembly(
            name=top.manifest.assembly.name,
            units=top.manifest.assembly.units,
            parts=tuple(sorted(parts, key=lambda part: part.name)),
            groups=tuple(sorted(groups, key=lambda group: group.name)),
            assumptions=tuple(assumption for reader in readers for assumption in reader.assumptions()),
            ground=ground,
            tolerances=tolerances,
            infer_fasteners=top.manifest.fasteners.infer,
            function=function,
            simulation=_request(readers[0], function),
            subassemblies=tuple(sorted(self.subassemblies, key=lambda s: s.name)),
            source=top.source("assembly"),
            files=tuple(sorted(self.files.names)),
            notes=tuple(self._notes()),
            check=readers[0].check(),
            descriptions=self._descriptions(parts),
        )

    def _descriptions(self, parts: list[Part]) -> tuple[Description, ...]:
        """What robot descriptions among the sources say; of other sources nothing is imported for that."""
        described = [scope for scope in self.scopes if scope.facts is not None]
        if not described or len(self.problems):
            return ()
        from kinform.form.readers.described import describe

        return tuple(describe(scope, parts, self.files) for scope in described)

    def _notes(self) -> list[str]:
        top, below = self.scopes[0].file, self.scopes[1:]
        return (
            [note for scope in self.scopes for note in scope.notes]
            + [
                f"[tolerances] of {scope.file} are not used: those of {top} hold for the whole assembly"
                for scope in below
                if scope.manifest.tolerances.model_fields_set
            ]
            + [
                f"[check] of {scope.file} is not used: that of {top} holds for the whole assembly"
                for scope in below
                if scope.manifest.check is not None
            ]
        )

    def _check_names(self) -> None:
        """Parts, groups, sub-assemblies share their names; joints and requirements have theirs."""
        spaces: dict[str, list[tuple[str, ...]]] = {
            "part, group or sub-assembly": [("part",), ("group",), ("subassembly",)],
            "joint": [("function", "joint")],
            "requirement": [("function", "require")],
        }
        for scope in self.scopes:
            for what, arrays in spaces.items():
                lines: dict[str, int] = {}
                for at, table in (entry for keys in arrays for entry in scope.tables(*keys)):
                    if table.name in lines:
                        scope.complain(
                            f"two are named {in_quotes(table.name)} (each {what} needs its own name): "
                            f"the first is at line {lines[table.name]}", "rename one of them", *at, "name",
                        )  # fmt: skip
                    lines.setdefault(table.name, scope.line(*at, "name"))

    def _add_groups_of_scenes(self) -> None:
        """What the names of parts with "/" begin with are sub-assemblies; none has the name of another thing."""
        below = {sub.name for sub in self.subassemblies}
        names = {scope.prefix + table.name for scope in self.scopes for table in scope.manifest.part}
        groups = {scope.prefix + table.name for scope in self.scopes for table in scope.manifest.group}
        made: set[str] = set()
        for scope in self.scopes:
            for at, table in scope.tables("part"):
                steps = table.name.split("/")
                for k in range(1, len(steps)):
                    name = scope.prefix + "/".join(steps[:k])
                    if name in made:
                        continue
                    if name in below | names | groups:
                        message = f"{in_quotes(name)} is the beginning of {in_quotes(table.name)}, and a name itself"
                        scope.complain(message, "rename one of them", *at, "name")
                    made.add(name)
                    self.subassemblies.append(Subassembly(name, scope.file, None, scope.source(*at)))

    def _groups(self, parts: set[str]) -> list[Group]:
        """`[[group]]` of all manifests, of these parts."""
        groups = []
        owner: dict[str, str] = {}
        for scope in self.scopes:
            for at, table in scope.tables("group"):
                name, members = scope.prefix + table.name, set()
                for n, member in enumerate(table.parts):
                    full = scope.prefix + member
                    if full not in parts:
                        if member not in scope.refused:
                            remedy = did_you_mean(member, scope.local_names(parts), "the parts")
                            message = f"group {in_quotes(table.name)}: there is no part {in_quotes(member)}"
                            scope.complain(message, remedy, *at, "parts", n)
                        continue
                    if owner.setdefault(full, name) != name:
                        scope.complain(
                            f"part {in_quotes(member)} is in the groups {in_quotes(owner[full])} and {in_quotes(name)}",
                            "keep it in one of them", *at, "parts", n,
                        )  # fmt: skip
                        owner[full] = name
                    members.add(PartName(full))
                what = f"group {in_quotes(table.name)}"
                stated = _override(scope, table, np.zeros(3), what, *at)
                if members:
                    placed = None if stated is None else _in_world(stated, scope.X_WF)
                    groups.append(Group(name, tuple(sorted(members)), scope.source(*at), placed))
        return groups

    def _part(self, scope: Scope, table: PartTable, tolerances: Tolerances, *path: str | int) -> Part:
        """The part of a `[[part]]`, with its mesh read."""
        what = f"part {in_quotes(table.name)}"
        if "/" in table.name and not scope.of_scene(table):
            scope.complain(f"{what} has a '/' in its name, which separates sub-assemblies",
                           "remove it, or place a [[subassembly]]", *path, "name")  # fmt: skip
        unit: str = table.units or scope.manifest.assembly.units
        mesh = None
        scale = _scale(scope, table, what, *path)
        if table.mesh is not None:
            where = scope.where(*path, "mesh")
            file = self.files.find(table.mesh, scope.folder, *where, f"{what}: the mesh")
            if file is not None:
                unit = table.units or self.files.unit(file) or unit
                use = MeshUse(table.body, metres_per(unit), tolerances.weld, table.solid, scale)
                mesh = self.files.mesh(file, use, *where)
            if table.shape is not None:
                scope.complain(f"{what} has both mesh and shape", "remove one of them", *path, "shape")
        elif table.body is not None or table.units is not None or table.scale is not None:
            scope.complain(f"{what} has no mesh, but body, units or scale of one", "add mesh, or remove them", *path)
        elif table.shape is not None:
            mesh = primitive(table.shape, scope.metres)
        if table.material is not None and table.density is not None:
            scope.complain(f"{what} has both material and density", "remove one of them", *path, "density")
        origin = np.zeros(3) if mesh is None else mesh.origin
        override = _override(scope, table, origin, what, *path)
        return Part(
            name=PartName(scope.prefix + table.name),
            mesh=mesh,
            X_WP=shift(scope.X_WF @ _pose(scope, table, *path), origin),
            solid=table.solid,
            material=table.material,
            density=_density(scope, table, what, *path),
            override=override,
            units=unit,
            source=scope.source(*path),
            scale=np.array(scale),
            colour=None if table.colour is None else table.colour.lower(),
        )


def _request(reader: FunctionReader, function: Function) -> SimulationRequest | None:
    """`[simulation]` with its sensors."""
    request = reader.simulation()
    if request is None:
        return None
    if request.stops == "range" and not any(_ends(joint.range) for joint in function.joints):
        remedy = 'add range = [lower, upper] to a [[function.joint]], or ask for stops = "found"'
        reader.scope.complain('stops = "range", and no joint states a range', remedy, "simulation", "stops")
    return replace(request, sensors=tuple(sensors_of(reader)))


def _ends(bounds: tuple[float, float] | None) -> bool:
    """Whether a range has an end."""
    return bounds is not None and not all(map(math.isinf, bounds))


def _complete(scope: Scope) -> bool:
    """Whether the function of a manifest says that it is all of it."""
    return scope.manifest.function is not None and scope.manifest.function.complete


def _pose(scope: Scope, table: Posed, *path: str | int) -> Array:
    if table.quaternion is not None and table.rpy is not None:
        scope.complain("both quaternion and rpy are given", "remove one of them", *path, "rpy")
    if table.quaternion is not None and unit_error(table.quaternion) > SINGLE:
        message = f"the quaternion has length {math.hypot(*table.quaternion):.6g}, not 1"
        scope.complain(message, "give a unit quaternion [w, x, y, z]", *path, "quaternion")
        return pose(table.position, None, None, scope.metres)
    return pose(table.position, table.quaternion, table.rpy, scope.metres)


def _scale(scope: Scope, table: PartTable, what: str, *path: str | int) -> tuple[float, float, float]:
    """The factors along the axes of the mesh; a zero is a problem."""
    if table.scale is None:
        return 1.0, 1.0, 1.0
    if 0.0 in table.scale:
        scope.complain(f"{what}: the scale has a zero", "give factors such as [1, -1, 1]", *path, "scale")
        return 1.0, 1.0, 1.0
    x, y, z = table.scale
    return x, y, z


def _in_world(stated: MassOverride, X_WF: Array) -> MassOverride:
    """A mass stated about the axes of a manifest, about those of the world."""
    R = X_WF[:3, :3]
    centre = R @ stated.centre_of_mass + X_WF[:3, 3]
    return MassOverride(stated.mass, centre, R @ stated.inertia @ R.T)


def _density(scope: Scope, table: PartTable, what: str, *path: str | int) -> float | None:
    if table.material is None:
        return table.density
    stated = {name: material.density for name, material in scope.manifest.materials.items()}
    density = density_of(table.material, stated)
    if density is None:
        remedy = did_you_mean(table.material, [*stated, *BUILT_IN], "the materials")
        scope.complain(f"{what}: there is no material {in_quotes(table.material)}", remedy, *path, "material")
    return density


def _override(
    scope: Scope, table: PartTable | GroupTable, origin: Array, what: str, *path: str | int
) -> MassOverride | None:
    """The stated mass of a part whose frame lies at `origin` (3,) m of its file's."""
    keys = ("mass", "centre_of_mass", "inertia")
    missing = [key for key in keys if getattr(table, key) is None]
    if len(missing) == len(keys):
        return None
    if missing:
        stated = ", ".join(key for key in keys if key not in missing)
        remedy = "mass, centre_of_mass and inertia go together"
        scope.complain(f"{what}: {stated} without {' and '.join(missing)}", remedy, *path)
        return None
    inertia = np.array(table.inertia, dtype=float)
    if not np.allclose(inertia, inertia.T, rtol=SOLVED, atol=0.0):
        scope.complain(f"{what}: the inertia is not symmetric", "give a symmetric matrix", *path, "inertia")
    assert table.mass is not None
    assert table.centre_of_mass is not None
    return MassOverride(table.mass, np.array(table.centre_of_mass) * scope.metres - origin, inertia)


def _tolerances(table: TolerancesTable, metres: float) -> Tolerances:
    stated = {
        "contact": None if table.contact is None else table.contact * metres,
        "weld": None if table.weld is None else table.weld * metres,
        "alignment": None if table.alignment is None else math.radians(table.alignment),
        "axis_angle": None if table.axis_angle is None else math.radians(table.axis_angle),
        "axis_offset": None if table.axis_offset is None else table.axis_offset * metres,
    }
    return replace(Tolerances(), **{key: value for key, value in stated.items() if value is not None})
