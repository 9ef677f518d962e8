"""Files that the commands read and write: checked before the work starts, not after.

The library replaces a results file in one step, so it is either the old one or the new one. What is
checked here is what would make that last step fail, or destroy a file that kinform did not write.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kinform.foundation.escapes import make_name
from kinform.foundation.regular_files import no_folder, not_a_file
from kinform_cli import console
from kinform_cli.errors import refuse
from kinform_cli.progress import Working
from kinform_cli.text import command

if TYPE_CHECKING:
    from kinform.design import Design


MESHES = (".stl", ".obj", ".ply", ".off")
DESCRIPTIONS = (".urdf", ".xacro", ".xml", ".mjcf", ".sdf", ".world")
SCENES = (".glb", ".gltf", ".step", ".stp", ".3mf", ".dae")
"""Files of several parts that state their own unit of length."""


FOREIGN = frozenset(
    {
        *(".h5", ".hdf5", ".html", ".htm", ".pdf", ".png", ".svg", ".jpg", ".jpeg", ".docx", ".md", ".txt", ".csv"),
        *(".json", ".sarif", ".toml", ".yaml", ".yml", *MESHES, *DESCRIPTIONS, *SCENES),
    }
)
"""Ends of names that say what a file is: where another kind of file would be written they are a mistake."""


def check_page(path: Path, *, inputs: Iterable[Path] = ()) -> None:
    """As check_text_output, for a page; an error where its name says that it is something else."""
    if path.suffix.lower() in FOREIGN - {".html", ".htm"}:
        raise refuse(
            f"the page is HTML, and not what {path.suffix} says",
            file=path,
            remedy=f"name it {path.with_suffix('.html')}; a browser prints it as PDF, and --png DIR writes pictures",
        )
    check_text_output(path, inputs=inputs)


def check_output(path: Path, *, inputs: Iterable[Path] = ()) -> None:
    """Raise an error if a results file could not be written to `path`, or if that is one of the inputs."""
    _spare_inputs(path, inputs)
    if path.suffix.lower() in FOREIGN - {".h5", ".hdf5"}:
        raise refuse(
            f"a results file is HDF5, and not what {path.suffix} says",
            file=path,
            remedy=f"name it {path.with_suffix('.h5')}; pages are made of it by `kinform report`",
        )
    from kinform import results

    results.check_output(path)
    _try_writing(path)


def warn_if_not_whole(path: Path) -> None:
    """Say that a results file that is about to be written again is no longer whole: so nobody relied on it in vain."""
    from kinform import results

    fault = results.fault_of(path)
    if fault is not None:
        console.warn(results.as_absent(fault))


def check_text_output(path: Path, *, inputs: Iterable[Path] = ()) -> None:
    """As check_output, for a text file."""
    _spare_inputs(path, inputs)
    if path.is_dir():
        raise refuse("this is a folder, not a file", file=path, remedy="name a file in it")
    fault = not_a_file(path)
    if fault is not None:
        raise refuse(fault, file=path, remedy="name a file")
    if not path.parent.is_dir():
        fault, remedy = no_folder(path.parent)
        raise refuse(fault, file=path, remedy=remedy)
    _try_writing(path)


def check_outputs(sources: Sequence[Path], output: Path | None, depfile: Path | None) -> None:
    """As check_output, for a results file and its Make rule, which come from these sources."""
    if output is not None:
        check_output(output, inputs=sources)
    if depfile is not None:
        if output is None:
            raise refuse("--depfile names what the output depends on", file=depfile, remedy="add -o F.h5")
        make_rule(output, [])
        check_text_output(depfile, inputs=[*sources, output])


def check_findings(written: Iterable[tuple[object, Path]], others: Iterable[Path]) -> None:
    """As check_text_output, for files that findings are written to, beside the other files of the command."""
    for _, path in written:
        check_text_output(path, inputs=others)


def _spare_inputs(path: Path, inputs: Iterable[Path]) -> None:
    """Raise an error if the output is one of the inputs, or a link in one of their folders leads it elsewhere."""
    inputs = list(inputs)
    _refuse_links(path, inputs)
    for source in inputs:
        if source == path or (path.exists() and source.exists() and path.samefile(source)):
            raise refuse("is an input and would be overwritten", file=path, remedy="name another output")


def check_folder(path: Path, *, inputs: Iterable[Path]) -> None:
    """Raise an error if the folder for outputs is reached by a link out of the folder of an input."""
    _refuse_links(path, inputs, folder=True)


def _refuse_links(path: Path, inputs: Iterable[Path], *, folder: bool = False) -> None:
    from kinform.foundation.boundary import design_folder
    from kinform.results import refuse_links

    inside = [design_folder(source / "any" if source.is_dir() else source) for source in inputs]
    refuse_links(path, inside, folder=folder)


def _try_writing(path: Path) -> None:
    """Permission bits do not tell everything: put a file into the folder, and take it away again."""
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise refuse(
            f"nothing can be written in the folder {path.parent}: {error.strerror}",
            file=path,
            remedy="name a file in a writable folder",
        ) from None


def read(path: Path, *, at_need: bool = False) -> Design:
    """The design in a results file; raises ResultsError, or InputError for another kind of file.

    With `at_need` each part of it is read when it is first looked at: for what is only shown.
    """
    if path.suffix.lower() in (".toml", *MESHES, *DESCRIPTIONS, *SCENES):
        raise refuse(
            "this command reads a results file",
            file=path,
            remedy=f"first `{command('kinform', 'import', path)} -o F.h5`, then name F.h5",
        )
    from kinform import results

    return results.read_at_need(path) if at_need else results.read(path)


def warn_of_origin(design: Design, path: Path) -> None:
    """Say that a results file that the command relies on is not one that this user's kinform wrote."""
    if not design.recorded:
        from kinform import results

        console.warn(f"{path}: {results.unknown_origin(path)}")


