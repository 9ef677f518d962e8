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
from kinform_cli.options import Command, Group, PrintedTable, TableFormat, argument, examples, option
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
    cls=Command, epilog=examples("kinform catalog add designs/", "kinform catalog add arm.h5 hand.h5 -c robots.sqlite")
)
def add(
    sources: Annotated[list[Path], argument("DIR|F.h5...", "Folders, with all below them; or results files.")],
    file: File = _DEFAULT,
) -> None:
    """Add designs to the catalog: all results files below these folders.

    The catalog is made where there is none; a design that it has is read again.
    """
    files.check_text_output(file, inputs=sources)
    for source in sources:
        if source.is_file() and is_design(source):
            first = command("kinform", "run", source, "-o", source.with_suffix(".h5"))
            raise refuse("a catalog is of results", file=source, remedy=f"first {first}, then name that")
    from kinform import catalog

    old = catalog.read(file) if file.exists() else catalog.Catalog()
    _keep(*catalog.add(old, sources, file.parent), file)


@app.command(
    cls=Command,
    epilog=examples(
        "kinform catalog find --joint revolute --mobility 1",
        "kinform catalog find --joint revolute:2+ --loops 1 --max-mass 0.5",
        "kinform catalog find --name seeker --format json",
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
