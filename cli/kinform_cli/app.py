"""The command line itself: which commands there are, and `--version`."""

from __future__ import annotations

from typing import Annotated

import typer

from kinform_cli import console
from kinform_cli.commands import (
    catalog,
    check,
    contacts,
    diff,
    explain,
    export,
    import_,
    init,
    joints,
    lock,
    mass,
    query,
    report,
    run,
    schema,
    show,
    simulate,
    watch,
)
from kinform_cli.options import Command, Debug, Group, examples

__all__ = ["COMMANDS", "app"]

_WHOLE, _STAGES, _LOOK, _BEGIN = "The whole way", "Stage by stage", "Look", "Begin, and look up"
_CHANGE = "Change"

COMMANDS = (
    ("run", run.run, run.EXAMPLES, _WHOLE),
    ("import", import_.import_, import_.EXAMPLES, _STAGES),
    ("contacts", contacts.contacts, contacts.EXAMPLES, _STAGES),
    ("joints", joints.joints, joints.EXAMPLES, _STAGES),
    ("mass", mass.mass, mass.EXAMPLES, _STAGES),
    ("simulate", simulate.simulate, simulate.EXAMPLES, _STAGES),
    ("check", check.check, check.EXAMPLES, _STAGES),
    ("show", show.show, show.EXAMPLES, _LOOK),
    ("query", query.query, query.EXAMPLES, _LOOK),
    ("report", report.report, report.EXAMPLES, _LOOK),
    ("export", export.export, export.EXAMPLES, _LOOK),
    ("diff", diff.diff, diff.EXAMPLES, _CHANGE),
    ("lock", lock.lock, lock.EXAMPLES, _CHANGE),
    ("watch", watch.watch, watch.EXAMPLES, _CHANGE),
    ("init", init.init, init.EXAMPLES, _BEGIN),
    ("explain", explain.explain, explain.EXAMPLES, _BEGIN),
    ("schema", schema.schema, schema.EXAMPLES, _BEGIN),
)

_EXAMPLES = examples(
    "kinform init *.stl --units mm -o arm.toml   # a manifest to start from",
    "kinform run arm.toml -o arm.h5              # everything; exit code 0, 1 or 2",
    "kinform show arm.h5                         # what was derived",
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from kinform.version import __version__

        console.emit(f"kinform {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
    debug: Debug = False,
) -> None:
    """Derive joints, mobility, mass and motion from meshes, and check them against the intended
    function.

    Exit codes: 0 written, or verified. 1 findings (check, run), differences (diff). 2 not written, or not verified.
    """


def _build() -> typer.Typer:
    built = typer.Typer(
        name="kinform",
        cls=Group,
        context_settings={"help_option_names": ["--help", "-h"]},
    )
    built.callback(epilog=_EXAMPLES)(_root)
    for name, function, lines, panel in COMMANDS:
        built.command(name, cls=Command, epilog=lines, rich_help_panel=panel)(function)
    built.add_typer(_catalog(), name="catalog", help=catalog.HELP, epilog=catalog.EXAMPLES, rich_help_panel=_LOOK)
    return built


def _catalog() -> typer.Typer:
    """The command `kinform catalog` with those below it."""
    built = typer.Typer(cls=Group, no_args_is_help=False, context_settings={"help_option_names": ["--help", "-h"]})
    for name, function, lines in catalog.COMMANDS:
        built.command(name, cls=Command, epilog=lines)(function)
    return built


app = _build()