@contextlib.contextmanager
def needing(path: Path) -> Iterator[None]:
    """Name the file and the command to run next when a stage misses what it needs."""
    from kinform.errors import StageError

    try:
        yield
    except StageError as error:
        raise refuse(
            f"has no results of `kinform {error.needs}`, which {error.stage} needs",
            file=path,
            remedy=command("kinform", error.needs, path, "-o", path),
        ) from None


def advance(source: Path, output: Path, label: str, stage: Callable[[Design, Working], Design]) -> Design:
    """Take the design in a results file through one stage, and write what that gives to another, or to the same."""
    check_folder(output.parent, inputs=[source])
    check_output(output)
    from kinform import results

    design = read(source)
    if not (output.exists() and output.samefile(source)):
        warn_if_not_whole(output)
    with needing(source), Working(label) as working:
        design = stage(design, working)
    results.write(design, output)
    return design


def write_text(path: Path, text: str) -> None:
    """Write a text file in one step, as UTF-8; the same text keeps the file, with a new time."""
    write_bytes(path, text.encode("utf-8", "backslashreplace"))  # names of files may be bytes that are no UTF-8


def write_bytes(path: Path, data: bytes, below: Path | None = None) -> None:
    """Write a file in one step, which stays `below` a folder; the same bytes keep the file, with a new time."""
    from kinform import results

    results.replace_file(path, data, below=below)


def write_rule(depfile: Path, output: Path, design: Design, sources: Sequence[Path]) -> None:
    """Write a Make rule by which the output depends on every file that an import of these sources read."""
    meshes = sources[0].suffix.lower() in MESHES
    read_files = sorted(sources) if meshes else [sources[0].parent / name for name in design.assembly.files]
    write_text(depfile, make_rule(output, read_files))


def make_rule(target: Path, sources: Iterable[Path]) -> str:
    """A Make rule "target: sources", and an empty rule a source, so that a deleted one stops nothing.

    Where Make cannot take the name of a source, the target is always made anew. InputError where it cannot take that of
    the target.
    """
    made = make_name(target.as_posix(), target=True)
    if made is None:
        raise refuse(
            "Make cannot take this name", file=target, remedy="name the output with letters, digits, . - and _"
        )
    names = [source.as_posix() for source in sources]
    taken = [name for name in map(make_name, names) if name is not None]
    always = [] if len(taken) == len(names) else [ALWAYS]
    lines = [" \\\n  ".join([f"{made}:", *taken, *always])]
    lines += [f"{make_name(name, target=True)}:" for name in names if make_name(name) is not None]
    lines += [f".PHONY: {name}" for name in always]
    return "\n".join(lines) + "\n"


