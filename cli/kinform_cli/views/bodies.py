"""Bodies, and why each part is in its own."""

from __future__ import annotations

import math

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.function.body_titles import body_titles
from kinform.model.kinematics import Membership
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, number


def render(design: Design) -> RenderableType:
    """One row a body, then, where bodies follow from the function, one a part that could be elsewhere."""
    kinematics = design.kinematics
    assert kinematics is not None
    title = counted(len(kinematics.bodies), "body", "bodies")
    rows = Rows("body", "parts", "made one by", title=title, texts=["body", "parts", "made one by"])
    single = [b for b in kinematics.bodies if (*map(str, b.parts),) == (str(b.name),) and not (b.merged or b.ground)]
    titles = body_titles(design.assembly, kinematics)
    for body in kinematics.bodies:
        if body not in single:
            ground = " (ground)" if body.ground else ""
            title = f", the {titles[body.name]}" if body.name in titles else ""
            rows.add(f"{body.name}{title}{ground}", ", ".join(body.parts), "; ".join(body.merged) or NONE)
    alone = [f"\nof one part each: {', '.join(body.name for body in single)}"] if single else []
    unclear = sorted((one for one in kinematics.membership if one.either), key=lambda one: (one.margin, one.part))
    if not unclear:
        return stacked(rows, *alone)
    lost = [one for one in unclear if one.how == "nearest"]
    touching = [one for one in unclear if one.how != "nearest"]
    held = [_touching(touching)] if touching else []
    return stacked(rows, *alone, *held, *([_lost(lost)] if lost else []))


def _touching(unclear: list[Membership]) -> RenderableType:
    """One row a part that touches what is in other bodies, too."""
    title = f"\n{counted(len(unclear), 'part')} that could be in another body, the least clear first"
    names, texts = ("part", "is in", "could be in"), ("by", "evidence")
    more = Rows(*names, "by", "how clear", "evidence", title=title, right=["how clear"], names=names, texts=texts)
    for one in unclear:
        more.add(one.part, one.body, one.other or NONE, _HOW[one.how], _clear(one), one.evidence or NONE)
    legend = "how clear: by how much breaking the contacts of the other body would be dearer (a journal 40, a flat 300)"
    return stacked(more, Text(legend, style="dim"))


def _lost(unclear: list[Membership]) -> Rows:
    """One row a body with what touches nothing and is nearest to it."""
    title = f"\n{counted(len(unclear), 'part')} that nothing holds: each is in the body that is nearest"
    more = Rows("is in", "parts", title=title, names=["is in"], texts=["parts"])
    for body in sorted({one.body for one in unclear}):
        more.add(body, ", ".join(str(one.part) for one in unclear if one.body == body))
    return more


_HOW = {"held": "no joint parts it", "cut": "least contact parted"}


def _clear(one: Membership) -> str:
    return NONE if not math.isfinite(one.margin) else number(one.margin)
