"""Meshes in place of a manifest, and the manifest that `kinform init` writes from them."""

from __future__ import annotations

import math
import os
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from kinform.errors import InputError, Problem
from kinform.form.files import read_raw
from kinform.form.materials import BUILT_IN
from kinform.form.meshes.bodies import named_bodies, shell_bodies
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import MeshError, RawMesh
from kinform.form.problems import Problems
from kinform.form.readers.poses import shift
from kinform.form.sources import states_units
from kinform.foundation.escapes import toml
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import ARITHMETIC
from kinform.foundation.units import METRES_PER_UNIT, UNITS, metres_per
from kinform.foundation.words import length
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part, Source
from kinform.model.function import Function, IntendedJoint
from kinform.model.names import PartName
from kinform.model.tolerances import Tolerances

SMALLEST_ASSEMBLY = 1e-3
"""Diagonal (m) below which a unit is doubted: no assembly of parts is smaller than a millimetre. Chosen, not
measured."""
LARGEST_ASSEMBLY = 100.0
"""Diagonal (m) above which a unit is doubted: few machines are as large as a ship. Chosen, not measured."""
MISTAKEN_METRES = 20.0
"""Diagonal (m) from which on metres are doubted: machines of that size are drawn in mm, and a device of 20 mm, a common
size, read as metres has it. Chosen, not measured."""
USUAL_ASSEMBLY = (0.01, 10.0)
"""Diagonals (m) between which another unit is proposed: from a watch to a lorry. Chosen, not measured."""
WIDTH = 100
"""Columns of comments in a manifest that is proposed. Chosen."""


def load_meshes(
    paths: Sequence[str | Path], *, units: str, name: str | None = None, density: float | None = None
) -> Assembly:
    """An assembly of mesh files without a manifest.

    A file whose bodies have names (OBJ `o` or `g`, several ASCII solids) gives a part each; a single file
    without names gives a part for each of its shells; one of several files is one part. `units` is the
    length unit of all files, `density` (kg/m³) that of all parts. Raises InputError with every problem.
    """
    problems = Problems()
    metres = _metres(units, problems)
    parts: dict[str, Part] = {}
    for path, body, label, raw in _bodies([Path(p) for p in paths], problems):
        try:
            mesh = build_mesh(raw, metres, None, path=path.name, body=body, solid=True)
        except MeshError as error:
            for fault in error.faults:
                problems.add(f"{in_quotes(label)} {fault.message}", str(path), fault.line, fault.remedy)
            continue
        if label in parts:
            problems.add(f"two bodies are named {in_quotes(label)}", str(path), None, "rename a file or a body")
        pose = shift(np.eye(4), mesh.origin)
        parts[label] = Part(PartName(label), mesh, pose, True, None, density, None, units, Source(path.name))
    problems.raise_if_any()
    first = Path(paths[0])
    return Assembly(
        name=name or first.stem,
        units=units,
        parts=tuple(parts[label] for label in sorted(parts)),
        groups=(),
        assumptions=(),
        ground=None,
        tolerances=Tolerances(),
        infer_fasteners=False,
        function=Function(),
        simulation=None,
        subassemblies=(),
        source=Source(first.name),
        files=tuple(sorted({Path(p).name for p in paths})),
    )


def init_manifest(
    paths: Sequence[str | Path],
    *,
    units: str,
    name: str | None = None,
    relative_to: str | Path = ".",
    fastened: Callable[[Assembly], Sequence[tuple[Sequence[str], str]]] | None = None,
    jointed: Callable[[Assembly], Sequence[tuple[IntendedJoint, str]]] | None = None,
) -> str:
    """Text of a manifest for these meshes, whose paths are written relative to the folder `relative_to`.

    `fastened` names parts that are probably one body, with the evidence, `jointed` joints that may be meant (m), with
    what they would move; they are written as comments, ready to be taken over. Doubts a unit that makes the assembly
    implausibly small or large. Raises InputError with every problem.
    """
    assembly = load_meshes(paths, units=units, name=name)
    where = {Path(p).name: Path(os.path.relpath(p, relative_to)).as_posix() for p in paths}
    lines = ["schema = 1", "", "[assembly]", f"name = {toml(assembly.name)}", f"units = {toml(units)}"]
    lines += [f"# {doubt}" for doubt in doubts(assembly)]
    lines += ['# ground = "…"   # the part or group at rest; else the heaviest body']
    built_in = ", ".join(sorted(BUILT_IN))
    told = f"There is no mass without a material ({built_in}, or your own: [materials.NAME]) or density (kg/m³)."
    lines += ["", *textwrap.wrap(told, WIDTH, initial_indent="# ", subsequent_indent="# ")]
    for part in assembly.parts:
        assert part.mesh is not None
        lines += ["", "[[part]]", f"name = {toml(part.name)}", f"mesh = {toml(where[part.mesh.path])}"]
        if part.mesh.body is not None:
            lines.append(f"body = {toml(part.mesh.body)}")
        lines.append('# material = "…"')
    lines += proposals(assembly, units, fastened, jointed)
    lines.append("")
    return "\n".join(lines)


