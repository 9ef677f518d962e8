"""Findings as the check printed them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import RenderableType
from rich.text import Text

if TYPE_CHECKING:
    from kinform.design import Design

_STYLES = {"error": "bold red", "warning": "bold yellow", "note": "bold cyan", "not decided": "bold magenta"}


def render(design: Design, fail_on: str = "error") -> RenderableType:
    """The findings in full."""
    from kinform import reports

    assert design.report is not None
    return coloured(reports.render(design.report, design, "full", fail_on=fail_on))


def coloured(told: str) -> Text:
    """Findings that were told in lines, with the colours of their severities."""
    text = Text(told.rstrip("\n"))
    for severity, style in _STYLES.items():
        text.highlight_regex(rf"(?m)^{severity}:", style)
    return text
