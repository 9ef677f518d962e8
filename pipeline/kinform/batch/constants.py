"""Every number that decides how many designs are done; none decides what comes out of a design."""

from __future__ import annotations

# desk

LOOK = 0.05
"""s between two looks at the memory of a task and at its clock: a process that writes new memory at 1 GB/s is seen
within 50 MB of its limit. A choice."""

# crew

TRIES = 2
"""How often a task is begun whose worker died: once, and once more elsewhere."""

WAITING = 2
"""Tasks a worker that are under way or waiting for it, so that none is idle while an answer travels. A choice."""

PATIENCE = 20.0
"""s in which a scheduler has to answer, and to have a worker."""

# record

KEEPING = 5.0
"""s between two writings of the record: what a killed batch has to look at again."""

# discovery

HEAD = 65536
"""Bytes of an XML file in which its root element is looked for."""