def proposals(
    assembly: Assembly,
    units: str,
    fastened: Callable[[Assembly], Sequence[tuple[Sequence[str], str]]] | None,
    jointed: Callable[[Assembly], Sequence[tuple[IntendedJoint, str]]] | None,
) -> list[str]:
    """Lines of comments: groups and joints that may be meant, or what they would look like; arguments as for
    `init_manifest`."""
    lines = ["", "# Parts that are fastened by means that the geometry does not show:"]
    taken = {str(part.name) for part in assembly.parts}
    hints = [] if fastened is None else fastened(assembly)
    for parts, evidence in hints:
        label = _free(f"{parts[0]}_body", taken)
        lines += [f"## {toml(sentence)[1:-1]}" for sentence in evidence.split("; ") if sentence]
        members = ", ".join(toml(part) for part in parts)
        lines += ["# [[group]]", f"# name = {toml(label)}", f"# parts = [{members}]"]
    if not hints:
        lines += ["# [[group]]", '# name = "…"', '# parts = ["…", "…"]']
    lines += ["", "# What the device is for:"]
    joints = [] if jointed is None else jointed(assembly)
    if joints:
        lines += ["# Journals that part the assembly, the largest parts first. Keep those that are meant, add what is"]
        lines += ["# missing: with complete = true the bodies follow from them."]
    lines += ["# [function]", "# complete = true" if joints else "# mobility = 1"]
    for joint, evidence in joints:
        stated = joint_lines(joint, units, reach(assembly))
        lines += ["#", f"## {toml(evidence)[1:-1]}", *(f"# {line}" for line in stated)]
    return lines


def reach(assembly: Assembly) -> float:
    """m: the greatest coordinate of any mesh."""
    boxes = [part.mesh.placed_box(part.X_WP) for part in assembly.parts if part.mesh is not None]
    return max((float(np.abs(box).max()) for box in boxes), default=0.0)


def joint_lines(joint: IntendedJoint, units: str, within: float) -> list[str]:
    """Lines of a `[[function.joint]]` in the manifest's unit, of an assembly whose coordinates reach so far (m): what
    is rounding beside that is 0."""
    lines = ["[[function.joint]]", f"name = {toml(joint.name)}", f"type = {toml(joint.type)}"]
    lines.append("between = [" + ", ".join(toml(name) for name in joint.between) + "]")
    if joint.axis is not None:
        lines.append(f"axis = {_numbers(_without_noise(joint.axis), 6)}")
    if joint.point is not None:
        point = np.where(np.abs(joint.point) < ARITHMETIC * within, 0.0, joint.point)
        lines.append(f"point = {_numbers(_without_noise(point / metres_per(units)), 6)}")
    return lines


def _without_noise(values: Array) -> Array:
    """The values without those that are rounding of meshes beside the largest."""
    # Components of a proposed axis or point below this share of the largest are written as zero: 0.001°, or 6 µm at 0.3
    # m, is the rounding of meshes in float32 far from the origin, and nothing that is meant.
    rest: Array = np.where(np.abs(values) < 2e-5 * np.abs(values).max(), 0.0, values)
    return rest


def _numbers(values: Array, digits: int) -> str:
    """As in "[0, 1, 0.25]", each to so many significant digits of the largest."""
    largest = max(float(np.abs(values).max()), ARITHMETIC)
    places = digits - 1 - math.floor(math.log10(largest))
    return "[" + ", ".join(f"{round(float(value), places) + 0.0:.12g}" for value in values) + "]"


def _free(name: str, taken: set[str]) -> str:
    """The name, numbered if it is taken; taken from now on."""
    free, number = name, 2
    while free in taken:
        free, number = f"{name}{number}", number + 1
    taken.add(free)
    return free


def doubts(assembly: Assembly) -> list[str]:
    """Why the unit of these meshes, not yet placed, is hard to believe, in sentences."""
    units = assembly.units
    corners = np.concatenate([np.array(p.mesh.placed_box(p.X_WP)) for p in assembly.parts if p.mesh is not None])
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    # what measures some tens of metres may be, but as often millimetres were taken for them
    mistaken = units == "m" and size >= MISTAKEN_METRES
    if SMALLEST_ASSEMBLY <= size <= LARGEST_ASSEMBLY and not mistaken:
        return []
    least, most = USUAL_ASSEMBLY
    better = [u for u in UNITS if least <= size / METRES_PER_UNIT[units] * METRES_PER_UNIT[u] <= most]
    advice = f"; units = {' or '.join(toml(u) for u in better)} would be more usual" if better else ""
    return [f"doubtful: in {units} the assembly is {length(size, 'mm', 3)} across{advice}"]


def _metres(units: str, problems: Problems) -> float:
    if units in UNITS:
        return metres_per(units)
    problems.add(f"unknown unit {in_quotes(units)}", None, None, did_you_mean(units, UNITS, "units"))
    return 1.0


def _bodies(paths: list[Path], problems: Problems) -> list[tuple[Path, str | None, str, RawMesh]]:
    """(file, body in the file, name of the part, facets)."""
    if not paths:
        raise InputError([Problem("no mesh is given", None, None, "name STL or OBJ files")])
    out: list[tuple[Path, str | None, str, RawMesh]] = []
    for path in paths:
        if states_units(path):
            problems.add("states its own unit of length", str(path), None, "leave units out, and name it alone")
            continue
        try:
            raw = read_raw(path)
        except MeshError as error:
            for fault in error.faults:
                problems.add(f"the mesh {fault.message}", str(path), fault.line, fault.remedy)
            continue
        except OSError as error:
            problems.add(f"cannot be read: {error.strerror}", str(path), None, "check the name of the mesh")
            continue
        bodies = named_bodies(raw)
        if not bodies and len(paths) == 1:
            shells = shell_bodies(raw)
            bodies = shells if len(shells) > 1 else {}
        if bodies:
            out += [(path, body, body.replace("/", "_"), part) for body, part in bodies.items()]
        else:
            out.append((path, None, path.stem.replace("/", "_"), raw))
    return out
