"""The stages of the method, one function each: a design goes in, a design with more in it comes out.

A stage takes over what an earlier run has left in the ledger if its fingerprint says that it would come
out the same, computes it otherwise, and drops whatever later stages had made of the old result. Packages
are imported by the stage that needs them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from kinform.design import Design
from kinform.errors import StageError
from kinform.foundation.progress import Progress
from kinform.model.fingerprints import Fingerprints
from kinform.model.function import SimulationRequest
from kinform.reuse.ledger import Ledger

if TYPE_CHECKING:
    from kinform.behaviour import Behaviour
    from kinform.model.assembly import Assembly
    from kinform.model.kinematics import Kinematics
    from kinform.model.mass import MassProperties
    from kinform.model.simulation import Simulation
    from kinform.results import Earlier
    from kinform.reuse.decisions import Known

__all__ = ["Progress", "check", "contacts", "import_", "import_meshes", "joints", "mass", "simulate"]


Result = TypeVar("Result")

_FIELDS = {
    "contacts": "contacts", "joints": "kinematics", "mass": "mass", "simulation": "simulation",
    "findings": "report",
}  # fmt: skip
"""Stages after the import in their order, and the field of Design that each fills."""


def import_(manifest: str | Path, *, allow_outside: bool = False, ledger: Ledger | None = None) -> Design:
    """The assembly that a manifest describes, meshes included. Raises InputError with every problem.

    Meshes of files that have not changed are taken from earlier results.
    """
    from kinform.reuse import lineage

    before = None if ledger is None else ledger.previous
    files = {} if before is None or not _current_import(before) else before.fingerprints.files
    earlier = before.assembly if before is not None and files else None
    assembly, contents = _read(Path(manifest), allow_outside, earlier, files)
    design = _imported(assembly)
    start = lineage.of_files(Path(manifest).name, contents)
    marks = replace(design.fingerprints, files=contents, lineage={"assembly": start} if start else {})
    return replace(design, fingerprints=marks)


def _read(
    manifest: Path, allow_outside: bool, earlier: Assembly | None, files: Mapping[str, str]
) -> tuple[Assembly, dict[str, str]]:
    """The assembly and the contents of its files; what earlier results hold is not read again."""
    if earlier is not None:
        from kinform.form.reload import reload_meshes

        again = reload_meshes(manifest, earlier, files, allow_outside=allow_outside)
        if again is not None:
            return again
    from kinform.form.readers.assembly import load_with_contents

    return load_with_contents(manifest, allow_outside=allow_outside, earlier=earlier, files=files)


def _current_import(design: Design | Earlier) -> bool:
    """Whether the present code read this assembly."""
    from kinform.reuse import fingerprints

    mark = fingerprints.mark("assembly", fingerprints.of_assembly(design.assembly))
    return design.fingerprints.stages.get("assembly") == mark


def import_meshes(
    meshes: Sequence[str | Path], *, units: str, name: str | None = None, density: float | None = None
) -> Design:
    """An assembly of meshes without a manifest: one file with several bodies, or several files.

    `units` is the length unit of the files, `density` of all parts (kg/m³). Raises InputError.
    """
    from kinform import form

    return _imported(form.load_meshes([Path(mesh) for mesh in meshes], units=units, name=name, density=density))


def contacts(
    design: Design, *, jobs: int = 1, progress: Progress | None = None, ledger: Ledger | None = None
) -> Design:
    """Analytic surfaces of each mesh, and the contacts between parts.

    Earlier surfaces are reused mesh by mesh, earlier contacts pair by pair.
    """
    from kinform.reuse import fingerprints, inputs, touching

    ledger = ledger or Ledger()
    view = inputs.assembly_for("contacts", design.assembly)
    start = _without(design, "contacts")
    surfaces, meshes = touching.surfaces(view, jobs, progress, ledger)
    start = replace(start, surfaces=surfaces)
    mark = fingerprints.mark("contacts", fingerprints.of_stage("contacts", start))
    found, pairs = touching.contacts(view, surfaces, mark, jobs, progress, ledger)
    marks = {"surfaces": fingerprints.mark("surfaces", meshes), "contacts": mark}
    stages = start.fingerprints.stages | marks
    marked = replace(start.fingerprints, stages=stages, meshes=meshes, pairs=pairs)
    return replace(start, contacts=found, fingerprints=_descended(marked, "contacts"))


def joints(design: Design, *, jobs: int = 1, ledger: Ledger | None = None) -> Design:
    """Bodies, joints, constraint matrix and mobility. Raises StageError without contacts."""
    found = _needed(design.contacts, "kinform joints", "contacts")
    known: list[Known] = []

    def derive(view: Assembly) -> Any:
        from kinform import kinematics
        from kinform.reuse.decisions import Known

        if all(part.mesh is None for part in view.parts):
            return kinematics.functional(view)
        known.append(Known(ledger))
        beside = known[-1].beside if jobs > 1 else None
        return kinematics.derive(view, design.surfaces, found, known[-1], beside)

    done = _advance("joints", design, derive, ledger)
    before = None if ledger is None or ledger.previous is None else ledger.previous.fingerprints
    if known:
        marks = replace(done.fingerprints, decisions=known[-1].decisions)
    elif before is not None and before.stages.get("joints") == done.fingerprints.stages["joints"]:
        marks = replace(done.fingerprints, decisions=before.decisions)
    else:
        return done
    return replace(done, fingerprints=marks)


def mass(design: Design, *, ledger: Ledger | None = None) -> Design:
    """Mass properties of parts and bodies. Raises StageError without joints."""
    found = _needed(design.kinematics, "kinform mass", "joints")

    def compile_(view: Assembly) -> Any:
        from kinform.mass import compile_mass
        from kinform.model.kinematics import only_bodies

        earlier = _earlier_masses(design, view, ledger)
        return compile_mass(view, only_bodies(found.bodies), design.surfaces, earlier)

    return _advance("mass", design, compile_, ledger)


def simulate(
    design: Design,
    *,
    level: str | None = None,
    ranges: bool | None = None,
    progress: Progress | None = None,
    say: Callable[[str], None] | None = None,
    ledger: Ledger | None = None,
) -> Design:
    """Motion at the level that is known, or at `level`, with what the parts collide with in it; and how far each joint goes:
    where `ranges` says so, else where the function states ranges or requirements. Raises StageError without mass
    properties.

    `say` is told what takes long besides the steps that `progress` counts.
    """
    kinematics = _needed(design.kinematics, "kinform simulate", "joints")
    masses = _needed(design.mass, "kinform simulate", "mass")
    function = design.assembly.function
    meshed = any(part.mesh is not None for part in design.assembly.parts)
    stated = meshed and (bool(function.requirements) or any(joint.range is not None for joint in function.joints))
    wanted = stated if ranges is None else meshed and ranges

    made: list[Behaviour] = []

    def run(view: Assembly) -> Any:
        from kinform import simulation

        made.append(simulation.modelled(view, kinematics, masses, level=level))
        run = simulation.simulate(
            view, kinematics, masses, level=level, progress=progress, say=say, behaviour=made[-1]
        )  # fmt: skip

        def finer(times: int) -> Simulation:
            request = view.simulation or SimulationRequest()
            closer = replace(view, simulation=replace(request, step=request.step / times))
            return simulation.simulate(closer, kinematics, masses, level=level, say=say, behaviour=made[-1])

        return _collided(view, design, kinematics, run, wanted, finer)

    asked = level if wanted == stated else f"{level}, ranges {wanted}"
    done = _advance("simulation", design, run, ledger, level, wanted, asked)
    if made:
        return replace(done, behaviour=made[-1])
    kept = ledger.previous.behaviour if ledger is not None and ledger.previous is not None else None
    return replace(done, behaviour=kept)


def _collided(
    view: Assembly,
    design: Design,
    kinematics: Kinematics,
    run: Simulation,
    ranges: bool,
    finer: Callable[[int], Simulation],
) -> Simulation:
    """The run with its collisions and the ranges of joints, as far as there are meshes."""
    if not design.surfaces or all(part.mesh is None for part in view.parts):
        return run
    if len(run.time) > 1:
        from kinform import collisions

        met, untested = collisions.along(view, design.surfaces, design.contacts, kinematics, run, finer=finer)
        run = replace(run, collisions=met, uncollided=untested)
    if ranges:
        from kinform import collisions

        run = replace(run, ranges=collisions.ranges(view, design.surfaces, design.contacts, kinematics))
    return run


def check(design: Design, *, ledger: Ledger | None = None) -> Design:
    """Findings: behaviour against function, and form in itself. Raises StageError without simulation."""
    _needed(design.contacts, "kinform check", "contacts")
    _needed(design.kinematics, "kinform check", "joints")
    _needed(design.mass, "kinform check", "mass")
    _needed(design.simulation, "kinform check", "simulate")

    def find(_: Assembly) -> Any:
        from kinform import consistency

        return consistency.check(_without(design, "findings"))

    return _advance("findings", design, find, ledger)


def _imported(assembly: Assembly) -> Design:
    from kinform.reuse import fingerprints

    mark = fingerprints.mark("assembly", fingerprints.of_assembly(assembly))
    return Design(assembly, fingerprints=Fingerprints({"assembly": mark}))


def _needed(result: Result | None, stage: str, command: str) -> Result:
    if result is None:
        raise StageError(f"`{stage}`", command)
    return result


def _without(design: Design, stage: str) -> Design:
    """The design before that stage: without its result, and without those of later stages."""
    order = list(_FIELDS)
    later = order[order.index(stage) :]
    marks = design.fingerprints
    stages = {name: mark for name, mark in marks.stages.items() if name not in later}
    if stage == "contacts":
        stages.pop("surfaces", None)
        marks, design = replace(marks, meshes={}, pairs={}), replace(design, surfaces={})
    if "joints" in later:
        marks = replace(marks, decisions={})
    if "simulation" in later:
        design = replace(design, behaviour=None)
    lineage = {name: mark for name, mark in marks.lineage.items() if name not in later}
    inputs = {name: found for name, found in marks.inputs.items() if name not in later}
    cleared: dict[str, Any] = {_FIELDS[name]: None for name in later}
    return replace(design, **cleared, fingerprints=replace(marks, stages=stages, lineage=lineage, inputs=inputs))


def _descended(marks: Fingerprints, stage: str, level: str | None = None) -> Fingerprints:
    """The fingerprints with the lineage of this stage, where that of the stage before is known."""
    from kinform.reuse import lineage

    before = lineage.STAGES[lineage.STAGES.index(stage) - 1]
    found = lineage.following(stage, marks.lineage.get(before, ""), level)
    return replace(marks, lineage=marks.lineage | {stage: found}) if found else marks


def _advance(
    stage: str,
    design: Design,
    compute: Callable[[Assembly], Any],
    ledger: Ledger | None,
    level: str | None = None,
    ranges: bool | None = None,
    asked: str | None = None,
) -> Design:
    """The design with the result of the stage: the earlier one where nothing changed, else a new one; `asked`: what was
    asked for beside what the design says."""
    from kinform.reuse import fingerprints, inputs

    ledger = ledger or Ledger()
    start = _without(design, stage)
    found = fingerprints.of_stage(stage, start, level, ranges)
    mark = fingerprints.mark(stage, found)
    previous = ledger.previous
    before = Fingerprints() if previous is None else previous.fingerprints
    result = None if before.stages.get(stage) != mark else getattr(previous, _FIELDS[stage])
    if result is not None:
        ledger.keep(stage)
    else:
        known = before.inputs.get(stage, {}) if stage in before.stages else None
        ledger.compute(stage, fingerprints.changes(known, found))
        result = compute(inputs.assembly_for(stage, design.assembly))
    marks = replace(
        start.fingerprints,
        stages=start.fingerprints.stages | {stage: mark},
        inputs=start.fingerprints.inputs | {stage: dict(found)},
    )
    return replace(
        start,
        **{_FIELDS[stage]: result},
        fingerprints=_descended(marks, stage, asked),
    )


def _earlier_masses(design: Design, view: Assembly, ledger: Ledger | None) -> dict[str, MassProperties]:
    """Of earlier results of the present code, the mass properties of parts that are the same to the last bit."""
    from kinform.reuse import fingerprints, inputs
    from kinform.reuse.digest import digest

    before = None if ledger is None else ledger.previous
    if before is None or before.assembly.tolerances != view.tolerances or "mass" not in before.fingerprints.inputs:
        return {}
    if before.fingerprints.stages.get("mass") != fingerprints.mark("mass", before.fingerprints.inputs["mass"]):
        return {}
    if before.mass is None:
        return {}
    known, now = before.fingerprints.meshes, design.fingerprints.meshes
    old = {part.name: digest(part) for part in inputs.assembly_for("mass", before.assembly).parts}
    same = {
        str(part.name)
        for part in view.parts
        if old.get(part.name) == digest(part)
        and (part.mesh is None or known.get(part.mesh.digest) == now.get(part.mesh.digest) is not None)
    }
    return {item.name: item for item in before.mass.parts if item.name in same}
