"""Files of a design, opened through its boundary, as its readers open them."""

from __future__ import annotations

import os
from pathlib import Path

from kinform.foundation.boundary import Boundary
from kinform.foundation.escapes import one_line
from kinform.frozen import dataclass
from kinform.replays.outcome import NotReplayed


@dataclass(frozen=True, eq=False)
class Files:
    """What a results file names: names relative to a folder, of which the boundary allows some."""

    folder: Path
    boundary: Boundary

    def path(self, name: str) -> Path:
        """A file of the design; NotReplayed for what may not be read, which is not asked for either."""
        if "\0" in name or os.path.isabs(name) or not self.boundary.allows(self.folder / name):
            raise NotReplayed(f"{one_line(name)} lies outside the design's folder")
        return self.folder / name

    def is_there(self, name: str) -> bool:
        """Whether such a file is there."""
        return self.boundary.is_file(self.path(name))

    def read(self, name: str, most: int) -> bytes:
        """The content of a file of at most so many bytes; NotReplayed otherwise."""
        path = self.path(name)
        try:
            with self.boundary.open(path) as stream:
                data = stream.read(most + 1)
        except OSError as error:
            raise NotReplayed(f"{one_line(name)} cannot be read: {error.strerror}") from None
        if len(data) > most:
            raise NotReplayed(f"{one_line(name)} is larger than {most >> 20} MiB")
        return data
