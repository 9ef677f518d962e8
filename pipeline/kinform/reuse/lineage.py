"""Whether a results file is what a run would give, told from the files alone: no mesh is parsed, no stage imported.

The lineage of a result is a hash of the files of the design, and of the settings and the versions of the code of its
stage and of all before it. It says less than a fingerprint, which sees through changes that do not matter, but is had
at the cost of reading the files once.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path

from kinform.foundation.boundary import Boundary
from kinform.foundation.regular_files import listing, not_a_file
from kinform.reuse import fingerprints
from kinform.reuse.dependence import STAGES, Stage
from kinform.reuse.digest import digest
from kinform.version import __version__


def of_files(manifest: str, files: Mapping[str, str]) -> str:
    """The lineage of the assembly that a manifest describes; "" where not every file is known."""
    if manifest not in files:
        return ""
    return digest("assembly", __version__, fingerprints.versions_of("assembly"), manifest, dict(files))


def following(stage: Stage, previous: str, asked: str | None = None) -> str:
    """The lineage of a stage's result, from that of the stage before; "" where that is not known. `asked` as of
    `advance`."""
    versions = [fingerprints.versions_of(kind) for kind in stage.code]
    return digest(stage.name, versions, asked, previous) if previous else ""


def of_code() -> str:
    """What tells the code of all stages from that of other versions."""
    versions = [fingerprints.versions_of(kind) for stage in STAGES for kind in stage.code]
    return digest("code", __version__, fingerprints.versions_of("assembly"), versions)


def before(stage: Stage) -> str:
    """The name of the stage before."""
    place = STAGES.index(stage)
    return STAGES[place - 1].name if place else "assembly"


def _same(top: Path, files: Mapping[str, str], boundary: Boundary) -> bool:
    """Whether every file has the content that it had. What was written last is looked at first: it is what changed, if
    anything did."""
    if not all(boundary.allows(os.path.join(top, name)) for name in files):
        return False
    try:
        times = {name: os.stat(os.path.join(top, name)).st_mtime_ns for name in files}
        for name in sorted(files, key=lambda name: -times[name]):
            path = os.path.join(top, name)
            if name.endswith("/"):
                if listing(path) != files[name]:
                    return False
                continue
            if not_a_file(path):
                return False
            with boundary.open(path) as stream:
                if hashlib.file_digest(stream, "sha256").hexdigest() != files[name]:
                    return False
    except OSError:
        return False
    return True


def current(manifest: Path, files: Mapping[str, str], *, allow_outside: bool) -> str:
    """The lineage that the findings of a run would have now, if it read the same files as before; "" otherwise."""
    if manifest.name not in files or not _same(manifest.parent, files, Boundary(manifest, allow_outside=allow_outside)):
        return ""
    descent = of_files(manifest.name, files)
    for stage in STAGES:
        descent = following(stage, descent)
    return descent
