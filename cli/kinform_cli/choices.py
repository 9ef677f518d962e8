"""What options choose from."""

from __future__ import annotations

import os
from enum import StrEnum

__all__ = ["FindingsFormat", "Severity", "TableFormat", "cores"]


def cores(jobs: int | None) -> int:
    """How many processes `--jobs` stands for."""
    return jobs or os.cpu_count() or 1


class Severity(StrEnum):
    """Severities of findings, from the worst."""

    error = "error"
    warning = "warning"
    note = "note"


class FindingsFormat(StrEnum):
    """How findings are printed."""

    full = "full"
    concise = "concise"
    json = "json"
    sarif = "sarif"
    junit = "junit"
    github = "github"
    md = "md"


class TableFormat(StrEnum):
    """How results are printed."""

    table = "table"
    json = "json"
