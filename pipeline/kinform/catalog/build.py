"""Fills the catalog from results files, and does so again from what was added before."""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from kinform import results
from kinform.catalog.entry import Entry, entry_of
from kinform.catalog.store import Catalog
from kinform.errors import InputError, Problem, ResultsError, StageError
from kinform.foundation.boundary import leads_out
from kinform.frozen import dataclass

_ENDINGS = (".h5", ".hdf5")


@dataclass(frozen=True)
class Refused:
    """A file below a folder that is no design, and why it was left out."""

    path: str
    reason: str


def add(catalog: Catalog, sources: Sequence[str | Path], folder: str | Path) -> tuple[Catalog, tuple[Refused, ...]]:
    """The catalog with the designs of these sources: folders, whatever is below them, or results files.

    A design that it had is read again. `folder` is that of the catalog: what is kept are paths relative to
    it. Files below a folder that are no results of kinform, or of which joints are not known, are left out
    and listed. Raises InputError for a source that is not there, a folder without any design, and a file that
    was named and is no design.
    """
    problems: list[Problem] = []
    refused: list[Refused] = []
    entries: dict[str, Entry] = {}
    kept = set(catalog.sources)
    for source in sorted({Path(source) for source in sources}):
        if source.is_dir():
            designs, left_out = _designs_of(source, folder)
            refused += left_out
            if not designs:
                problems.append(_empty(source, left_out))
            entries |= {entry.path: entry for entry in designs}
        else:
            try:
                entry = _entry(source, folder)
            except _NOT_A_DESIGN as error:
                problems.append(_problem(error, source))
                continue
            entries[entry.path] = entry
        kept.add(_relative(source, folder))
    if problems:
        raise InputError(problems)
    earlier = {entry.path: entry for entry in catalog.entries}
    return Catalog(tuple(sorted(kept)), _sorted((earlier | entries).values())), tuple(refused)


def fill(
    catalog: Catalog, designs: Mapping[Path, str], source: str | Path, folder: str | Path, *, reuse: bool = True
) -> tuple[Catalog, tuple[Refused, ...]]:
    """The catalog with these results files below the folder `source`, each with its SHA-256 (hex): with `reuse` one
    that the catalog has with the same bytes is not read. `folder` is that of the catalog. What cannot be read is left
    out and listed."""
    entries = {entry.path: entry for entry in catalog.entries}
    refused = []
    for path, digest in sorted(designs.items()):
        name = _relative(path, folder)
        if reuse and name in entries and entries[name].digest == digest:
            continue
        try:
            entries[name] = _entry(path, folder)
        except _NOT_A_DESIGN as error:
            refused.append(Refused(name, _problem(error, path).message))
    sources = {*catalog.sources, _relative(Path(source), folder)}
    return Catalog(tuple(sorted(sources)), _sorted(entries.values())), tuple(refused)


def rebuild(catalog: Catalog, folder: str | Path) -> tuple[Catalog, tuple[Refused, ...]]:
    """The catalog from nothing but its sources; those that are gone, or hold no design now, are listed."""
    entries: dict[str, Entry] = {}
    refused: list[Refused] = []
    for name in catalog.sources:
        designs, left_out = _designs_of(Path(folder) / name, folder)
        refused += left_out
        entries |= {entry.path: entry for entry in designs}
    return Catalog(catalog.sources, _sorted(entries.values())), tuple(refused)


def digest_of(path: Path) -> str:
    """SHA-256 of a file, hex."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


_NOT_A_DESIGN = (ResultsError, StageError)


def _designs_of(source: Path, home: str | Path) -> tuple[list[Entry], list[Refused]]:
    """The designs below a folder, or in a results file, and what is none."""
    entries, refused = [], []
    paths = source.rglob("*") if source.is_dir() else ()
    files = [p for p in paths if p.suffix.lower() in _ENDINGS and not leads_out(p) and p.is_file()]
    for path in sorted(files) if source.is_dir() else [source]:
        try:
            entries.append(_entry(path, home))
        except _NOT_A_DESIGN as error:
            refused.append(Refused(_relative(path, home), _problem(error, path).message))
    return entries, refused


def _entry(path: Path, folder: str | Path) -> Entry:
    design = results.read(path)
    return entry_of(design, _relative(path, folder), digest_of(path))


def _relative(path: Path, folder: str | Path) -> str:
    return Path(os.path.relpath(os.path.realpath(path), os.path.realpath(folder))).as_posix()


def _sorted(entries: Iterable[Entry]) -> tuple[Entry, ...]:
    return tuple(sorted(entries, key=lambda entry: entry.path))


def _problem(error: Exception, path: Path) -> Problem:
    if isinstance(error, ResultsError):
        return error.problem
    remedy = shlex.join(["kinform", "joints", str(path), "-o", str(path)])
    return Problem("its joints are not known: the catalog lists what designs do", str(path), None, remedy)


def _empty(folder: Path, left_out: list[Refused]) -> Problem:
    why = "; ".join(f"{item.path}: {item.reason}" for item in left_out[:3])
    return Problem(
        f"no results file of a design is below this folder{': ' + why if why else ''}",
        str(folder),
        None,
        "make results there first: kinform run SOURCE -o F.h5, or of all designs: kinform batch FOLDER -o RESULTS; a "
        "manifest or description that is named itself is run",
    )
