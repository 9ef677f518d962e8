"""`kinform init`: a manifest to start from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import Geometry, GeometryKind, Packages, Units, argument, cores, examples, option, reading
from kinform_cli.progress import Working
from kinform_cli.text import command

if TYPE_CHECKING:
    from kinform.model.assembly import Assembly
    from kinform.model.names import PartName


EXAMPLES = examples(
    "kinform init parts/*.stl --units mm -o arm.toml",
    "kinform init robot.urdf -o robot.toml",
    "kinform init scene.obj --units m            # print it",
)


SCHEMA = "kinform.schema.json"
"""The file beside a manifest that its first line names."""


def init(
    meshes: Annotated[list[Path], argument("SOURCE", "A robot description; or STL and OBJ files, with --units.")],
    units: Units = None,
    output: Annotated[Path | None, option("--output -o", "M.toml", "Manifest to write; else it is printed.")] = None,
    suggest: Annotated[
        bool,
        typer.Option(
            "--suggest/--no-suggest", help="Look for parts that are probably one body, and propose groups as comments."
        ),
    ] = True,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a manifest that exists.")] = False,
) -> None:
    """Write a manifest: for meshes, ready to be completed; of a robot description, all that it says."""
    described = files.is_description(meshes, units)
    if output is not None:
        if output.exists() and not force:
            raise refuse("exists already", file=output, remedy="add --force to overwrite it")
        files.check_text_output(output, inputs=meshes)
    from kinform import form

    folder = Path(".") if output is None else output.parent
    if described:
        from kinform.form.write_manifest import init_from_source

        text = init_from_source(meshes[0], relative_to=folder, reading=reading(geometry, packages))
        _write(text, output)
        return
    assert units is not None
    name = None if len(meshes) == 1 else meshes[0].resolve().parent.name if output is None else output.stem
    text = form.init_manifest(
        meshes, units=units, name=name, relative_to=folder, fastened=_suggest_groups if suggest else _no_groups
    )
    _write(text, output)


def _write(text: str, output: Path | None) -> None:
    """Write or print the manifest, and say what comes next. Its first line tells editors where its schema is."""
    text = f"#:schema ./{SCHEMA}\n{text}"
    if output is None:
        console.emit(text)
        console.say("printed only: add -o NAME.toml to write it, then: kinform run NAME.toml -o NAME.h5")
        return
    files.write_text(output, text)
    console.say(f"{output}: {counted(text.count('[[part]]'), 'part')}{_proposals(text)}")
    results = output.with_suffix(".h5")
    schema = output.parent / SCHEMA
    if not schema.exists():
        console.say(f"for editors that know #:schema: kinform schema > {command(schema)}")
    outside = ["--allow-outside"] if 'mesh = "../' in text else []
    then = command("kinform", "run", output, "-o", results, *outside)
    console.say(f"complete it (materials, groups, [function]), then: {then}")


def _proposals(text: str) -> str:
    """As in ", 2 groups proposed as comments"; `frame` is an example and nobody's proposal."""
    many = text.count("# [[group]]") if "\n## " in text else 0
    return f", {counted(many, 'group')} proposed as comments" if many else ""


def _no_groups(assembly: Assembly) -> list[tuple[list[PartName], str]]:
    """Nothing is proposed; but a unit that is hard to believe is said at once."""
    from kinform.form.without_manifest import doubts

    for doubt in doubts(assembly):
        console.warn(doubt)
    return []


def _suggest_groups(assembly: Assembly) -> list[tuple[list[PartName], str]]:
    """Parts that their contacts suggest are one body; none where the unit is doubtful: tolerances depend on it."""
    from kinform.form.without_manifest import doubts

    if doubts(assembly):
        return _no_groups(assembly)
    from kinform import stages
    from kinform.contacts.fastening import fastened
    from kinform.design import Design

    with Working("contacts") as progress:
        contacts = stages.contacts(Design(assembly), jobs=cores(None), progress=progress).contacts
    return [] if contacts is None else fastened(contacts.suggestions)
