"""Findings as the check printed them."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from kinform import reports
from kinform.design import Design

_STYLES = {"error": "bold red", "warning": "bold yellow", "note": "bold cyan", "not decided": "bold magenta"}


def render(design: Design, fail_on: str = "error") -> RenderableType:
    """The findings in full."""
    assert design.report is not None
    text = Text(reports.render(design.report, design, "full", fail_on=fail_on).rstrip("\n"))
    for severity, style in _STYLES.items():
        text.highlight_regex(rf"(?m)^{severity}:", style)
    return text
