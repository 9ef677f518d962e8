"""Results: the HDF5 file that carries a design from stage to stage, and what may be reused of it."""

from kinform.results._file import SCHEMA, check_output, files_of, read, read_if_current, to_bytes, write

__all__ = ["SCHEMA", "check_output", "files_of", "read", "read_if_current", "to_bytes", "write"]
