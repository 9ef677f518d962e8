"""`retained`: no part can leave along any direction but those listed."""

from __future__ import annotations

import math
from dataclasses import field
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Reference, Vector
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.rounding import SINGLE, TINY
from kinform.foundation.words import direction, quoted
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.kinematics import Body, Joint, Kinematics, Release, Separation
from kinform.requirements.answer import Answer, met, undecided, violated
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import DIRECTION, PLACE
from kinform.requirements.table import RequirementTable

SAME_DIRECTION = math.cos(math.radians(1.0))
"""Cosine of the angle within which directions agree. Chosen, not measured: directions are read off drawings to a
degree."""
REMEDY = "Add a shoulder, a clip, a lid or a screw; or list the direction."


class Retained(RequirementTable):
    """No part can leave along any direction but those listed."""

    kind: Literal["retained"]
    part: Annotated[Reference, PLACE] = Field(description="part or group")
    directions: Annotated[list[Vector], DIRECTION] = Field([], description="directions in which it may leave")


@dataclass(frozen=True, eq=False)
class RetainedRecord(Record):
    """A part can leave in the listed directions (n, 3) only."""

    part: str
    directions: Array = field(default_factory=lambda: np.zeros((0, 3)))


def judge(evidence: Evidence, wanted: RetainedRecord) -> Answer:
    """Ways to leave that are not listed."""
    kinematics = evidence.kinematics
    if evidence.lacking("contacts") is not None:
        return undecided("without contacts nothing says whether it is held", "Give the parts meshes.")
    name, listed = wanted.part, wanted.directions.reshape(-1, 3)
    parts = set(evidence.assembly.parts_of(name))
    bodies = [body for body in kinematics.bodies if parts & set(body.parts)]
    if all(body.ground for body in bodies):
        return undecided(f"'{name}' is the ground, which is held", "Require it of what shall not leave the ground.")
    ways = [
        (way, separation)
        for separation in kinematics.separations
        if any(parts & _parts(evidence, member) for member in separation.bodies)
        for way in separation.releases
        if not (way.kind == "slide" and _listed(way.direction, listed))
    ]
    if ways:
        return _leaves(evidence, name, *ways[0], more=len(ways) - 1)
    for body in bodies:
        if not body.ground and (slide := _slides(kinematics, body, listed)) is not None:
            return slide
    if kinematics.separations_reason:
        return undecided(kinematics.separations_reason, "Group what is fastened, or export finer meshes.")
    doubtful = [j for j in kinematics.joints if j.held is None and any(b.name in j.bodies for b in bodies)]
    if doubtful:
        why = doubtful[0].held_reason or "its joint is stated, not shown by contact"
        return undecided(f"contact does not say whether joint '{doubtful[0].name}' holds it: {why}", "See its joints.")
    return met("contact holds it in every direction that is not listed")


def _leaves(evidence: Evidence, name: str, way: Release, separation: Separation, more: int) -> Answer:
    """The requirement is violated by a way out, alone or with what leaves together."""
    others = [b for b in separation.bodies if name not in (b, *_parts(evidence, b))]
    together = f" together with {quoted(others)}" if others else ""
    also = f", and in {more} more ways" if more else ""
    return violated(
        f"'{name}' can {way.words}{together}{also}",
        found=direction(way.direction), intended="held, but for the listed directions",
        place=way.point, remedy=REMEDY,
    )  # fmt: skip


def _parts(evidence: Evidence, member: str) -> set[str]:
    """Parts of what a separation names: a body, a group or a part."""
    for body in evidence.kinematics.bodies:
        if body.name == member:
            return set(body.parts)
    try:
        return set(evidence.assembly.parts_of(member))
    except KeyError:
        return {member}


def _listed(way: Array, listed: Array) -> bool:
    return bool(len(listed) and (listed @ way).max() > SAME_DIRECTION)


def _slides(kinematics: Kinematics, body: Body, listed: Array) -> Answer | None:
    """Slides that keep contact: without an end they lead out of it."""
    joints = [joint for joint in kinematics.joints if body.name in joint.bodies]
    if not joints:
        return violated(
            f"'{body.name}' touches nothing and can leave every way", found="free", intended="held", remedy=REMEDY
        )
    index = [b.name for b in kinematics.bodies].index(body.name)
    open_: Answer | None = None
    for line in _pure_slides(kinematics.mobility.freedoms[:, index, :]):
        for way in (line, -line):
            if _listed(way, listed):
                continue
            ends = [_end(joint, body, way) for joint in joints]
            if "held" in ends:
                continue
            if "free" in ends:
                guide = joints[ends.index("free")]
                return violated(
                    f"'{body.name}' slides along {direction(way)} without an end", found=direction(way),
                    intended="held, but for the listed directions", place=guide.point, remedy=REMEDY,
                )  # fmt: skip
            open_ = open_ or undecided(
                f"'{body.name}' slides along {direction(way)}, and whether the slide has an end is not known",
                "List the direction if it may leave there, or have the range of its joint found.",
            )
    return open_


def _end(joint: Joint, body: Body, way: Array) -> str:
    """Whether a slide of the body along its joint, that way, has an end: held, free, or "" where that is not known."""
    if joint.type != "prismatic" or joint.axis is None or abs(float(joint.axis @ way)) <= SAME_DIRECTION:
        return ""
    if joint.range_status not in ("found", "unbounded"):
        return ""
    # a joint value is of its second body along the axis
    up = (float(joint.axis @ way) > 0.0) == (body.name == joint.bodies[1])
    end = joint.range_upper if up else joint.range_lower
    return "held" if end is not None and np.isfinite(end) else "free"


def _pure_slides(twists: Array) -> Array:
    """(k, 3) orthonormal directions in which the body can move without turning; twists (f, 6)."""
    if not len(twists):
        return np.zeros((0, 3))
    moving = null_space(twists[:, :3].T, SINGLE) @ twists[:, 3:]
    _, sizes, ways = np.linalg.svd(moving, full_matrices=False)
    return np.asarray(ways[sizes > SINGLE * max(float(np.abs(twists[:, 3:]).max(initial=0.0)), TINY)])


KIND = Kind("retained", 150, Retained, RetainedRecord, judge, needs={"kinematics": "Run `kinform joints`."})
