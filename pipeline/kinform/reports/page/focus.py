"""What to look at for a finding: its parts, its joints, its place, and the moment of a movement at which it shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.consistency.comparisons.ranges import shown
from kinform.design import Design
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.model.arrays import Array
from kinform.model.collisions import RangeEnd
from kinform.model.findings import Finding
from kinform.model.kinematics import Joint
from kinform.reports.page.movements import Mark, Movement
from kinform.reports.page.subjects import subjects_of

MEETING = ("KF423", "KF505")
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
    if finding.code == "KF412":
        return _at_end(design, movements, finding) or Focus(parts, joints, place)
    if finding.code in MEETING:
        for k, movement in enumerate(movements):
            for mark in movement.marks:
                if mark.kind == "collision" and _shows(design, finding, movement, mark):
                    parts += [name for name in mark.parts if name not in parts]
                    return Focus(parts, joints, mark.place, k, mark.time, mark.parts)
    return Focus(parts, joints, place)


def _at_end(design: Design, movements: Sequence[Movement], finding: Finding) -> Focus | None:
    """The end of a joint's range that a finding is about, at the pose in which the joint is there; None where no
    movement takes it there."""
    assert design.kinematics is not None
    found = resolve_joint(design.assembly, design.kinematics, finding.subject[0])
    run, joint = design.simulation, found.joint
    item = next((item for item in (run.ranges if run else None) or () if joint and item.joint == joint.name), None)
    if item is None or joint is None or found.intended is None:
        return None
    told = (finding.found or "").partition(" (")[0]  # what else is to be known of that end stands in brackets
    for end in (item.lower, item.upper):
        value = _value(end)
        if value is None or shown(found.sign * value, found.intended, design.assembly.units) != told:
            continue
        freedoms = [k for k, movement in enumerate(movements) if movement.kind == "freedom"]
        driven = [k for k in freedoms if movements[k].joint == joint.name] or freedoms
        if driven:
            _, time, k = min((*_nearest(movements[k], joint, value), k) for k in driven)
            parts, joints = subjects_of(design, finding.subject)
            return Focus(parts, joints, end.place, k, time, end.parts)
    return None


def _value(end: RangeEnd) -> float | None:
    """rad or m at which a joint stops, or has left its guide."""
    return end.leaves if end.status == "unbounded" else end.value


def _nearest(movement: Movement, joint: Joint, value: float) -> tuple[float, float]:
    """How close a joint comes to a value (rad or m) in a movement, and the parameter at which it does."""
    values = movement.values(joint)
    steps = np.diff(values)
    shares = np.clip(np.divide(value - values[:-1], steps, out=np.zeros_like(steps), where=steps != 0.0), 0.0, 1.0)
    missed = np.abs(values[:-1] + shares * steps - value)
    k = int(np.argmin(missed))
    return float(missed[k]), float(movement.time[k] + shares[k] * (movement.time[k + 1] - movement.time[k]))


def _shows(design: Design, finding: Finding, movement: Movement, mark: Mark) -> bool:
    """Whether a mark is what the finding speaks of."""
    if finding.code == "KF505":
        return movement.kind == "simulation" and set(mark.parts) == set(finding.subject)
    asked = next((r for r in design.assembly.function.requirements if r.name in finding.subject), None)
    if asked is None or finding.found != "collision":
        return False
    sides = [subjects_of(design, [side])[0] for side in asked.values.get("between", ())]
    kind = "simulation" if asked.values.get("over") == "motion" else "freedom"
    return movement.kind == kind and len(sides) == 2 and all(set(side) & set(mark.parts) for side in sides)
