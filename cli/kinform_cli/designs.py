"""A whole design for commands that look at one: from a results file, a manifest, or any other source."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kinform_cli import console, files
from kinform_cli.progress import Working

if TYPE_CHECKING:
    from kinform.design import Design
    from kinform.form.sources import Reading

RESULTS = (".h5", ".hdf5")
_STAGES = ("contacts", "kinematics", "mass", "simulation", "report")
"""What a design has of which every stage was run."""


def whole_design(
    sources: Sequence[Path], *, units: str | None, reading: Reading, allow_outside: bool, jobs: int, as_it_is: bool
) -> Design:
    """The design with every stage. What a results file lacks is computed and not kept, unless it is wanted
    `as_it_is`; of any other source everything is computed, but what the results file beside it still has of it.
    What is whole is read part by part, as it is looked at.

    Raises InputError for sources that are no design, ResultsError for a results file that cannot be read.
    """
    from kinform import method
    from kinform.form.sources import AS_IT_IS
    from kinform.foundation.boundary import leads_out

    if len(sources) == 1 and sources[0].suffix.lower() in RESULTS:
        looked_into = files.read(sources[0], at_need=True)
        if as_it_is or all(map(looked_into.has, _STAGES)):
            return looked_into
        design = files.read(sources[0])
        with Working("run") as working:
            design, ran = method.completed(design, jobs=jobs, progress=working.step, say=console.say)
        if ran:
            console.say(f"{sources[0]} has no results of {', '.join(ran)}: they were computed, and not kept")
        return design
    manifest = files.is_manifest(sources, units)
    beside = sources[0].with_suffix(".h5")
    if manifest and reading == AS_IT_IS and not leads_out(beside) and beside.is_file():
        from kinform import results

        if results.read_if_current(beside, sources[0], allow_outside=allow_outside) is not None:
            console.say(f"{beside} holds this design as it is now: nothing is computed")
            return results.read(beside)
        if results.is_unknown(beside):
            console.warn(f"{beside}: {results.unknown_origin(beside)}: computed anew; name that file to look at it")
    with Working("run") as working:
        outcome = method.run(
            sources[0] if manifest else list(sources),
            jobs=jobs,
            progress=working.step,
            allow_outside=allow_outside,
            units=units,
            say=console.say,
            reading=reading,
        )
    return outcome.design


def looked_at(source: Path, *, at_need: bool = False) -> Design:
    """The design in a results file, as it is; of a manifest, description or scene every stage, and nothing is kept.

    With `at_need` a results file is read part by part, as it is looked at: for what is only shown.
    Raises as `whole_design`.
    """
    if source.is_dir():
        (source, *others) = files.sources_of([source])
        files.is_manifest([source, *others], None)
    if source.suffix.lower() in RESULTS or not is_design(source):
        return files.read(source, at_need=at_need)
    from kinform.form.sources import AS_IT_IS
    from kinform_cli.options import cores

    return whole_design(
        [source], units=None, reading=AS_IT_IS, allow_outside=False, jobs=cores(None), as_it_is=True
    )  # fmt: skip


def is_design(source: Path) -> bool:
    """Whether the name is that of a manifest, a robot description, or a CAD or scene file."""
    return source.suffix.lower() in (".toml", *files.DESCRIPTIONS, *files.SCENES)
