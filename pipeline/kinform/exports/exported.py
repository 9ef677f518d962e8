"""What an exporter gives back: files, and what their format could not carry."""

from __future__ import annotations

from dataclasses import dataclass

from kinform.errors import KinformError

__all__ = ["ExportError", "Exported", "LostError"]


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
