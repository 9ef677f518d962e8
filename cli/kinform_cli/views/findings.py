"""Findings as the check printed them."""

from __future__ import annotations

from rich.console import RenderableType
from rich.text import Text

from kinform import reports
from kinform.model.design import Design

__all__ = ["render"]


def render(design: Design) -> RenderableType:
    """The findings in full."""
    assert design.report is not None
    return Text(reports.render(design.report, design, "full").rstrip("\n"))