ALWAYS = "kinform-reads-names-that-make-cannot-take"
"""A phony target: what depends on it is always made anew."""


def sources_of(named: Sequence[Path]) -> list[Path]:
    """What is named; of a folder the manifest in it, else the robot description, else the CAD or scene file, else all
    meshes. InputError where there is none of them, or several of the first kind that there is."""
    if len(named) != 1 or not named[0].is_dir():
        return list(named)
    from kinform.foundation.boundary import leads_out
    from kinform.foundation.name_hints import first_names

    inside = sorted(path for path in named[0].iterdir() if not leads_out(path) and os.path.isfile(path))
    for kind, ends in (("manifest", (".toml",)), ("robot description", DESCRIPTIONS), ("CAD or scene file", SCENES)):
        found = [path for path in inside if path.suffix.lower() in ends]
        found = [path for path in found if _is_of_this_kind(path)]
        if len(found) == 1:
            return found
        if found:
            raise refuse(
                f"there are several {kind}s in this folder: {first_names(path.name for path in found)}",
                file=named[0],
                remedy=f"name one of them, as in: {command('kinform', 'run', found[0])}",
            )
    if meshes := [path for path in inside if path.suffix.lower() in MESHES]:
        return meshes
    raise refuse(
        "there is no manifest in this folder, and no robot description, CAD file or mesh",
        file=named[0],
        remedy="write one: kinform init PARTS/*.stl --units mm -o NAME.toml",
    )


def _is_of_this_kind(path: Path) -> bool:
    """Whether a TOML file is a manifest, or an XML file a description. A TOML file with faults may be a manifest. Other
    files are not read."""
    from kinform.form.recognition import is_design

    if path.suffix.lower() == ".xml":
        return is_design(path)
    return path.suffix.lower() != ".toml" or is_design(path) or not (path.name == "pyproject.toml" or _is_toml(path))


def _is_toml(path: Path) -> bool:
    from kinform.form.constants import MANIFEST_BYTES
    from kinform.form.readers.toml_text import TomlError, read_toml
    from kinform.foundation.texts import TextError, read_text

    try:
        read_toml(read_text(path, MANIFEST_BYTES, "a manifest"))
    except (TextError, TomlError):
        return False
    return True


def is_description(sources: Sequence[Path], units: str | None) -> bool:
    """Whether the sources are one robot description or scene (else meshes); InputError where they are a mixture."""
    manifest = is_manifest(sources, units)
    if sources[0].suffix.lower() == ".toml":
        raise refuse("is a manifest already", file=sources[0], remedy="name meshes, a robot description or a scene")
    return manifest


def is_manifest(sources: Sequence[Path], units: str | None) -> bool:
    """Whether the sources are a manifest (else meshes); InputError where they are a mixture."""
    kinds = {source.suffix.lower() for source in sources}
    if kinds <= set(MESHES):
        if units is None:
            raise refuse(
                "the unit of these meshes is not stated",
                file=sources[0],
                remedy="add --units mm (or m, cm, um, in, ft)",
            )
        return False
    if ".h5" in kinds or ".hdf5" in kinds:
        raise refuse(
            "is a results file; this command starts from a manifest or from meshes",
            file=next(source for source in sources if source.suffix.lower() in (".h5", ".hdf5")),
            remedy="look into it with `kinform show`, or verify it with `kinform check`",
        )
    from kinform.form.sources import unread

    for source in sources:
        foreign = unread(source)
        if foreign is not None:
            raise refuse(foreign[0], file=source, remedy=foreign[1])
    if len(sources) > 1:
        raise refuse(
            "several inputs that are not all meshes",
            file=next(source for source in sources if source.suffix.lower() not in MESHES),
            remedy="name one manifest (.toml), robot description (.urdf, .sdf, .xml) or scene (.step, .glb, .gltf), "
            "or only meshes (.stl, .obj, .ply, .off)",
        )
    if units is not None:
        raise refuse(
            "--units is for meshes in place of a manifest",
            file=sources[0],
            remedy="leave --units out: "
            + (
                "descriptions are in metres"
                if sources[0].suffix.lower() in DESCRIPTIONS
                else "this format states its own unit"
                if sources[0].suffix.lower() in SCENES
                else "the manifest states its own `units`"
            ),
        )
    return True
