"""Options and arguments that several commands share, and how a command's help is laid out."""

from __future__ import annotations

import math
import os
import re
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from kinform.frozen import dataclass
from kinform_cli import console
from kinform_cli.taken_as_is import take_as_is

if TYPE_CHECKING:
    from kinform.form.sources import Reading


class _WithExamples:
    """Help at whose end examples stand, line by line as they are written; plain values are taken as they are."""

    epilog: str | None
    params: list[Any]

    def get_params(self, ctx: Any) -> list[Any]:
        """As typer."""
        parameters: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for parameter in parameters:
            take_as_is(parameter)
        return parameters

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Print typer's help, then the examples (kept in `epilog`)."""
        text, self.epilog = self.epilog, None
        told = [(item, item.help) for item in (self, *self.params) if getattr(item, "help", None)]
        for item, help in told:
            # else `[function]` would be read as markup, and be gone
            item.help = _in_paragraphs(help).replace("[", r"\[")
        try:
            super().format_help(ctx, formatter)  # type: ignore[misc]
        finally:
            self.epilog = text
            for item, help in told:
                item.help = help
        if text:
            console.emit(text)


def _in_paragraphs(text: str) -> str:
    """The text without the ends of lines of the source, which typer keeps beside its own."""
    return re.sub(r"(?<!\n)\n(?![\n \-*])", " ", text)


class Command(_WithExamples, TyperCommand):
    """One command; it takes --quiet and --debug beside its own options."""

    def __init__(self, *arguments: Any, **settings: Any):
        super().__init__(*arguments, **settings)
        self.params += _options_of_all()


class Group(_WithExamples, TyperGroup):
    """A command with others below it; alone it shows its help, and has done nothing."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As typer; the help where nothing is asked."""
        if not args and ctx.parent is not None:
            self.format_help(ctx, ctx.make_formatter())
            ctx.exit(2)
        return super().parse_args(ctx, args)


@cache
def _options_of_all() -> list[Any]:
    """The options that every command takes; their callbacks do all that they ask for."""

    def takes(quiet: Quiet = False, debug: Debug = False) -> None: ...

    app = typer.Typer(add_completion=False)
    app.command()(takes)
    options = typer.main.get_command(app).params
    for option in options:
        option.expose_value = False
    return options


def examples(*lines: str) -> str:
    """The epilog that shows these command lines."""
    return "\n".join([" Examples:", *(f"   {line}" for line in lines)])


def cores(jobs: int | None) -> int:
    """How many processes `--jobs` stands for."""
    return jobs or os.cpu_count() or 1


def reading(
    geometry: GeometryKind, packages: list[str] | None, deviation: str | None = None, *, allow_xacro: bool
) -> Reading:
    """How sources are read, by the options of the command line; a usage error where one is none."""
    from kinform.form.sources import Reading

    pairs = []
    for stated in packages or ():
        name, equals, folder = stated.partition("=")
        if not (name and equals and folder):
            raise typer.BadParameter(f"{stated!r} is not NAME=FOLDER", param_hint="--package")
        if not Path(folder).is_dir():
            raise typer.BadParameter(f"there is no folder {folder}", param_hint="--package")
        pairs.append((name, folder))
    chordal = None if deviation is None else _length(deviation, "--deviation")
    return Reading(geometry.value, tuple(pairs), chordal, allow_xacro=allow_xacro)


def _length(stated: str, hint: str) -> float:
    """Metres in a positive length with its unit, such as 0.01mm; a usage error where it is none."""
    from kinform.foundation.units import UNITS, metres_per

    match = re.fullmatch(r"([0-9.eE+-]+) ?([a-z]+)", stated.strip())
    try:
        value = float(match[1]) if match else 0.0
    except ValueError:
        value = 0.0
    if match is None or match[2] not in UNITS or not 0.0 < value < math.inf:
        raise typer.BadParameter(f"{stated!r} is no length with its unit, such as 0.01mm", param_hint=hint)
    return value * metres_per(match[2])


def option(flags: str, metavar: str | None, help: str, **settings: Any) -> Any:
    """An option by its names, with blanks between, and a word for its value; its help says what holds without it."""
    return typer.Option(*flags.split(), metavar=metavar, show_default=False, help=help, **settings)


def argument(metavar: str, help: str, **settings: Any) -> Any:
    """An argument; its help says in words what holds without it."""
    return typer.Argument(metavar=metavar, show_default=False, help=help, **settings)


class GeometryKind(StrEnum):
    """The two geometries of a link."""

    visual = "visual"
    collision = "collision"


class Severity(StrEnum):
    """Severities of findings, from the worst."""

    error = "error"
    warning = "warning"
    note = "note"


class FindingsFormat(StrEnum):
    """How findings are printed."""

    brief = "brief"
    full = "full"
    concise = "concise"
    json = "json"
    sarif = "sarif"
    junit = "junit"
    github = "github"
    md = "md"


@dataclass(frozen=True)
class Printed:
    """Where findings go: in one format to stdout, in others to files."""

    format: FindingsFormat
    files: tuple[tuple[FindingsFormat, Path], ...] = ()


