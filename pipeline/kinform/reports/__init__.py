"""Findings as text for people, tools and CI: one renderer a format, all from one model.

A renderer is imported when its format is asked for: a run that changes nothing takes less time than all of them.

Sub-packages; each imports only those above it:

- `values`: a design as plain values, for JSON and the page
- `page`: the page and pictures
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kinform.design import Design
from kinform.foundation.escapes import lines
from kinform.model.findings import CheckReport

if TYPE_CHECKING:
    from kinform.reports.values.topics import joint_evidence, joint_json, summary, summary_json

__all__ = ["FORMATS", "joint_evidence", "joint_json", "render", "summary", "summary_json"]

FORMATS = {
    "brief": "brief", "concise": "concise", "full": "full", "github": "github", "json": "as_json", "junit": "junit",
    "md": "markdown", "sarif": "sarif",
}  # fmt: skip
"""By format: the module that renders it."""

TEXTS = ("brief", "concise", "full", "md")
"""Formats that are lines for people; the others escape as their parsers expect."""

_VIEWS = ("joint_evidence", "joint_json", "summary", "summary_json")


def render(
    report: CheckReport,
    design: Design,
    format: str,
    *,
    fail_on: str = "error",
    run: Mapping[str, Any] | None = None,
    width: int | None = None,
) -> str:
    """The report in that format, ending in a newline; ValueError for an unknown format.

    `fail_on` is the least severity that fails the gate, which the verdict goes by, and what JUnit calls a failure.
    `run` is the account of a run, which the JSON carries. `width` are the columns of `brief`, 80 where it is None.
    """
    if format not in FORMATS:
        raise ValueError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}")
    renderer = importlib.import_module(f"kinform.reports.{FORMATS[format]}")
    more: dict[str, Any] = {"run": run} if format == "json" else {}
    if format == "brief" and width is not None:
        more = {"width": width}
    text: str = renderer.render(report, design, fail_on, **more)
    return lines(text) if format in TEXTS else text


def __getattr__(name: str) -> Any:
    if name not in _VIEWS:
        raise AttributeError(f"module 'kinform.reports' has no attribute {name!r}")
    return getattr(importlib.import_module("kinform.reports.values.topics"), name)
