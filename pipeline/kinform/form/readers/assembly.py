"""Reads a manifest with its sub-assemblies and meshes into one flat assembly in SI and world axes."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.errors import InputError, Problem
from kinform.form.files import Sources, earlier_meshes
from kinform.form.manifest.common import Posed
from kinform.form.manifest.parts import Part as PartTable
from kinform.form.manifest.parts import TolerancesTable
from kinform.form.materials import BUILT_IN, density_of
from kinform.form.problems import Problems, did_you_mean, quoted
from kinform.form.readers.function import Purposes
from kinform.form.readers.poses import UNIT, pose, unit_error
from kinform.form.readers.scope import Scope, parse
from kinform.foundation.units import metres_per
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Group, MassOverride, Part, Source, Subassembly
from kinform.model.function import Function
from kinform.model.names import PartName
from kinform.model.tolerances import Tolerances

__all__ = ["load", "load_with_contents"]


def load(path: str | Path, *, allow_outside: bool = False) -> Assembly:
    """As `load_with_contents`, without the contents."""
    return load_with_contents(path, allow_outside=allow_outside)[0]


def load_with_contents(
    path: str | Path,
    *,
    allow_outside: bool = False,
    earlier: Assembly | None = None,
    files: Mapping[str, str] | None = None,
) -> tuple[Assembly, dict[str, str]]:
    """The assembly that the manifest at `path` describes, meshes read and sub-assemblies flattened.

    Raises InputError with every problem that was found, each with file, line and remedy. Mesh and
    sub-assembly files outside the manifest's folder need `allow_outside`. Also gives the SHA-256 (hex) of every file
    that was read, by name, empty where one changed meanwhile. Meshes of files that are among the `files` of an
    `earlier` assembly, which the present code read, are taken from it.
    """
    path = Path(path)
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise InputError([Problem(f"the manifest {what}", str(path), None, "name a manifest (TOML); see kinform init")])
    problems = Problems()
    known = {} if earlier is None else earlier_meshes(earlier, files or {})
    sources = Sources(path.parent, problems, allow_outside, known)
    reader = _Reader(sources, problems)
    reader.scopes(path, path.name, "", np.eye(4), ())
    assembly = reader.assembly() if reader.found else None
    problems.raise_if_any()
    assert assembly is not None
    return assembly, sources.contents()


class _Reader:
    """Collects scopes, then parts, groups and function of all of them."""

    def __init__(self, sources: Sources, problems: Problems):
        self.sources, self.problems = sources, problems
        self.found: list[Scope] = []
        self.subassemblies: list[Subassembly] = []

    def scopes(self, path: Path, file: str, prefix: str, X_WF: Array, above: tuple[Path, ...]) -> None:
        """Read a manifest and all below it, depth first."""
        self.sources.text(path)
        parsed = parse(path, file, self.problems)
        if parsed is None:
            return
        manifest, lines, refused = parsed
        scope = Scope(manifest, lines, file, path.parent, prefix, X_WF, self.problems, refused)
        self.found.append(scope)
        here = (*above, Path(os.path.realpath(path)))
        for k, table in enumerate(scope.manifest.subassembly):
            line = scope.line("subassembly", k, "file")
            below = self.sources.find(table.file, path.parent, file, line, "the sub-assembly")
            if below is None:
                continue
            if Path(os.path.realpath(below)) in here:
                chain = " → ".join([*(self.sources.shown(p) for p in here), self.sources.shown(below)])
                scope.complain(f"sub-assemblies form a cycle: {chain}", "remove one of them", "subassembly", k, "file")
                continue
            name = prefix + table.name
            X = X_WF @ self._pose(scope, table, "subassembly", k)
            before = len(self.found)
            self.scopes(below, self.sources.shown(below), name + "/", X, here)
            function = self.found[before].manifest.function if len(self.found) > before else None
            mobility = function.mobility if function else None
            self.subassemblies.append(
                Subassembly(name, self.sources.shown(below), mobility, scope.source("subassembly", k))
            )

    def _pose(self, scope: Scope, table: Posed, *path: str | int) -> Array:
        if table.quaternion is not None and table.rpy is not None:
            scope.complain("both quaternion and rpy are given", "remove one of them", *path, "rpy")
        if table.quaternion is not None and unit_error(table.quaternion) > UNIT:
            length = math.hypot(*table.quaternion)
            scope.complain(
                f"the quaternion has length {length:.6g}, not 1", "give a unit quaternion [w, x, y, z]",
                *path, "quaternion",
            )  # fmt: skip
            return pose(table.position, None, None, scope.metres)
        return pose(table.position, table.quaternion, table.rpy, scope.metres)

    def assembly(self) -> Assembly:
        """The flat assembly; problems are noted on the way."""
        top = self.found[0]
        tolerances = _tolerances(top.manifest.tolerances, top.metres)
        parts = [part for scope in self.found for part in self._parts(scope, tolerances)]
        self._names()
        groups = self._groups({part.name for part in parts})
        places = {*(self._stated_parts()), *(group.name for group in groups)}
        joints: dict[str, str] = {
            scope.prefix + table.name: table.type
            for scope in self.found
            for table in (scope.manifest.function.joint if scope.manifest.function else [])
        }
        purposes = [Purposes(scope, self.sources, places, joints) for scope in self.found]
        function = Function(
            mobility=top.manifest.function.mobility if top.manifest.function else None,
            mobility_line=top.line("function", "mobility") if top.manifest.function else None,
            joints=tuple(j for p in purposes for j in p.intended()),
            couplings=tuple(c for p in purposes for c in p.couplings()),
            drives=tuple(d for p in purposes for d in p.drives()),
            loads=tuple(x for p in purposes for x in p.loads()),
            requirements=tuple(r for p in purposes for r in p.requirements()),
        )
        ground = top.manifest.assembly.ground
        if ground is not None:
            purposes[0].place(ground, "assembly", "ground")
        if not self._stated_parts() and not len(self.problems):
            top.complain("the assembly has no part", "add a [[part]]")
        return Assembly(
            name=top.manifest.assembly.name,
            units=top.manifest.assembly.units,
            parts=tuple(sorted(parts, key=lambda part: part.name)),
            groups=tuple(sorted(groups, key=lambda group: group.name)),
            assumptions=tuple(a for p in purposes for a in p.assumptions()),
            ground=ground,
            tolerances=tolerances,
            infer_fasteners=top.manifest.fasteners.infer,
            function=function,
            simulation=purposes[0].simulation(),
            subassemblies=tuple(sorted(self.subassemblies, key=lambda s: s.name)),
            source=Source(top.file, top.line("assembly")),
            files=tuple(sorted(self.sources.files)),
            notes=tuple(self._notes()),
            check=purposes[0].check(),
        )

    def _notes(self) -> list[str]:
        return [
            f"[tolerances] of {scope.file} are not used: those of {self.found[0].file} hold for the whole assembly"
            for scope in self.found[1:]
            if scope.manifest.tolerances.model_fields_set
        ] + [
            f"[check] of {scope.file} is not used: that of {self.found[0].file} holds for the whole assembly"
            for scope in self.found[1:]
            if scope.manifest.check is not None
        ]

    def _stated_parts(self) -> set[str]:
        return {scope.prefix + table.name for scope in self.found for table in scope.manifest.part}

    def _names(self) -> None:
        """Parts, groups, sub-assemblies share their names; joints and requirements have theirs."""
        spaces: dict[str, list[tuple[str, str]]] = {
            "part, group or sub-assembly": [("part", ""), ("group", ""), ("subassembly", "")],
            "joint": [("joint", "function")],
            "requirement": [("require", "function")],
        }
        for scope in self.found:
            for what, tables in spaces.items():
                seen: dict[str, int] = {}
                for key, table in tables:
                    owner = getattr(scope.manifest, table) if table else scope.manifest
                    for k, entry in enumerate(getattr(owner, key, []) if owner else []):
                        path = (*((table,) if table else ()), key, k)
                        if entry.name in seen:
                            scope.line(*path, "name")
                            scope.complain(
                                f"two are named {quoted(entry.name)} (each {what} needs its own name): "
                                f"the first is at line {seen[entry.name]}",
                                "rename one of them", *path, "name",
                            )  # fmt: skip
                        else:
                            seen[entry.name] = scope.line(*path, "name")

    def _groups(self, parts: set[PartName]) -> list[Group]:
        del parts
        known, out = self._stated_parts(), []
        owner: dict[str, str] = {}
        for scope in self.found:
            for k, table in enumerate(scope.manifest.group):
                name, members = scope.prefix + table.name, []
                for n, member in enumerate(table.parts):
                    full = scope.prefix + member
                    if full not in known:
                        if member in scope.refused:
                            continue
                        near = [p.removeprefix(scope.prefix) for p in known if p.startswith(scope.prefix)]
                        scope.complain(
                            f"group {quoted(table.name)}: there is no part {quoted(member)}",
                            did_you_mean(member, near, "the parts"), "group", k, "parts", n,
                        )  # fmt: skip
                        continue
                    if full in owner and owner[full] != name:
                        scope.complain(
                            f"part {quoted(member)} is in the groups {quoted(owner[full])} and {quoted(name)}",
                            "keep it in one of them", "group", k, "parts", n,
                        )  # fmt: skip
                    owner[full] = name
                    members.append(PartName(full))
                if members:
                    out.append(Group(name, tuple(sorted(set(members))), scope.source("group", k)))
        return out

    def _parts(self, scope: Scope, tolerances: Tolerances) -> list[Part]:
        return [self._part(scope, k, table, tolerances) for k, table in enumerate(scope.manifest.part)]

    def _part(self, scope: Scope, k: int, table: PartTable, tolerances: Tolerances) -> Part:
        path = ("part", k)
        what = f"part {quoted(table.name)}"
        units = table.units or scope.manifest.assembly.units
        mesh = None
        if table.mesh is not None:
            line = scope.line(*path, "mesh")
            found = self.sources.find(table.mesh, scope.folder, scope.file, line, f"{what}: the mesh")
            if found is not None:
                mesh = self.sources.mesh(
                    found, table.body, metres_per(units), tolerances.weld, table.solid, scope.file, line
                )
        elif table.body is not None or table.units is not None:
            scope.complain(f"{what} has no mesh, but body or units of one", "add mesh, or remove them", *path)
        if table.material is not None and table.density is not None:
            scope.complain(f"{what} has both material and density", "remove one of them", *path, "density")
        override = self._override(scope, table, what, *path)
        return Part(
            name=PartName(scope.prefix + table.name),
            mesh=mesh,
            X_WP=scope.X_WF @ self._pose(scope, table, *path),
            solid=table.solid,
            material=table.material,
            density=self._density(scope, table, what, *path),
            override=override,
            units=units,
            source=scope.source(*path),
        )

    def _density(self, scope: Scope, table: PartTable, what: str, *path: str | int) -> float | None:
        if table.material is None:
            return table.density
        own = {name: material.density for name, material in scope.manifest.materials.items()}
        found = density_of(table.material, own)
        if found is None:
            scope.complain(
                f"{what}: there is no material {quoted(table.material)}",
                did_you_mean(table.material, [*own, *BUILT_IN], "the materials"), *path, "material",
            )  # fmt: skip
        return found

    def _override(self, scope: Scope, table: PartTable, what: str, *path: str | int) -> MassOverride | None:
        given = {k: getattr(table, k) for k in ("mass", "centre_of_mass", "inertia")}
        missing = [k for k, v in given.items() if v is None]
        if len(missing) == 3:
            return None
        if missing:
            scope.complain(
                f"{what}: {', '.join(k for k in given if k not in missing)} without {' and '.join(missing)}",
                "mass, centre_of_mass and inertia go together", *path,
            )  # fmt: skip
            return None
        inertia = np.array(table.inertia, dtype=float)
        if not np.allclose(inertia, inertia.T, rtol=1e-9, atol=0.0):
            scope.complain(f"{what}: the inertia is not symmetric", "give a symmetric matrix", *path, "inertia")
        assert table.mass is not None
        assert table.centre_of_mass is not None
        return MassOverride(table.mass, np.array(table.centre_of_mass) * scope.metres, inertia)


def _tolerances(table: TolerancesTable, metres: float) -> Tolerances:
    out = Tolerances()
    if table.contact is not None:
        out = replace(out, contact=table.contact * metres)
    if table.weld is not None:
        out = replace(out, weld=table.weld * metres)
    if table.alignment is not None:
        out = replace(out, alignment=math.radians(table.alignment))
    return out
