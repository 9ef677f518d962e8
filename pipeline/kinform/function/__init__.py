"""Function: which joint of the derived behaviour a name in the designer's statements stands for."""

from __future__ import annotations

from kinform.function.resolve import Resolution, resolve

__all__ = ["CODE_VERSION", "Resolution", "resolve"]

CODE_VERSION: int = 3
