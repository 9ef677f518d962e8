"""Findings as the check printed them."""

from __future__ import annotations

import json
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from kinform import reports
from kinform.model.design import Design

__all__ = ["data", "render"]


def data(design: Design) -> Any:
    """The findings and the outcome of each rule, as `kinform check --format json` prints them."""
    assert design.report is not None
    return json.loads(reports.render(design.report, design, "json"))


def render(design: Design) -> RenderableType:
    """The findings in full."""
    assert design.report is not None
    return Text(reports.render(design.report, design, "full").rstrip("\n"))
