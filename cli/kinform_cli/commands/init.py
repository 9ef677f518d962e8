"""`kinform init`: a manifest to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import Debug, Quiet, examples
from kinform_cli.text import count

__all__ = ["EXAMPLES", "init"]

EXAMPLES = examples(
    "kinform init parts/*.stl --units mm -o arm.toml",
    "kinform init scene.obj --units m            # print it",
)


def init(
    meshes: Annotated[
        list[Path],
        typer.Argument(metavar="MESH...", show_default=False, help="STL and OBJ files of the parts."),
    ],
    units: Annotated[
        str,
        typer.Option(
            "--units", metavar="UNIT", show_default=False, help="Unit of the meshes: m, cm, mm, um, in or ft."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="M.toml",
            show_default=False,
            help="Manifest to write; else it is printed.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a manifest that exists.")] = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Write a manifest for these meshes, ready to be completed."""
    if output is not None:
        if output.exists() and not force:
            raise refuse("exists already", file=output, remedy="add --force to overwrite it")
        files.check_text_output(output, inputs=meshes)
    from kinform import form

    folder = Path(".") if output is None else output.parent
    text = form.init_manifest(meshes, units=units, relative_to=folder)
    if output is None:
        console.emit(text)
        return
    files.write_text(output, text)
    console.say(f"{output}: {count(text.count('[[part]]'), 'part')}; complete it, then kinform run {output}")
