"""What the geometry hints at and does not prove: parts that are probably one body, axes of plain faces."""

from kinform.contacts.fastening.suggest import fastened, suggest

__all__ = ["CODE_VERSION", "fastened", "suggest"]

CODE_VERSION: int = 3
"""Raised when the same input would give other suggestions."""
