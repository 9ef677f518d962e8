"""Many designs: found below folders, run by a crew of workers, told as one.

`discovery` finds designs, `unchanged` sees with one look at hashes which of them need nothing, `touched` which of them
a commit touches. What is left is done by a `crew`: workers of Dask, on this machine or anywhere. Each worker has a
`desk`, a process that does one task after another, each in a fork of its own, so that a crash, a hang or a hunger for
memory is that of one task and of nothing else. What was done is kept in a `record` beside the results, and told by
`renderings`.

A design that is run here goes through `kinform.method.run`, with the same bytes as result.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.batch.crew import Crew
    from kinform.batch.discovery import Found, discover
    from kinform.batch.record import Record, Row
    from kinform.batch.renderings import FORMATS, render
    from kinform.batch.session import Settings, run
    from kinform.batch.touched import changed_since

__all__ = ["FORMATS", "Crew", "Found", "Record", "Row", "Settings", "changed_since", "discover", "render", "run"]

__getattr__ = lazy_attributes(
    __name__,
    {
        "Crew": "crew",
        "Found": "discovery",
        "discover": "discovery",
        "Record": "record",
        "Row": "record",
        "FORMATS": "renderings",
        "render": "renderings",
        "Settings": "session",
        "run": "session",
        "changed_since": "touched",
    },
)
