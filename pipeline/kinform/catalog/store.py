"""The catalog as an SQLite file, which any program that reads SQLite can ask more of.

The file is always written whole, from nothing, in one order: the same designs give the same bytes, and a
reader never sees half of it. Infinite ends of ranges are kept as ±9e999, as SQLite writes them.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import sqlite3
from collections import Counter
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

from kinform.catalog.entry import CatalogJoint, CatalogRequirement, Entry, Triple
from kinform.errors import InputError, Problem
from kinform.foundation import provenance
from kinform.foundation.regular_files import not_a_file
from kinform.frozen import dataclass
from kinform.results import replace_file

SCHEMA = "kinform/catalog/2"

_TABLES = """
CREATE TABLE catalog (schema TEXT NOT NULL);
CREATE TABLE sources (path TEXT PRIMARY KEY) WITHOUT ROWID;
CREATE TABLE designs (
  path TEXT PRIMARY KEY, digest TEXT NOT NULL, name TEXT NOT NULL, units TEXT NOT NULL,
  bodies INTEGER NOT NULL, instantaneous INTEGER NOT NULL, finite INTEGER, effective INTEGER NOT NULL,
  idle INTEGER NOT NULL, loops INTEGER NOT NULL, mass REAL, size_x REAL, size_y REAL, size_z REAL, verdict TEXT,
  graph TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE parts (design TEXT NOT NULL REFERENCES designs, name TEXT NOT NULL, PRIMARY KEY (design, name))
  WITHOUT ROWID;
CREATE TABLE joints (
  design TEXT NOT NULL REFERENCES designs, name TEXT NOT NULL, type TEXT NOT NULL, status TEXT NOT NULL,
  freedoms INTEGER NOT NULL, axis_x REAL, axis_y REAL, axis_z REAL, point_x REAL, point_y REAL, point_z REAL,
  pitch REAL, lower REAL, upper REAL, intended TEXT, wanted_lower REAL, wanted_upper REAL,
  PRIMARY KEY (design, name)
) WITHOUT ROWID;
CREATE TABLE requirements (
  design TEXT NOT NULL REFERENCES designs, name TEXT NOT NULL, kind TEXT NOT NULL, met INTEGER,
  PRIMARY KEY (design, name)
) WITHOUT ROWID;
CREATE TABLE kinds (
  type TEXT NOT NULL, joints INTEGER NOT NULL, design TEXT NOT NULL REFERENCES designs,
  PRIMARY KEY (type, joints, design)
) WITHOUT ROWID;
CREATE TABLE texts (design TEXT PRIMARY KEY REFERENCES designs, folded TEXT NOT NULL) WITHOUT ROWID;
CREATE INDEX designs_by_graph ON designs (graph, effective);
CREATE INDEX designs_by_behaviour ON designs (effective, loops, mass);
"""
_SIGNATURE = b"SQLite format 3\0"


@dataclass(frozen=True)
class Catalog:
    """Sources (folders and results files that were added) and designs, both relative to the catalog's folder."""

    sources: tuple[str, ...] = ()
    entries: tuple[Entry, ...] = ()


def read(path: str | Path) -> Catalog:
    """The catalog at `path`. Raises InputError when there is none, or it is something else."""
    with open_catalog(path) as database:
        sources = tuple(_typed(row[0], "str") for row in database.execute("SELECT path FROM sources ORDER BY path"))
        rows = database.execute("SELECT * FROM designs ORDER BY path").fetchall()
        return Catalog(sources, tuple(entry_from(database, row) for row in rows))


def write(catalog: Catalog, path: str | Path) -> None:
    """Write the catalog in one step. Raises InputError where `path` holds something else, or is not writable."""
    if Path(path).exists() and Path(path).stat().st_size:
        with open_catalog(path):
            pass
    data = _bytes(catalog)
    provenance.record(hashlib.sha256(data).hexdigest())
    replace_file(path, data)


def is_recorded(path: str | Path) -> bool:
    """Whether this user's kinform wrote the file at `path`."""
    try:
        with open(path, "rb") as stream:
            return provenance.is_recorded(hashlib.file_digest(stream, "sha256").hexdigest(), path)
    except OSError:
        return False


_DAMAGE = (sqlite3.DatabaseError, UnicodeDecodeError, MemoryError)
"""What is raised for a file whose bytes make no sense; SQLite asks for as much memory as they say."""


@contextlib.contextmanager
def open_catalog(path: str | Path) -> Iterator[sqlite3.Connection]:
    """The database, open for reading. Raises InputError when there is none, or it is no catalog."""
    database = _connection(Path(path))
    try:
        yield database
    except _DAMAGE as error:
        why = str(error) or "a size in it is beyond all memory"
        raise _refuse(path, f"the catalog is damaged: {why}", "delete it, and add the designs again") from error
    finally:
        database.close()


def _connection(path: Path) -> sqlite3.Connection:
    """The database behind a file, after its signature and schema; raises InputError with the remedy."""
    make = "make one: kinform catalog add DIR"
    fault = not_a_file(path)
    if fault is not None:
        raise _refuse(path, fault, "name a catalog with --catalog")
    try:
        with path.open("rb") as stream:
            signature = stream.read(len(_SIGNATURE))
    except FileNotFoundError:
        raise _refuse(path, "there is no such catalog", f"{make}, or name one with --catalog") from None
    except OSError as error:
        raise _refuse(path, f"cannot be read: {error.strerror or error}", "name a catalog with --catalog") from None
    other = "this is not a catalog of kinform", "name another file with --catalog"
    if signature != _SIGNATURE:
        raise _refuse(path, *other)
    database = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
    try:
        # views and triggers of strangers could do anything, and for ever: there are none in a catalog
        made = _definitions(database)
        schemas = database.execute("SELECT schema FROM catalog").fetchall() if ("table", "catalog") in made else None
    except _DAMAGE:
        schemas = None
    if schemas is None:
        database.close()
        raise _refuse(path, *other) from None
    if schemas != [(SCHEMA,)]:
        database.close()
        schema = schemas[0][0] if schemas else "none"
        raise _refuse(path, f"the catalog has the schema {schema}; this kinform reads {SCHEMA}", "make it again")
    if made != _expected():
        database.close()
        raise _refuse(path, *other)
    database.row_factory = sqlite3.Row
    return database


def _definitions(database: sqlite3.Connection) -> dict[tuple[str, str], str | None]:
    """How everything in a database is defined, by kind and name."""
    return {(kind, name): sql for kind, name, sql in database.execute("SELECT type, name, sql FROM sqlite_master")}


@functools.cache
def _expected() -> dict[tuple[str, str], str | None]:
    """The definitions of a catalog: with others, such as views, a table could be anything, and without end."""
    with contextlib.closing(sqlite3.connect(":memory:")) as database:
        database.executescript(_TABLES)
        return _definitions(database)


def entry_from(database: sqlite3.Connection, row: sqlite3.Row) -> Entry:
    """The entry of one row of `designs`."""
    key = (row["path"],)
    parts = database.execute("SELECT name FROM parts WHERE design = ? ORDER BY name", key)
    joints = database.execute("SELECT * FROM joints WHERE design = ? ORDER BY name", key)
    wanted = database.execute("SELECT name, kind, met FROM requirements WHERE design = ? ORDER BY name", key)
    return Entry(
        **_values(Entry, row),
        size=_triple(row, "size"),
        parts=tuple(_typed(part[0], "str") for part in parts),
        joints=tuple(_joint(joint) for joint in joints),
        requirements=tuple(
            CatalogRequirement(
                _typed(name, "str"), _typed(kind, "str"), None if met is None else bool(_typed(met, "int"))
            )
            for name, kind, met in wanted
        ),
    )


def _joint(row: sqlite3.Row) -> CatalogJoint:
    return CatalogJoint(**_values(CatalogJoint, row), axis=_triple(row, "axis"), point=_triple(row, "point"))


_TYPES: dict[str, tuple[type, ...]] = {
    "str": (str,), "int": (int,), "str | None": (str, type(None)), "int | None": (int, type(None)),
    "float | None": (float, type(None)), "Verdict | None": (str, type(None)),
}  # fmt: skip
"""What a field may hold: SQLite keeps any value in any column."""


def _values(record: type[Entry | CatalogJoint], row: sqlite3.Row) -> dict[str, Any]:
    """The fields of a record for which the row has a column."""
    columns = row.keys()
    return {field.name: _typed(row[field.name], str(field.type)) for field in fields(record) if field.name in columns}


def _typed(value: Any, kind: str) -> Any:
    """The value, which has to be of this kind; sqlite3.DatabaseError where it is not."""
    if not isinstance(value, _TYPES[kind]):
        raise sqlite3.DatabaseError(f"it has a {type(value).__name__} where {kind} is expected")
    return value


def _triple(row: sqlite3.Row, name: str) -> Triple | None:
    x, y, z = (_typed(row[f"{name}_{letter}"], "float | None") for letter in "xyz")
    return None if x is None or y is None or z is None else (x, y, z)


def _bytes(catalog: Catalog) -> bytes:
    database = sqlite3.connect(":memory:")
    with contextlib.closing(database):
        database.executescript(_TABLES)
        with database:
            _insert(database, "catalog", [(SCHEMA,)])
            _insert(database, "sources", [(path,) for path in sorted(catalog.sources)])
            for entry in sorted(catalog.entries, key=lambda e: e.path):
                _insert_entry(database, entry)
        return bytes(database.serialize())


def _insert_entry(database: sqlite3.Connection, entry: Entry) -> None:
    nothing = (None, None, None)
    counts = (entry.bodies, entry.instantaneous, entry.finite, entry.effective, entry.idle, entry.loops)
    head = (entry.path, entry.digest, entry.name, entry.units, *counts)
    _insert(database, "designs", [(*head, entry.mass, *(entry.size or nothing), entry.verdict, entry.graph)])
    _insert(database, "parts", [(entry.path, part) for part in sorted(set(entry.parts))])
    joints = [
        (
            entry.path, j.name, j.type, j.status, j.freedoms, *(j.axis or nothing), *(j.point or nothing), j.pitch,
            j.lower, j.upper, j.intended, j.wanted_lower, j.wanted_upper,
        )
        for j in sorted(entry.joints, key=lambda j: j.name)
    ]  # fmt: skip
    _insert(database, "joints", joints)
    kinds = Counter(j.type for j in entry.joints)
    _insert(database, "kinds", [(kind, many, entry.path) for kind, many in sorted(kinds.items())])
    told = [entry.name, entry.path, *sorted(set(entry.parts)), *(j.intended for j in entry.joints if j.intended)]
    _insert(database, "texts", [(entry.path, "\n".join(told).casefold())])
    wanted = sorted(entry.requirements, key=lambda r: r.name)
    _insert(database, "requirements", [(entry.path, r.name, r.kind, r.met) for r in wanted])


def _insert(database: sqlite3.Connection, table: str, rows: list[tuple[object, ...]]) -> None:
    if rows:
        database.executemany(f"INSERT INTO {table} VALUES ({', '.join('?' * len(rows[0]))})", rows)


def _refuse(path: str | Path, message: str, remedy: str) -> InputError:
    return InputError([Problem(message, str(path), None, remedy)])
