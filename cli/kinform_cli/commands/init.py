"""`kinform init`: a manifest to start from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import (
    AllowXacro,
    Geometry,
    GeometryKind,
    Packages,
    Units,
    argument,
    cores,
    examples,
    option,
    reading,
)
from kinform_cli.progress import Working
from kinform_cli.text import command

if TYPE_CHECKING:
    from kinform.design import Design
    from kinform.model.assembly import Assembly
    from kinform.model.function import IntendedJoint
    from kinform.model.names import PartName


EXAMPLES = examples(
    "kinform init parts/*.stl --units mm -o arm.toml",
    "kinform init robot.urdf -o robot.toml",
    "kinform init scene.obj --units m            # print it",
)


SCHEMA = "kinform.schema.json"
"""The file beside a manifest that its first line names."""


def init(
    meshes: Annotated[
        list[Path], argument("SOURCE", "A robot description, STEP or GLB; or STL and OBJ files, with --units.")
    ],
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
    allow_xacro: AllowXacro = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite a manifest that exists.")] = False,
) -> None:
    """Write a manifest: for meshes and CAD files, ready to be completed; of a robot description, all that it says."""
    meshes = files.sources_of(meshes)
    described = files.is_description(meshes, units)
    if output is not None:
        if output.exists() and not force:
            raise refuse("exists already", file=output, remedy="add --force to overwrite it")
        files.check_text_output(output, inputs=meshes)
    from kinform import form

    folder = Path(".") if output is None else output.parent
    with Working("import") as working:
        hints = _Hints(working, suggest)
        if described:
            from kinform.form.write_manifest import init_from_source

            text = init_from_source(
                meshes[0],
                relative_to=folder,
                reading=reading(geometry, packages, allow_xacro=allow_xacro),
                fastened=hints.groups,
                jointed=hints.joints,
            )
        else:
            assert units is not None
            name = None if len(meshes) == 1 else meshes[0].resolve().parent.name if output is None else output.stem
            text = form.init_manifest(
                meshes,
                units=units,
                name=name,
                relative_to=folder,
                fastened=hints.groups,
                jointed=hints.joints,
            )
    for doubt in hints.doubts:
        console.warn(doubt)
    if hints.doubts and suggest:
        console.warn("no groups and no joints are looked for or proposed while the unit is doubtful")
    _write(text, output)
    if output is not None and hints.doubts:
        console.say("for another unit: the same command with that --units, and --force")


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
    """As in ", 2 groups and 1 joint proposed as comments"; what stands without evidence is an example."""
    proposed = {"group": 0, "joint": 0}
    lines = text.splitlines()
    for before, line in zip(lines, lines[1:], strict=False):
        for kind, head in (("group", "# [[group]]"), ("joint", "# [[function.joint]]")):
            proposed[kind] += line == head and before.startswith("## ")
    found = [counted(many, kind) for kind, many in proposed.items() if many]
    return f", {' and '.join(found)} proposed as comments" if found else ""


class _Hints:
    """What the contacts of an assembly suggest, where that is wanted; nothing where the unit is doubtful: whoever took
    millimetres for metres is to correct that first."""

    def __init__(self, working: Working, wanted: bool) -> None:
        self.design: Design | None = None
        self.doubts: list[str] = []
        self._working = working
        self._wanted = wanted

    def groups(self, assembly: Assembly) -> list[tuple[list[PartName], str]]:
        """Parts that are probably one body."""
        from kinform.form.without_manifest import doubts

        self.doubts = doubts(assembly)
        if self.doubts or not self._wanted:
            return []
        from kinform import stages
        from kinform.contacts.fastening import fastened
        from kinform.design import Design

        self._working.stage("contacts")
        self.design = stages.contacts(Design(assembly), jobs=cores(None), progress=self._working)
        contacts = self.design.contacts
        return [] if contacts is None else fastened(contacts.suggestions)

    def joints(self, assembly: Assembly) -> list[tuple[IntendedJoint, str]]:
        """Joints that may be meant."""
        if self.design is None or self.design.contacts is None:
            return []
        from kinform.kinematics import proposed_joints

        self._working.step("joints that may be meant", 0, 0)
        return proposed_joints(assembly, self.design.surfaces, self.design.contacts)
