"""What an exporter gives back: files, and what their format could not carry; and how the files come into a folder."""

from __future__ import annotations

from pathlib import Path

from kinform.errors import KinformError
from kinform.frozen import dataclass
from kinform.results.replacement import make_folder, replace_file


@dataclass(frozen=True)
class Exported:
    """Files by their path in the output folder, with "/"; sentences about what is not in them."""

    files: dict[str, bytes]
    lost: tuple[str, ...] = ()
    """What the model says and the format cannot carry, or carries otherwise than it is."""
    remarks: tuple[str, ...] = ()
    """Choices of the exporter that change nothing of what the model says."""


class ExportError(KinformError):
    """There is nothing to export in this format."""


class LostError(KinformError):
    """A strict export would have lost something; carries the sentences."""

    def __init__(self, format: str, lost: tuple[str, ...]):
        self.format, self.lost = format, lost
        super().__init__("\n".join(lost))


def write(exported: Exported, folder: str | Path) -> tuple[Path, ...]:
    """Write the files, each in one step, making folders as needed; a file with the same bytes is kept.

    Returns their paths, sorted. Raises ResultsError, and OSError where a folder cannot be made.
    """
    out: list[Path] = []
    swept: set[Path] = set()
    for name, data in sorted(exported.files.items()):
        target = Path(folder) / name
        make_folder(target.parent, Path(folder))
        replace_file(target, data, sweeps=target.parent not in swept, below=Path(folder))
        swept.add(target.parent)
        out.append(target)
    return tuple(out)
