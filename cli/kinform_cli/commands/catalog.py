"""`kinform catalog`: a folder of designs, and which of them do what is wanted."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.designs import is_design
from kinform_cli.errors import refuse
from kinform_cli.options import (
    AllowXacro,
    Command,
    GeometryKind,
    Group,
    Packages,
    PrintedTable,
    TableFormat,
    TrustResults,
    argument,
    cores,
    examples,
    option,
    reading,
)
from kinform_cli.progress import Working
from kinform_cli.text import command

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kinform.catalog import Catalog, Refused


app = typer.Typer(
    name="catalog",
    cls=Group,
    add_completion=False,
    help="Keep a catalog of designs, and find designs by what they do.",
    epilog=examples(
        "kinform catalog add designs/", "kinform catalog find --joint revolute --mobility 1", "kinform catalog rebuild"
    ),
)

File = Annotated[
    Path, typer.Option("--catalog", "-c", metavar="FILE", envvar="KINFORM_CATALOG", help="The catalog, an SQLite file.")
]
_DEFAULT = Path("catalog.sqlite")


@app.command(
    cls=Command,
    epilog=examples(
        "kinform catalog add designs/", "kinform catalog add arm.h5 hand.h5 -c robots.sqlite",
        "kinform catalog add robot.urdf arm.step",
    ),
)  # fmt: skip
def add(
    sources: Annotated[
        list[Path], argument("DIR|F.h5|SOURCE...", "Folders, with all results below them; results files; any source.")
    ],
    file: File = _DEFAULT,
    packages: Packages = None,
    allow_xacro: AllowXacro = False,
    trust_results: TrustResults = False,
) -> None:
    """Add designs to the catalog: all results files below these folders.

    The catalog is made where there is none; a design that it has is read again. A manifest, description or CAD file is
    run first, with its results beside it: robot.urdf gives robot.h5.
    """
    files.check_text_output(file, inputs=sources)
    results = [_results_of(source, packages, allow_xacro, trust_results) for source in sources]
    from kinform import catalog

    old = catalog.read(file) if file.exists() else catalog.Catalog()
    _keep(*catalog.add(old, results, file.parent), file)


def _results_of(source: Path, packages: Packages, allow_xacro: bool, trust: bool) -> Path:
    """The results of a source, which are made where they are not; another path as it is."""
    if not (source.is_file() and is_design(source)):
        return source
    output = source.with_suffix(".h5")
    files.check_outputs([source], output, None)
    if output.exists() and (other := files.read(output).assembly.source.file) != source.name:
        run = command("kinform", "run", source, "-o", source.with_name(f"{source.name}.h5"))
        raise refuse(f"{output.name} beside it holds results of {other}", file=source,
                     remedy=f"run it to a name of its own: {run}, then name that")  # fmt: skip
    import kinform

    with Working("run") as working:
        kinform.run(
            source, output, jobs=cores(None), progress=working.step, say=console.say,
            reading=reading(GeometryKind.visual, packages, allow_xacro=allow_xacro), trust_results=trust,
        )  # fmt: skip
    console.say(f"{output}: results of {source}")
    return output


@app.command(
    cls=Command,
    epilog=examples(
        "kinform catalog find --joint revolute --mobility 1",
        "kinform catalog find --joint revolute:2+ --loops 1 --max-mass 0.5",
        "kinform catalog find --name seeker --format json",
        "kinform catalog find --like arm.h5",
    ),
)
def find(
    joint: Annotated[
        list[str] | None,
        option(
            "--joint",
            "TYPE[:N]",
            "Has a joint of this type; revolute:2 exactly two, revolute:2+ at least two. May be repeated.",
        ),
    ] = None,
    joints: Annotated[int | None, option("--joints", "N", "Number of joints of any type.", min=0)] = None,
    mobility: Annotated[int | None, option("--mobility", "N", "Effective mobility.", min=0)] = None,
    instantaneous: Annotated[int | None, option("--instantaneous", "N", "Instantaneous mobility.", min=0)] = None,
    loops: Annotated[int | None, option("--loops", "N", "Independent kinematic loops.", min=0)] = None,
    min_mass: Annotated[float | None, option("--min-mass", "KG", "Least mass.")] = None,
    max_mass: Annotated[float | None, option("--max-mass", "KG", "Greatest mass.")] = None,
    max_size: Annotated[float | None, option("--max-size", "METRES", "Longest side of the box around it.")] = None,
    name: Annotated[
        list[str] | None,
        option(
            "--name", "TEXT", "Text in the name of the design, its file, a part or a stated joint. May be repeated."
        ),
    ] = None,
    meets: Annotated[
        list[str] | None, option("--meets", "WHAT", "Meets its requirements of this kind, or of this name.")
    ] = None,
    verified: Annotated[bool, typer.Option("--verified", help="Only designs that passed the gate.")] = False,
    alike: Annotated[
        Path | None,
        option("--like", "F.h5", "Designs that do the same: graph of joints and mobility, then axes and size; alone."),
    ] = None,
    file: File = _DEFAULT,
    format: PrintedTable = TableFormat.table,
) -> None:
    """Find designs by what they do; everything that is asked must hold.

    The exit code says whether there is an answer (0), not whether a design was found.
    """
    for limit, value in (("--min-mass", min_mass), ("--max-mass", max_mass), ("--max-size", max_size)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise typer.BadParameter(f"{value:g} is not a positive number", param_hint=limit)
    from kinform import catalog

    wanted = catalog.Wanted(
        _joint_counts(joint or []), joints, mobility, instantaneous, loops, min_mass, max_mass, max_size,
        tuple(name or ()), tuple(meets or ()), verified,
    )  # fmt: skip
    if alike is not None:
        if wanted != catalog.Wanted():
            raise typer.BadParameter("asks for all that a design does: give it alone", param_hint="--like")
        if is_design(alike):
            run = command("kinform", "run", alike, "-o", alike.with_suffix(".h5"))
            raise refuse("--like takes a results file", file=alike, remedy=f"first {run}, then name that")
        with files.needing(alike):
            near, total = catalog.like(file, catalog.entry_of(files.read(alike), "", ""))
        designs = tuple(entry for _, entry in near)
    else:
        designs, total = catalog.find(file, wanted)
    states = [catalog.source_state(entry, file.parent) for entry in designs]
    from kinform_cli.views import catalog as view

    if format is TableFormat.json:
        console.emit(view.as_json(designs, states))
    else:
        console.out(view.render(designs, states, total))
    if any(states):
        console.warn(
            "results changed since they were added: " + command("kinform", "catalog", "rebuild", "--catalog", file)
        )


@app.command(cls=Command, epilog=examples("kinform catalog rebuild", "kinform catalog rebuild -c robots.sqlite"))
def rebuild(file: File = _DEFAULT) -> None:
    """Make the catalog again from the folders and files that were added to it."""
    from kinform import catalog

    old = catalog.read(file)
    files.check_text_output(file)
    _keep(*catalog.rebuild(old, file.parent), file)


def _keep(kept: Catalog, refused: Sequence[Refused], file: Path) -> None:
    from kinform import catalog

    catalog.write(kept, file)
    for item in refused:
        console.warn(f"left out {item.path}: {item.reason}")
    console.say(f"{file}: {counted(len(kept.entries), 'design')}")


def _joint_counts(asked: Sequence[str]) -> tuple[tuple[str, int, int | None], ...]:
    from kinform.catalog import joint_count

    try:
        return tuple(joint_count(text) for text in asked)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--joint") from None
