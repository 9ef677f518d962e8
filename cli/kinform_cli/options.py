"""Options and arguments that several commands share, and how a command's help is laid out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from kinform_cli import console
from kinform_cli.choices import FindingsFormat, Severity, TableFormat, cores

__all__ = [
    "AllowOutside",
    "Command",
    "Debug",
    "Depfile",
    "FailOn",
    "FindingsFormat",
    "Group",
    "Jobs",
    "ManifestFolder",
    "Output",
    "Quiet",
    "Ranges",
    "Results",
    "Severity",
    "TableFormat",
    "Tolerances",
    "Units",
    "cores",
    "examples",
]


class _WithExamples:
    """Help at whose end examples stand, line by line as they are written."""

    epilog: str | None

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Print typer's help, then the examples (kept in `epilog`)."""
        text, self.epilog = self.epilog, None
        try:
            super().format_help(ctx, formatter)  # type: ignore[misc]
        finally:
            self.epilog = text
        if text:
            console.emit(text)


class Command(_WithExamples, TyperCommand):
    """One command."""


class Group(_WithExamples, TyperGroup):
    """The command `kinform` itself."""


def examples(*lines: str) -> str:
    """The epilog that shows these command lines."""
    return "\n".join([" Examples:", *(f"   {line}" for line in lines)])


def _set_quiet(value: bool) -> None:
    console.settings.quiet = console.settings.quiet or value


def _set_debug(value: bool) -> None:
    console.settings.debug = console.settings.debug or value


Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet",
        "-q",
        callback=_set_quiet,
        help="No progress, summaries or warnings on stderr; errors stay.",
    ),
]
Debug = Annotated[
    bool,
    typer.Option("--debug", callback=_set_debug, help="Show the traceback of an error (also: KINFORM_DEBUG=1)."),
]
Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs", "-j", min=1, metavar="N", show_default=False, help="Use up to N cores; default: all of them."
    ),
]

Ranges = Annotated[
    bool | None,
    typer.Option(
        "--ranges/--no-ranges",
        show_default=False,
        help="Find how far each joint goes until parts meet; else only where the function states ranges or requirements.",
    ),
]


Results = Annotated[Path, typer.Argument(metavar="F.h5", show_default=False, help="Results file to read.")]
Output = Annotated[
    Path,
    typer.Option(
        "--output",
        "-o",
        metavar="F.h5",
        show_default=False,
        help="Results file to write; may be the one that is read.",
    ),
]
AllowOutside = Annotated[
    bool,
    typer.Option("--allow-outside", help="Accept meshes outside the manifest's folder."),
]
Units = Annotated[
    str | None,
    typer.Option(
        "--units",
        metavar="UNIT",
        show_default=False,
        help="Unit of the meshes named in place of a manifest: m, cm, mm, um, in or ft.",
    ),
]
Depfile = Annotated[
    Path | None,
    typer.Option(
        "--depfile",
        metavar="FILE",
        show_default=False,
        help="Also write a Make rule: the output depends on every file that was read.",
    ),
]
ManifestFolder = Annotated[
    Path | None,
    typer.Option(
        "--manifest-folder",
        metavar="DIR",
        show_default=False,
        help="Folder of the manifest: sarif and github then name files as seen from here.",
    ),
]
Tolerances = Annotated[
    list[str] | None,
    typer.Option(
        "--tolerance",
        metavar="VALUE",
        show_default=False,
        help="Changes up to this are none: 0.1mm, 0.2deg, 1g, 0.5% (of masses); may be given once for each.",
    ),
]
FailOn = Annotated[
    Severity,
    typer.Option("--fail-on", help="Least severity of a finding that gives exit code 1."),
]