def printed(
    stated: list[str] | None, verbose: bool = False, otherwise: FindingsFormat = FindingsFormat.brief
) -> Printed:
    """What `--format` and `--verbose` ask for; `otherwise` is the format of stdout where they do not say. A usage
    error where a format is none, or two go to one place."""
    shown: list[FindingsFormat] = [FindingsFormat.full] if verbose else []
    written: dict[Path, FindingsFormat] = {}
    for text in stated or ():
        name, equals, file = text.partition("=")
        if name not in set(FindingsFormat):
            from kinform.foundation.name_hints import did_you_mean

            remedy = did_you_mean(name, FindingsFormat, "the formats")
            raise typer.BadParameter(f"{name!r} is no format: {remedy}", param_hint="--format")
        if equals and not file:
            raise typer.BadParameter(f"{text!r} names no file after the =", param_hint="--format")
        if not equals:
            shown.append(FindingsFormat(name))
        elif Path(file) in written:
            raise typer.BadParameter(f"two formats go to {file}", param_hint="--format")
        else:
            written[Path(file)] = FindingsFormat(name)
    if len(set(shown)) > 1:
        raise typer.BadParameter(
            f"{' and '.join(dict.fromkeys(shown))} both go to stdout: give one of them a file, as in {shown[-1]}=FILE",
            param_hint="--format",
        )
    return Printed(shown[0] if shown else otherwise, tuple((format, path) for path, format in written.items()))


class TableFormat(StrEnum):
    """How results are printed."""

    table = "table"
    json = "json"


def _formats(incomplete: str) -> list[str]:
    """What a shell may complete `--format` to."""
    return [format.value for format in FindingsFormat if format.value.startswith(incomplete)]


def _set_quiet(value: bool) -> None:
    console.settings.quiet = console.settings.quiet or value


def _set_debug(value: bool) -> None:
    console.settings.debug = console.settings.debug or value


Quiet = Annotated[
    bool,
    typer.Option(
        "--quiet", "-q", callback=_set_quiet, help="No progress, summaries or warnings on stderr; errors stay."
    ),
]
Debug = Annotated[
    bool, typer.Option("--debug", callback=_set_debug, help="Show the traceback of an error (also: KINFORM_DEBUG=1).")
]
Jobs = Annotated[int | None, option("--jobs -j", "N", "Use up to N cores; default: all of them.", min=1)]
Ranges = Annotated[
    bool | None,
    option(
        "--ranges/--no-ranges",
        None,
        "Find how far each joint goes until parts meet; default: yes, unless very many joints or facets make it long.",
    ),
]
Sources = Annotated[
    list[Path],
    argument(
        "SOURCE",
        "A manifest, a robot description (URDF, xacro, SDF, MJCF), or a CAD or scene file (STEP, GLB, glTF, 3MF, "
        "DAE); or STL, OBJ, PLY and OFF files, with --units.",
    ),
]
Results = Annotated[Path, argument("F.h5", "Results file to read.")]
LookedAt = Annotated[
    Path,
    argument("F.h5", "Results file; of a manifest, robot description or scene all is computed, and not kept."),
]
Output = Annotated[Path, option("--output -o", "F.h5", "Results file to write; may be the one that is read.")]
Strict = Annotated[
    bool,
    typer.Option(
        "--strict",
        help="Exit with 2 also where joints are undecided or ambiguous, bodies are fused by contact at rest alone, "
        "meshes may be several parts, or your kinform did not write the results.",
    ),
]
TrustResults = Annotated[
    bool,
    typer.Option(
        "--trust-results",
        help="Reuse earlier results whoever wrote them: only where strangers cannot write them.",
    ),
]
AllowOutside = Annotated[bool, typer.Option("--allow-outside", help="Accept files outside the design's folder.")]
AllowXacro = Annotated[
    bool,
    typer.Option(
        "--allow-xacro",
        help="Expand xacro files with xacro itself. This runs code: their expressions can do whatever you can.",
    ),
]
Geometry = Annotated[
    GeometryKind, typer.Option("--geometry", help="Which geometry of a robot description its parts are.")
]
Packages = Annotated[
    list[str] | None,
    option("--package", "NAME=FOLDER", "Where package://NAME of a robot description is; may be given for each."),
]
Deviation = Annotated[
    str | None,
    option(
        "--deviation", "LENGTH", "How far facets of a STEP file may lie from its surfaces, as in 0.01mm; a share else."
    ),
]
Units = Annotated[
    str | None, option("--units", "UNIT", "Unit of the meshes named in place of a manifest: m, cm, mm, um, in or ft.")
]
Depfile = Annotated[
    Path | None, option("--depfile", "FILE", "Also write a Make rule: the output depends on every file that was read.")
]
ManifestFolder = Annotated[
    Path | None,
    option("--manifest-folder", "DIR", "Folder of the manifest: sarif and github then name files as seen from here."),
]
Tolerances = Annotated[
    list[str] | None,
    option(
        "--tolerance",
        "VALUE",
        "Changes up to this are none: 0.1mm, 0.2deg, 1g, 0.5% (of masses); may be given once for each.",
    ),
]
FailOn = Annotated[Severity, typer.Option("--fail-on", help="Least severity of a finding that gives exit code 1.")]
PrintedFindings = Annotated[
    list[str] | None,
    option(
        "--format -f",
        "FORMAT[=FILE]",
        "How findings are printed: brief, full, concise, json, sarif, junit, github or md; with =FILE written there. "
        "May be given for each file, and once without.",
        autocompletion=_formats,
    ),
]
Verbose = Annotated[
    bool, option("--verbose -v", None, "Print every finding in full, and what was skipped and why: --format full.")
]
PrintedTable = Annotated[TableFormat, typer.Option("--format", "-f", help="json: SI units and radians.")]
