"""Bodies, and why each part is in its own."""

from __future__ import annotations

import math

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.words import counted
from kinform.model.kinematics import Membership
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, number


def render(design: Design) -> RenderableType:
    """One row a body, then, where bodies follow from the function, one a part that could be elsewhere."""
    kinematics = design.kinematics
    assert kinematics is not None
    rows = Rows("body", "parts", "made one by", title=counted(len(kinematics.bodies), "body", "bodies"))
    for body in kinematics.bodies:
        rows.add(
            body.name + (" (ground)" if body.ground else ""), ", ".join(body.parts), "; ".join(body.merged) or NONE
        )
    unclear = sorted((one for one in kinematics.membership if one.either), key=lambda one: (one.margin, one.part))
    if not unclear:
        return stacked(rows)
    title = f"\n{counted(len(unclear), 'part')} that could be in another body, the least clear first"
    more = Rows("part", "is in", "could be in", "by", "how clear", "evidence", title=title, right=["how clear"])
    for one in unclear:
        more.add(one.part, one.body, one.other or NONE, _HOW[one.how], _clear(one), one.evidence or NONE)
    legend = "how clear: by how much breaking the contacts of the other body would be dearer (a journal 40, a flat 300)"
    return stacked(rows, more, Text(legend, style="dim"))


_HOW = {"held": "no joint parts it", "cut": "least contact parted", "nearest": "touches nothing: nearest"}


def _clear(one: Membership) -> str:
    return NONE if not math.isfinite(one.margin) else number(one.margin)
