"""What to look at for a finding: its parts, its joints, its place, and the moment of a movement at which it shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import Finding
from kinform.reports.page.movements import Mark, Movement
from kinform.reports.page.subjects import subjects_of

MEETING = ("KF412", "KF423", "KF505")
"""Rules whose findings are about parts that meet on the way."""


@dataclass(frozen=True, eq=False)
class Focus:
    """What a finding is about: parts, joints, a place, and the moment of a movement at which it shows."""

    parts: list[str]
    joints: list[str]
    place: Array | None
    """(3,) m, world, at that moment."""
    movement: int = -1
    """Number of the movement; −1: the pose of the meshes."""
    time: float = 0.0
    """Parameter of the movement."""
    meeting: tuple[str, ...] = ()
    """Parts that run into each other there."""


def focus_of(design: Design, movements: Sequence[Movement], finding: Finding) -> Focus:
    """Of one finding; parts that meet on the way are shown where they do."""
    parts, joints = subjects_of(design, finding.subject)
    place = None if finding.place is None else np.array(finding.place)
    if finding.code in MEETING:
        for k, movement in enumerate(movements):
            for mark in movement.marks:
                if mark.kind == "collision" and _shows(design, finding, movement, mark):
                    parts += [name for name in mark.parts if name not in parts]
                    return Focus(parts, joints, mark.place, k, mark.time, mark.parts)
    return Focus(parts, joints, place)


def _shows(design: Design, finding: Finding, movement: Movement, mark: Mark) -> bool:
    """Whether a mark is what the finding speaks of."""
    if finding.code == "KF505":
        return movement.kind == "simulation" and set(mark.parts) == set(finding.subject)
    if finding.code == "KF412":
        return movement.joint in subjects_of(design, finding.subject[:1])[1] and set(mark.parts) == set(
            finding.subject[1:]
        )
    asked = next((r for r in design.assembly.function.requirements if r.name in finding.subject), None)
    if asked is None or finding.found != "collision":
        return False
    sides = [subjects_of(design, [side])[0] for side in asked.values.get("between", ())]
    kind = "simulation" if asked.values.get("over") == "motion" else "freedom"
    return movement.kind == kind and len(sides) == 2 and all(set(side) & set(mark.parts) for side in sides)
