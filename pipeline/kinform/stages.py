"""The stages of the method, one function each: a design goes in, a design with more in it comes out.

A stage takes over what an earlier run has left in the ledger where it is known that it would come out the same,
computes it otherwise, and drops whatever later stages had made of the old result (`kinform.reuse`). Packages are
imported by the stage that needs them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from kinform.design import Design
from kinform.errors import OpenSidesError, StageError
from kinform.form.sources import AS_IT_IS, Reading
from kinform.foundation.progress import Progress
from kinform.model.collisions import JointRange
from kinform.model.fingerprints import Fingerprints
from kinform.model.function import SimulationRequest
from kinform.reuse import fingerprints, lineage
from kinform.reuse.advance import Result, advance, descend, without
from kinform.reuse.dependence import CONTACTS, FINDINGS, JOINTS, MASS, SIMULATION
from kinform.reuse.ledger import Ledger

if TYPE_CHECKING:
    from kinform.ahead import Ahead
    from kinform.model.assembly import Assembly
    from kinform.model.kinematics import Kinematics
    from kinform.model.simulation import Simulation


Computed = TypeVar("Computed")


def import_(
    manifest: str | Path, *, allow_outside: bool = False, reading: Reading = AS_IT_IS, ledger: Ledger | None = None
) -> Design:
    """The assembly that a manifest, or a robot description, describes, meshes included. Raises InputError with every
    problem.

    Meshes of files that have not changed are taken from earlier results; where `reading` says more of how the source
    is read, all is read anew.
    """
    path = Path(manifest)
    plain = reading.of_files == AS_IT_IS
    earlier = _earlier_assembly(ledger or Ledger()) if plain else (None, {})
    assembly, contents = _read(path, allow_outside, reading, *earlier)
    if reading != AS_IT_IS:
        contents = {}  # they alone do not say what was read
    design = _imported(assembly)
    start = lineage.of_files(path.name, contents)
    marks = replace(design.fingerprints, files=contents, lineage={"assembly": start} if start else {})
    return replace(design, fingerprints=marks)


def import_meshes(
    meshes: Sequence[str | Path], *, units: str, name: str | None = None, density: float | None = None
) -> Design:
    """An assembly of meshes without a manifest: one file with several bodies, or several files.

    `units` is the length unit of the files, `density` of all parts (kg/m³). Raises InputError.
    """
    from kinform import form

    return _imported(form.load_meshes([Path(mesh) for mesh in meshes], units=units, name=name, density=density))


def import_assembly(assembly: Assembly) -> Design:
    """The design of an assembly that a program made: `form.from_meshes`."""
    return _imported(assembly)


def contacts(
    design: Design,
    *,
    jobs: int = 1,
    progress: Progress | None = None,
    ledger: Ledger | None = None,
    ahead: Ahead | None = None,
) -> Design:
    """Analytic surfaces of each mesh, and the contacts between parts.

    Earlier surfaces are reused mesh by mesh, earlier contacts pair by pair. `ahead` is made ready for later stages
    while other processes are at work.
    """
    from kinform.reuse import contacts as reuse

    ledger = ledger or Ledger()
    view = CONTACTS.view(design.assembly)
    start = without(CONTACTS, design)
    surfaces, meshes = reuse.surfaces(view, jobs, progress, ledger, ahead.with_surfaces if ahead else None)
    start = replace(start, surfaces=surfaces)
    mark = fingerprints.mark("contacts", fingerprints.of_stage(CONTACTS, start, {}))
    meanwhile = partial(ahead.with_contacts, surfaces) if ahead else None
    patches, pairs = reuse.contacts(view, surfaces, mark, jobs, progress, ledger, meanwhile)
    stages = start.fingerprints.stages | {"surfaces": fingerprints.mark("surfaces", meshes), "contacts": mark}
    marks = replace(start.fingerprints, stages=stages, meshes=meshes, pairs=pairs)
    return replace(start, contacts=patches, fingerprints=descend(marks, CONTACTS))


def joints(design: Design, *, ledger: Ledger | None = None) -> Design:
    """Bodies, joints, constraint matrix and mobility. Raises StageError without contacts."""
    ledger = ledger or Ledger()
    contacts = _needed(design.contacts, "kinform joints", "contacts")

    def derive(view: Assembly) -> Result:
        from kinform import kinematics
        from kinform.reuse.decisions import Decisions

        if all(part.mesh is None for part in view.parts):
            return Result({"kinematics": kinematics.functional(view)})
        decisions = Decisions(ledger)
        derived = kinematics.derive(view, design.surfaces, contacts, decisions)
        return Result({"kinematics": derived}, {"decisions": decisions.asked})

    try:
        done = advance(JOINTS, design, derive, ledger)
    except OpenSidesError as error:
        raise error.at({joint.name: (joint.file, joint.line) for joint in design.assembly.function.joints}) from None
    found = {} if done.kinematics is None else {one.joint: one.parts for one in done.kinematics.sides}
    if not found:
        return done
    return replace(done, assembly=replace(done.assembly, function=done.assembly.function.with_sides(found)))


def mass(design: Design, *, ledger: Ledger | None = None, ahead: Ahead | None = None) -> Design:
    """Mass properties of parts and bodies; of parts those that are known `ahead`. Raises StageError without joints."""
    ledger = ledger or Ledger()
    bodies = _needed(design.kinematics, "kinform mass", "joints").bodies

    def weigh(view: Assembly) -> Result:
        from kinform.mass import compile_mass
        from kinform.model.kinematics import only_bodies
        from kinform.reuse.masses import earlier_masses

        earlier = (ahead.masses if ahead else {}) | earlier_masses(design, view, ledger)
        return Result({"mass": compile_mass(view, only_bodies(bodies), design.surfaces, earlier)})

    return advance(MASS, design, weigh, ledger)


def simulate(
    design: Design,
    *,
    level: str | None = None,
    ranges: bool | None = None,
    jobs: int = 1,
    progress: Progress | None = None,
    say: Callable[[str], None] | None = None,
    ledger: Ledger | None = None,
    ahead: Ahead | None = None,
) -> Design:
    """Motion at the level that is known, or at `level`, with what the parts collide with in it; and how far each joint
    goes, unless `ranges` is False, or None and that would take long: then the run says so, unless the function states
    ranges or requirements. Raises StageError without mass properties.

    `say` is told what takes long besides the steps that `progress` counts; `ahead` as of `contacts`.
    """
    kinematics = _needed(design.kinematics, "kinform simulate", "joints")
    masses = _needed(design.mass, "kinform simulate", "mass")
    function = design.assembly.function
    meshed = any(part.mesh is not None for part in design.assembly.parts)
    stated = meshed and (bool(function.requirements) or any(joint.range is not None for joint in function.joints))
    unasked = _unasked(design.assembly, kinematics) if meshed and not stated and ranges is not True else ""
    by_default = meshed and not unasked
    wanted = by_default if ranges is None else meshed and ranges

    def move(view: Assembly) -> Result:
        from kinform import simulation

        stopping = view.simulation is not None and view.simulation.stops == "found"
        reach = _ranges(design, view, jobs, ahead) if stopping or wanted else None
        behaviour = simulation.port_model(
            view, kinematics, masses, level=level, contacts=design.contacts, surfaces=design.surfaces,
            reach=reach or (),
        )  # fmt: skip

        def run(view: Assembly, progress: Progress | None = None) -> Simulation:
            return simulation.simulate(
                view, kinematics, masses, level=level, progress=progress, say=say, behaviour=behaviour
            )  # fmt: skip

        def finer(times: int) -> Simulation:
            request = view.simulation or SimulationRequest()
            return run(replace(view, simulation=replace(request, step=request.step / times)))

        moved = _with_collisions(design, view, run(view, progress), reach, finer)
        if unasked and moved.ranges is None:
            moved = replace(moved, assumptions=(*moved.assumptions, unasked))
            if say is not None:
                say(unasked)
        return Result({"behaviour": behaviour, "simulation": moved})

    settings = {"whether ranges are asked for": "yes" if wanted else "no", "level": level}
    asked = level if wanted == by_default else f"{level}, ranges {wanted}"
    return advance(SIMULATION, design, move, ledger or Ledger(), settings, asked)


def check(design: Design, *, ledger: Ledger | None = None) -> Design:
    """Findings: behaviour against function, and form in itself. Raises StageError without simulation."""
    _needed(design.contacts, "kinform check", "contacts")
    _needed(design.kinematics, "kinform check", "joints")
    _needed(design.mass, "kinform check", "mass")
    _needed(design.simulation, "kinform check", "simulate")

    def judge(_: Assembly) -> Result:
        from kinform import consistency

        return Result({"report": consistency.check(without(FINDINGS, design))})

    done = advance(FINDINGS, design, judge, ledger or Ledger())
    if done.recorded or done.report is None:
        return done
    return replace(done, report=replace(done.report, origin="unknown"))


def _needed(result: Computed | None, stage: str, command: str) -> Computed:
    if result is None:
        raise StageError(f"`{stage}`", command)
    return result


def _imported(assembly: Assembly) -> Design:
    mark = fingerprints.mark("assembly", fingerprints.of_assembly(assembly))
    return Design(assembly, fingerprints=Fingerprints({"assembly": mark}))


def _earlier_assembly(ledger: Ledger) -> tuple[Assembly | None, Mapping[str, str]]:
    """The assembly that the present code read before, and what its files held; None where there is none."""
    files = ledger.fingerprints.files
    if ledger.previous is None or not files:
        return None, {}
    assembly = ledger.previous.assembly
    mark = fingerprints.mark("assembly", fingerprints.of_assembly(assembly))
    return (assembly, files) if ledger.fingerprints.stages.get("assembly") == mark else (None, {})


def _read(
    manifest: Path, allow_outside: bool, reading: Reading, earlier: Assembly | None, files: Mapping[str, str]
) -> tuple[Assembly, dict[str, str]]:
    """The assembly and the contents of its files; what earlier results hold is not read again."""
    if earlier is not None and not reading.changes:
        from kinform.form.reload import reload_meshes

        again = reload_meshes(manifest, earlier, files, allow_outside=allow_outside)
        if again is not None:
            return again
    from kinform.form.readers.assembly import load_with_contents

    return load_with_contents(manifest, allow_outside=allow_outside, reading=reading, earlier=earlier, files=files)


def _with_collisions(
    design: Design,
    view: Assembly,
    run: Simulation,
    ranges: tuple[JointRange, ...] | None,
    finer: Callable[[int], Simulation],
) -> Simulation:
    """The run with its collisions and how far joints go, as far as there are meshes. `finer` gives the run with so many
    times as many output times."""
    if not design.surfaces or design.kinematics is None or all(part.mesh is None for part in view.parts):
        return run
    if len(run.time) > 1:
        from kinform import collisions

        met, untested = collisions.along(
            view, design.surfaces, design.contacts, design.kinematics, run, finer=finer
        )  # fmt: skip
        run = replace(run, collisions=met, uncollided=untested)
    return run if ranges is None else replace(run, ranges=ranges)


def _unasked(assembly: Assembly, kinematics: Kinematics) -> str:
    """That ranges are not looked for where nobody asks, and why; empty where they are."""
    from kinform import collisions

    why = collisions.too_large(assembly, kinematics)
    return f"how far joints go was not looked for: {why}; --ranges asks" if why else ""


def _ranges(design: Design, view: Assembly, jobs: int, ahead: Ahead | None) -> tuple[JointRange, ...] | None:
    """How far joints go; None where there are no meshes to stop them."""
    if not design.surfaces or design.kinematics is None or all(part.mesh is None for part in view.parts):
        return None
    from kinform import collisions

    meanwhile = ahead.with_ranges if ahead else None
    return collisions.ranges(
        view, design.surfaces, design.contacts, design.kinematics, jobs=jobs, meanwhile=meanwhile
    )  # fmt: skip
