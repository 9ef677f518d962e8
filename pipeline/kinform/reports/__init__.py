"""Findings as text for people, tools and CI: one renderer a format, all from one model."""

from __future__ import annotations

from collections.abc import Callable

from kinform.model.design import Design
from kinform.model.findings import CheckReport
from kinform.reports import as_json, concise, full, github, junit, markdown, sarif
from kinform.reports.json_views import joint_evidence, joint_json, summary, summary_json

__all__ = ["FORMATS", "joint_evidence", "joint_json", "render", "summary", "summary_json"]

FORMATS: dict[str, Callable[[CheckReport, Design], str]] = {
    "concise": concise.render,
    "full": full.render,
    "github": github.render,
    "json": as_json.render,
    "junit": junit.render,
    "md": markdown.render,
    "sarif": sarif.render,
}


def render(report: CheckReport, design: Design, format: str, *, fail_on: str = "error") -> str:
    """The report in that format, ending in a newline; ValueError for an unknown format.

    `fail_on` is the least severity that fails the gate: what JUnit calls a failure.
    """
    if format == "junit":
        return junit.render(report, design, fail_on)
    try:
        renderer = FORMATS[format]
    except KeyError:
        raise ValueError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}") from None
    return renderer(report, design)
