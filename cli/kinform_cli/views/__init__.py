"""What `kinform show` prints: one module per topic, with `data` for JSON and `render` for people."""

from __future__ import annotations

from typing import Any

from rich.console import RenderableType

from kinform.errors import StageError
from kinform.model.design import Design
from kinform_cli.views import overview
from kinform_cli.views.topics import TOPICS

__all__ = ["data", "render"]


def data(design: Design, topic: str | None) -> Any:
    """The topic's values for JSON, or all of them; raises StageError where its stage has not run."""
    if topic is None:
        return overview.data(design)
    _require(design, topic)
    return TOPICS[topic].view.data(design)


def render(design: Design, topic: str | None) -> RenderableType:
    """The topic for people, or an overview; raises StageError where its stage has not run."""
    if topic is None:
        return overview.render(design)
    _require(design, topic)
    view: RenderableType = TOPICS[topic].view.render(design)
    return view


def _require(design: Design, topic: str) -> None:
    if not TOPICS[topic].known(design):
        raise StageError(f"`kinform show {topic}`", TOPICS[topic].command)
