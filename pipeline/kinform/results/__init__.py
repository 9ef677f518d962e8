"""Results: the HDF5 file that carries a design from stage to stage, and what may be reused of it."""

from kinform.results.file import (
    SCHEMA,
    Earlier,
    check_output,
    earlier,
    files_of,
    read,
    read_if_current,
    to_bytes,
    write,
)
from kinform.results.replacement import replace_file

__all__ = [
    "SCHEMA",
    "Earlier",
    "check_output",
    "earlier",
    "files_of",
    "read",
    "read_if_current",
    "replace_file",
    "to_bytes",
    "write",
]
