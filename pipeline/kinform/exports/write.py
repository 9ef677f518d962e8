"""Puts the files of an export into a folder, each in one step; a file with the same bytes is kept."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from kinform.exports.exported import Exported

__all__ = ["write"]


def write(exported: Exported, folder: str | Path) -> tuple[Path, ...]:
    """Write the files, making folders as needed; their paths, sorted. Raises OSError."""
    out = []
    for name, data in sorted(exported.files.items()):
        target = Path(folder) / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.is_file() and target.stat().st_size == len(data) and target.read_bytes() == data:
            os.utime(target)
        else:
            _swap(target, data)
        out.append(target)
    return tuple(out)


def _swap(target: Path, data: bytes) -> None:
    draft = target.parent / f".kinform-{secrets.token_hex(8)}.tmp"
    try:
        draft.write_bytes(data)
        os.replace(draft, target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
