"""`kinform export`: the model and its motion as files of other tools."""

from __future__ import annotations

import hashlib
import os
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import alike, counted
from kinform_cli import console, files
from kinform_cli.designs import looked_at
from kinform_cli.errors import refuse
from kinform_cli.options import LookedAt, examples, option

if TYPE_CHECKING:
    from kinform.design import Design

EXAMPLES = examples(
    "kinform export arm.h5 --to urdf -o arm_urdf",
    "kinform export arm.h5 --to mjcf -o arm_mjcf --strict",
    "kinform export arm.h5 --to modelica -o arm_modelica",
    "kinform export arm.h5 --to csv -o .",
    "kinform export robot.h5 --to urdf --fix inertia -o fixed",
)


class Fix(StrEnum):
    """What can be put right in a description."""

    inertia = "inertia"


class Target(StrEnum):
    """What can be written."""

    csv = "csv"
    dot = "dot"
    glb = "glb"
    json = "json"
    mjcf = "mjcf"
    modelica = "modelica"
    sdf = "sdf"
    svg = "svg"
    urdf = "urdf"
    vhdl_ams = "vhdl-ams"


def export(
    source: LookedAt,
    to: Annotated[Target, option("--to", "FORMAT", f"Format to write: {', '.join(Target)}.")],
    output: Annotated[Path, option("--output -o", "DIR", "Folder to write into; made if missing.")],
    strict: Annotated[
        bool, typer.Option("--strict", help="Write nothing, and exit 2, if the format cannot carry all of the model.")
    ] = False,
    fix: Annotated[
        list[Fix] | None,
        option("--fix", "inertia", "Put this right in the description that was read: inertia, from the geometry."),
    ] = None,
) -> None:
    """Write the model, or its motion, in the format of another tool.

    A robot that was read from a URDF, SDF or MJCF is written back as that, with everything that was not touched. What
    the format cannot carry is named on stderr, and in the file itself.
    """
    if output.exists() and not output.is_dir():
        raise refuse("this is a file, not a folder", file=output, remedy="name a folder with -o")
    files.check_folder(output, inputs=[source])
    design = looked_at(source)
    from kinform import exports
    from kinform.errors import InputError, Problem

    with files.needing(source):
        try:
            chosen = [item.value for item in fix or ()]
            folder = source_folder(design, source, output)
            model = exports.export(design, to.value, strict=strict, fix=chosen, folder=folder)
        except exports.LostError as error:
            remedy = "without --strict it is written, and named in the file"
            problems = [
                Problem(f"{to.value} cannot carry {text}", str(source), None, remedy) for text in alike(error.lost)
            ]
            raise InputError(problems) from None
        except exports.ExportError as error:
            raise refuse(str(error), file=source) from None
    written = exports.write(model, output)
    console.say(f"{output}: {counted(len(written), 'file')} of {to.value}")
    for text in alike(model.remarks) if design.assembly.descriptions else ():
        console.say(text)
    for text in alike(model.lost):
        console.warn(f"{to.value} does not carry {text}")


def source_folder(design: Design, source: Path, output: Path) -> str | None:
    """The folder of the description that a design was read from, as seen from the output; None where it is not found
    below the output, the results file or the working folder. A file in the output is it only where it is as it was
    read: else it is what was written there before."""
    for description in design.assembly.descriptions:
        for top in (output, source.parent, Path()):
            path = top / description.file
            if description.prefix or not path.is_file():
                continue
            if path.parent.resolve() == output.resolve() and not _is_as_read(path, design, description.file):
                continue
            return Path(os.path.relpath(path.parent.resolve(), output.resolve())).as_posix()
    return None


def _is_as_read(path: Path, design: Design, name: str) -> bool:
    """Whether a file has the content that it had when the design was read from it."""
    return hashlib.sha256(path.read_bytes()).hexdigest() == design.fingerprints.files.get(name)
