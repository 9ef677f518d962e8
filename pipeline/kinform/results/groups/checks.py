"""`/assembly/check`: how the rules are to be applied."""

from __future__ import annotations

import h5py

from kinform.model.checks import CheckSettings, Ignore
from kinform.results.table import (
    integer,
    read_records,
    read_rows,
    read_texts,
    text,
    write_records,
    write_rows,
    write_texts,
)

__all__ = ["read", "write"]

_PLACE = (text("file"), integer("line", optional=True))
_SEVERITY = (text("rule"), text("severity"))
_IGNORE = (text("code"), text("subject"), text("reason"), *_PLACE)


def write(group: h5py.Group, settings: CheckSettings) -> None:
    """Write `[check]`."""
    write_records(group, "header", _PLACE, [settings])
    write_texts(group, "select", settings.select)
    write_rows(group, "severity", _SEVERITY, [{"rule": rule, "severity": level} for rule, level in settings.severity])
    write_records(group, "ignore", _IGNORE, settings.ignore)


def read(group: h5py.Group) -> CheckSettings:
    """The settings that `write` wrote."""
    (header,) = read_rows(group, "header", _PLACE)
    return CheckSettings(
        select=read_texts(group, "select"),
        severity=tuple((row["rule"], row["severity"]) for row in read_rows(group, "severity", _SEVERITY)),
        ignore=read_records(group, "ignore", _IGNORE, Ignore),
        **header,
    )
