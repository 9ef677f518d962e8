"""One look at hashes for all designs: which results are what a run would give now.

Nothing is opened as HDF5 and no stage is imported: the files that a design was made of, and its results, are hashed
and compared with the record. No time of a file counts.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from kinform.batch.discovery import Found
from kinform.batch.record import Record, Row
from kinform.foundation.boundary import leads_out, way_out
from kinform.reuse import lineage


def row_if_unchanged(found: Found, record: Record, folder: Path, *, allow_outside: bool) -> Row | None:
    """The row of a design whose results in `folder` are what a run would give; None of others."""
    row = record.rows.get(found.name)
    if row is None or row.failure or not row.lineage or row.results != found.results:
        return None
    if way_out(folder / found.results, (), folder) or (not allow_outside and leads_out(found.source)):
        return None
    if digest_of(folder / found.results) != row.digest:
        return None
    if lineage.current(found.source, row.files, allow_outside=allow_outside) != row.lineage:
        return None
    return replace(row, source=str(found.source), unchanged=True)


def digest_of(path: Path) -> str:
    """SHA-256 (hex) of a file; "" where it cannot be read."""
    try:
        with open(path, "rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return ""
