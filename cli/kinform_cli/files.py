"""Files that the command reads and writes: checked before the work starts, not after.

The library replaces a results file in one step, so it is either the old one or the new one. What is
checked here is what would make that last step fail, or destroy a file that kinform did not write.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kinform_cli.errors import refuse

if TYPE_CHECKING:
    from kinform.design import Design

__all__ = [
    "MESHES",
    "check_output",
    "check_text_output",
    "make_rule",
    "needing",
    "read",
    "read_by",
    "write_bytes",
    "write_text",
]

MESHES = (".stl", ".obj")


def check_output(path: Path, *, inputs: Iterable[Path] = ()) -> None:
    """Raise an error if a results file could not be written to `path`, or if that is one of the inputs."""
    _spare(path, inputs)
    from kinform import results

    results.check_output(path)
    _try_writing(path)


def check_text_output(path: Path, *, inputs: Iterable[Path] = ()) -> None:
    """As check_output, for a text file."""
    _spare(path, inputs)
    if path.is_dir():
        raise refuse("this is a folder, not a file", file=path, remedy="name a file in it")
    if not path.parent.is_dir():
        raise refuse(f"the folder {path.parent} does not exist", file=path, remedy=f"create it: mkdir -p {path.parent}")
    _try_writing(path)


def _spare(path: Path, inputs: Iterable[Path]) -> None:
    for source in inputs:
        if source == path or (path.exists() and source.exists() and path.samefile(source)):
            raise refuse("is an input and would be overwritten", file=path, remedy="name another output")


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


def read(path: Path) -> Design:
    """The design in a results file; raises ResultsError, or InputError for another kind of file."""
    if path.suffix.lower() in (".toml", *MESHES):
        raise refuse(
            "this command reads a results file",
            file=path,
            remedy=f"first `kinform import {path} -o F.h5`, then name F.h5",
        )
    from kinform import results

    return results.read(path)


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
            remedy=f"kinform {error.needs} {path} -o {path}",
        ) from None


def write_text(path: Path, text: str) -> None:
    """Write a text file in one step, as UTF-8; the same text keeps the file, with a new time."""
    write_bytes(path, text.encode())


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file in one step; the same bytes keep the file, with a new time."""
    from kinform import results

    results.replace_file(path, data)


def read_by(design: Design, sources: Sequence[Path]) -> list[Path]:
    """Every file that an import of these sources read, as seen from here."""
    if sources[0].suffix.lower() in MESHES:
        return sorted(sources)
    return [sources[0].parent / name for name in design.assembly.files]


def make_rule(target: Path, sources: Iterable[Path]) -> str:
    """A Make rule "target: sources", and an empty rule a source, so that a deleted one stops nothing."""
    names = [str(source) for source in sources]
    lines = [" \\\n  ".join([_escaped(str(target), target=True) + ":", *map(_escaped, names)])]
    lines += [_escaped(name, target=True) + ":" for name in names]
    return "\n".join(lines) + "\n"


def _escaped(name: str, *, target: bool = False) -> str:
    """The name as Make reads it: blanks, hashes and dollars escaped; in targets also % and :."""
    name = name.replace("$", "$$")
    for character in " #" + ("%:" if target else ""):
        name = name.replace(character, "\\" + character)
    return name
