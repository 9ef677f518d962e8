"""What `kinform show` prints for people: one module per topic. The JSON is `kinform.reports.summary_json`."""

from __future__ import annotations

from rich.console import RenderableType

from kinform.design import Design
from kinform.errors import StageError

__all__ = ["render", "render_joint"]


def render(design: Design, topic: str | None) -> RenderableType:
    """The topic for people, or an overview; raises StageError where its stage has not run."""
    from kinform_cli.views import overview
    from kinform_cli.views.topics import TOPICS

    if topic is None:
        return overview.render(design)
    _require(design, topic)
    view: RenderableType = TOPICS[topic].view.render(design)
    return view


def render_joint(design: Design, name: str) -> RenderableType:
    """All the evidence of one joint; raises StageError, or KeyError for a name that no joint has."""
    from kinform_cli.views import joint

    _require(design, "joints")
    return joint.render(design, name)


def _require(design: Design, topic: str) -> None:
    from kinform_cli.views.topics import TOPICS

    if not TOPICS[topic].known(design):
        raise StageError(f"`kinform show {topic}`", TOPICS[topic].command)
