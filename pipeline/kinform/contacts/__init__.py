"""Contacts: where the parts of an assembly touch, as patches between surfaces, and where they overlap."""

from __future__ import annotations

from kinform.contacts.find import find

__all__ = ["CODE_VERSION", "find"]

CODE_VERSION: int = 10
"""Raised when the same input would give other contacts."""
