"""Results: the HDF5 file that carries a design from stage to stage, and what may be reused of it.

Sub-packages; each imports only those above it:

- `groups`: the groups of the file, one module each
"""

from kinform.results.at_need import Earlier
from kinform.results.file import (
    as_absent,
    check_output,
    computed_anew,
    earlier,
    fault_of,
    files_of,
    is_unknown,
    read,
    read_at_need,
    read_gist,
    read_if_current,
    to_bytes,
    unknown_origin,
    write,
    write_bytes,
)
from kinform.results.opening import SCHEMA, NotWholeError
from kinform.results.replacement import make_folder, refuse_links, replace_file
from kinform.results.seal import digest_in

__all__ = [
    "SCHEMA",
    "Earlier",
    "NotWholeError",
    "as_absent",
    "check_output",
    "computed_anew",
    "digest_in",
    "earlier",
    "fault_of",
    "files_of",
    "is_unknown",
    "make_folder",
    "read",
    "read_at_need",
    "read_gist",
    "read_if_current",
    "refuse_links",
    "replace_file",
    "to_bytes",
    "unknown_origin",
    "write",
    "write_bytes",
]
