"""What a batch has done: a row a design, kept as JSON beside the results, so that the next one knows by hashes alone
what needs nothing."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import Any, Literal

from kinform.batch.discovery import RECORD
from kinform.batch.task import FailureKind
from kinform.consistency.judgement import CODES, VerdictKind, in_strict_words
from kinform.errors import InputError, Problem
from kinform.foundation import provenance
from kinform.frozen import dataclass
from kinform.results import computed_anew, refuse_links, replace_file

SCHEMA = "kinform/batch-record/3"
KIND_OF: dict[str, VerdictKind] = {kind: kind for kind in CODES}
NAME = RECORD
"""Of the file in the folder of results."""


@dataclass(frozen=True)
class Row:
    """What is known of one design."""

    name: str
    """Relative to the folder that all paths have in common."""
    source: str
    """As messages show it."""
    results: str
    """Relative to the folder of results."""
    assembly: str = ""
    mobility: int | None = None
    """Effective."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Findings by severity."""
    ran: int = 0
    inconclusive: int = 0
    ignored: int = 0
    """Findings that the manifest accepts."""
    unselected: int = 0
    """Rules that the manifest leaves out."""
    verdicts: Mapping[str, tuple[VerdictKind, str]] = field(default_factory=dict)
    """By the least severity that fails: the verdict's kind and line."""
    coverage: str = ""
    """Of the verdict."""
    open: tuple[str, ...] = ()
    """Of the verdict."""
    seconds: float = 0.0
    tries: int = 1
    failure: FailureKind | Literal[""] = ""
    """Why there are no results; "" where there are."""
    problems: tuple[Problem, ...] = ()
    notes: tuple[str, ...] = ()
    """What its run said besides."""
    lineage: str = ""
    """What the results were made of, as one hash; "" where that is not known."""
    files: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of every file that was read, relative to the design's folder."""
    digest: str = ""
    """SHA-256 of the results file."""
    recorded: bool = True
    """Whether this user's kinform computed the results, or had recorded what was reused."""
    unchanged: bool = False
    """Whether nothing had to be done."""
    strict: bool = False
    """As of CheckReport."""

    def kind(self, fail_on: str = "error") -> VerdictKind:
        """The kind of the verdict that `kinform run` would have."""
        if self.failure:
            return "not verified"
        kind = self.verdicts[fail_on][0]
        return "not verified" if self.strict and self.open and CODES[kind] == 0 else kind

    def code(self, fail_on: str = "error") -> int:
        """The exit code that `kinform run` would have."""
        return CODES[self.kind(fail_on)]

    def verdict(self, fail_on: str = "error") -> str:
        """The verdict in one line."""
        if self.failure:
            return f"not verified: {self.failure}"
        kind, line = self.verdicts[fail_on]
        return line if self.kind(fail_on) == kind else in_strict_words(self.open)


@dataclass
class Record:
    """Rows by name of the design."""

    rows: dict[str, Row] = field(default_factory=dict)
    note: str = ""
    """Why it has no rows, where it stands there and is not used."""


def read(folder: Path, *, trust: bool = False) -> Record:
    """The record of a folder of results; an empty one where there is none, or it makes no sense: then all is looked at.
    A record that this user's kinform did not write is not used, unless `trust`; nor are rows of results of unknown
    origin in one that it wrote.

    Raises InputError where another kind of file stands in its place.
    """
    path = folder / NAME
    refuse_links(path, (), folder)
    if not path.exists():
        return Record()
    other = Problem("is not the record of a batch, and would be overwritten", str(path), None, "name another folder")
    try:
        data = path.read_bytes()
        whole = json.loads(data)
    except (OSError, ValueError):
        raise InputError([other]) from None
    if not isinstance(whole, dict) or not str(whole.get("schema", "")).startswith("kinform/batch-record/"):
        raise InputError([other])
    if whole["schema"] != SCHEMA:
        return Record()
    recorded = provenance.is_recorded(hashlib.sha256(data).hexdigest(), path)
    if not (recorded or trust):
        return Record(note=f"{path}: {computed_anew(path)}")
    try:
        rows = [_row(values) for values in whole["designs"]]
    except (TypeError, KeyError, ValueError, AttributeError):
        return Record()
    kept = (replace(row, recorded=row.recorded and recorded) for row in rows)
    return Record({row.name: row for row in kept if row.recorded or trust})


def write(record: Record, folder: Path) -> None:
    """Keep the record, in one step."""
    rows = []
    for name in sorted(record.rows):
        values = dataclasses.asdict(record.rows[name])
        del values["unchanged"], values["strict"]
        if values["recorded"]:
            del values["recorded"]
        rows.append(values)
    text = json.dumps({"schema": SCHEMA, "designs": rows}, indent=1, ensure_ascii=True) + "\n"
    data = text.encode()
    provenance.record(hashlib.sha256(data).hexdigest())
    replace_file(folder / NAME, data, below=folder)


def _row(values: Mapping[str, Any]) -> Row:
    names = {f.name: str(f.type) for f in dataclasses.fields(Row)}
    kinds: dict[str, tuple[type, ...]] = {
        "str": (str,), "int": (int,), "int | None": (int, type(None)), "float": (int, float), "bool": (bool,),
    }  # fmt: skip
    for name, kind in names.items():
        if kind in kinds and name in values and not isinstance(values[name], kinds[kind]):
            raise TypeError(name)
    known = {key: value for key, value in values.items() if key in names}
    problems = tuple(Problem(**problem) for problem in known.pop("problems", ()))
    notes = tuple(map(str, known.pop("notes", ())))
    counts = {str(key): int(value) for key, value in known.pop("counts", {}).items()}
    files = {str(key): str(value) for key, value in known.pop("files", {}).items()}
    left_open = tuple(map(str, known.pop("open", ())))
    verdicts = {str(key): (KIND_OF[kind], str(line)) for key, (kind, line) in known.pop("verdicts", {}).items()}
    return Row(**known, problems=problems, notes=notes, counts=counts, files=files, verdicts=verdicts, open=left_open)
