"""The method, one line a stage: form → surfaces and contacts → joints → mass → motion → findings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinform.api import Outcome
from kinform.design import Design
from kinform.errors import InputError, Problem, ResultsError
from kinform.form.sources import AS_IT_IS, Reading
from kinform.foundation.progress import Progress as StageProgress

if TYPE_CHECKING:
    from kinform.reuse.ledger import Ledger

if TYPE_CHECKING:
    from kinform.results import Earlier


Progress = Callable[[str, int, int], None]
"""Called with the name of the stage, its steps done, and its steps in all."""


def run(
    manifest: Any,
    output: str | Path | None = None,
    *,
    jobs: int = 1,
    progress: Progress | None = None,
    allow_outside: bool = False,
    units: str | None = None,
    say: Callable[[str], None] | None = None,
    ranges: bool | None = None,
    changed: bool = False,
    reading: Reading = AS_IT_IS,
    base: str | Path | None = None,
    trust_results: bool = False,
) -> Outcome:
    """Everything about a design, from its manifest to the findings.

    `manifest` is a TOML file, a robot description or a CAD or scene file (URDF, xacro, SDF, MJCF, STEP, GLB, glTF;
    `reading` says how it is read), or one or several mesh files, which need `units`; or what a program holds: {name:
    mesh or (mesh, pose)} with `units`, a scene of trimesh, or an assembly made of such. With `output` the results are
    written there in one step, and what is still valid in an earlier file is reused, if this user's kinform wrote it or
    `trust_results`; the result is the same, byte for byte, as one made from nothing. `jobs` processes share the work.
    Meshes outside the manifest's folder need `allow_outside`. `say` is told what takes long besides, and of an earlier
    file that is no longer whole or not reused because of its origin. `ranges`: whether it is found how far each joint
    goes; None: unless that would take long and the function states no ranges or requirements. `base`: results of a
    design that is nearly the same, of which is taken what holds, whoever wrote them, where there is no `output`.
    `changed`: an earlier file is known not to be what a run would give, and is not asked.

    Raises InputError with every problem of the input, ResultsError when `output` cannot be written.
    """
    plain = units is None and ranges is None and not changed and reading == AS_IT_IS
    if output is not None and plain and isinstance(manifest, str | Path):
        unchanged = Outcome.unchanged(Path(manifest), Path(output), allow_outside=allow_outside, trust=trust_results)
        if unchanged is not None:
            return unchanged
    from kinform import ahead, stages  # not before: seeing that nothing changed takes less time than importing them
    from kinform.reuse.ledger import Ledger

    earlier, absent = _earlier(output or base, say, trust_results or output is None)

    def derived(ledger: Ledger) -> Design:
        design = _import(manifest, units, allow_outside, reading, ledger).of_origin(ledger.recorded)
        ready = ahead.of(design.assembly)
        design = stages.contacts(design, jobs=jobs, progress=_steps(progress, "contacts"), ledger=ledger, ahead=ready)
        design = stages.joints(design, ledger=ledger)
        design = stages.mass(design, ledger=ledger, ahead=ready)
        design = stages.simulate(
            design, ranges=ranges, jobs=jobs, progress=_steps(progress, "simulation"), say=say, ledger=ledger,
            ahead=ready,
        )  # fmt: skip
        return stages.check(design, ledger=ledger)

    ledger = Ledger(earlier, absent)
    try:
        design = derived(ledger)
    except ResultsError as error:  # an earlier file that makes no sense: seen where it was read
        if earlier is None:
            raise
        _tell_absent(error, say)
        ledger = Ledger()
        design = derived(ledger)
    account = ledger.account(design.fingerprints.files)
    if output is not None:
        from kinform import results

        if earlier is not None:
            earlier.close()
        results.write(design, output)
    return Outcome(design, tuple(ledger.reused), tuple(ledger.recomputed), account=account)


def completed(
    design: Design, *, jobs: int = 1, progress: Progress | None = None, say: Callable[[str], None] | None = None
) -> tuple[Design, tuple[str, ...]]:
    """The design with every stage that it lacks, and the names of those; nothing that it has is computed again."""
    from kinform import stages

    ran = []
    if design.contacts is None:
        design = stages.contacts(design, jobs=jobs, progress=_steps(progress, "contacts"))
        ran.append("contacts")
    if design.kinematics is None:
        design = stages.joints(design)
        ran.append("joints")
    if design.mass is None:
        design = stages.mass(design)
        ran.append("mass")
    if design.simulation is None:
        design = stages.simulate(design, jobs=jobs, progress=_steps(progress, "simulation"), say=say)
        ran.append("simulate")
    if design.report is None:
        design = stages.check(design)
        ran.append("check")
    return design, tuple(ran)


def _import(
    manifest: Any,
    units: str | None,
    allow_outside: bool,
    reading: Reading,
    ledger: Ledger,
) -> Design:
    """The assembly of a manifest, or of meshes in place of one, as files or as a program holds them."""
    from kinform import stages
    from kinform.model.assembly import Assembly

    if isinstance(manifest, Assembly):
        return stages.import_assembly(manifest)
    if isinstance(manifest, Mapping) or not isinstance(manifest, str | Path | Sequence):
        from kinform.form.from_python import from_meshes

        return stages.import_assembly(from_meshes(manifest, units=units))

    paths = [manifest] if isinstance(manifest, str | Path) else list(manifest)
    if units is not None:
        return stages.import_meshes(paths, units=units)
    if len(paths) != 1 or Path(paths[0]).suffix.lower() in (".stl", ".obj", ".ply", ".off"):
        problem = Problem("the unit of these meshes is not stated", str(paths[0]), None, "state units")
        raise InputError([problem])
    return stages.import_(paths[0], allow_outside=allow_outside, reading=reading, ledger=ledger)


def _earlier(output: str | Path | None, say: Callable[[str], None] | None, trust: bool) -> tuple[Earlier | None, str]:
    """What an earlier run has left whole in `output`, if anything, and why it is not reused where it is not. Raises
    ResultsError where it cannot be written."""
    from kinform.reuse.ledger import NONE, UNKNOWN

    if output is None:
        return None, NONE
    from kinform import results

    unknown = False

    def strange(text: str) -> None:
        nonlocal unknown
        unknown = True
        if say is not None:
            say(f"warning: {text}")

    warn = None if say is None else lambda text: say(f"warning: {text}")
    found = results.earlier(output, warn, strange, trust=trust)
    return found, UNKNOWN if unknown else NONE


def _tell_absent(error: ResultsError, say: Callable[[str], None] | None) -> None:
    """Say that an earlier file is as good as none."""
    from kinform import results

    if say is not None:
        say(f"warning: {results.as_absent(error)}")


def _steps(progress: Progress | None, stage: str) -> StageProgress | None:
    """The progress of one stage, as the stage reports it."""
    return None if progress is None else lambda done, total: progress(stage, done, total)
