"""`retained`: no part can leave along any direction but those listed.

Contact alone says where a part can go, by itself or with others: its translations make a cone. Whether it gets out
there is asked of the meshes: along a few directions of the cone the parts are moved until nothing is in their way, or
something is. One free way is a proof that it leaves. It stays where it is stopped in all of them: within its clearance,
or while what guides it along the only line that it has still guides it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import field, replace
from itertools import combinations, product
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Reference, Vector
from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.rounding import SINGLE, TINY
from kinform.foundation.words import direction, length, quoted
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import Witness, free_way
from kinform.model.kinematics import Body, Joint, Kinematics, Separation
from kinform.requirements.answer import Answer, met, undecided, violated
from kinform.requirements.evidence import Evidence, WayOut
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import DIRECTION, PLACE
from kinform.requirements.table import RequirementTable

SAME_DIRECTION = math.cos(math.radians(1.0))
"""Cosine of the angle within which directions agree. Chosen, not measured: directions are read off drawings to a
degree."""
SINE = math.sin(math.radians(1.0))
"""Sine of the same angle."""
CLEARANCE = 0.05
"""Travel, of the size of what moves, within which it stays where it is whatever directions lie between those that were
tried. Chosen, not measured: clearances are less, and gaps to get out through are wider."""
MOST_DIRECTIONS = 14
"""Directions tried of one cone: those to the faces and corners of a cube, where all are free."""
MOST_PUSHED = 8
"""Groups that may be pushed along one after the other. Chosen, not measured."""
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


@dataclass(frozen=True, eq=False)
class _Group:
    """Bodies that can leave together, as far as contact says."""

    members: tuple[str, ...]
    """Bodies, groups or parts."""
    parts: frozenset[str]
    ways: tuple[Array, ...]
    """(3,) unit: those of which all others are sums."""
    line: bool
    """Whether these are all there are."""
    along: tuple[Array, ...]
    """Those along which it slides, breaking no contact."""
    place: Array | None


@dataclass(frozen=True, eq=False)
class _Course:
    """What became of a group along one direction."""

    direction: Array
    parts: frozenset[str]
    """Those of the group, and those that it pushed along."""
    end: WayOut


def judge(evidence: Evidence, wanted: RetainedRecord) -> Answer:
    """Whether anything leaves along a direction that is not listed."""
    kinematics = evidence.kinematics
    if evidence.lacking("contacts") is not None:
        return undecided("without contacts nothing says whether it is held", "Give the parts meshes.")
    name, listed = wanted.part, wanted.directions.reshape(-1, 3)
    parts = set(evidence.assembly.parts_of(name))
    bodies = [body for body in kinematics.bodies if parts & set(body.parts)]
    if parts <= _ground(evidence):
        return undecided(f"'{name}' is the ground, which is held", "Require it of what shall not leave the ground.")
    every = _groups(evidence)
    groups = [group for group in every if parts & group.parts]
    groups += [_untouched(body) for body in bodies if not any(body.name in joint.bodies for joint in kinematics.joints)
               and len(kinematics.bodies) > 1 and not body.ground]  # fmt: skip
    doubts: list[Answer] = []
    courses: list[_Course] = []
    loose: list[tuple[_Group, _Course]] = []
    """What is stopped, but not guided along a single line until then."""
    for group in sorted(groups, key=lambda group: (len(group.parts), group.members)):
        for course in _courses(evidence, group, listed, every):
            if course.end.status == "free":
                return _leaves(evidence, name, group, course)
            courses.append(course)
            if course.end.status == "unknown":
                doubts.append(_not_followed(name, course))
            elif not (group.line and course.end.travel < course.end.left):
                loose.append((group, course))
    for group, course in loose:
        far, opens = _goes_far(evidence, group, course), not _slides_along(group, course.direction)
        aside = _aside(evidence, course) if far or (opens and course.end.travel > 0.0) else None
        if aside is not None:
            return _leaves(evidence, name, group, course, aside)
        if far:
            doubts.append(_on_its_way(evidence, name, course))
    for body in bodies:
        if not body.ground and (slide := _slides(kinematics, body, groups, listed)) is not None:
            if slide.state == "violated":
                return slide
            doubts.append(slide)
    return (doubts + _unknown(evidence, bodies, parts) + [_stays(evidence, bodies, courses)])[0]


def _ground(evidence: Evidence) -> set[str]:
    """Parts that are the ground itself, not held to it by contact."""
    assembly = evidence.assembly
    if assembly.ground is None or evidence.kinematics.membership:
        return {part for body in evidence.kinematics.bodies if body.ground for part in body.parts}
    out: set[str] = set(assembly.parts_of(assembly.ground))
    grown = True
    while grown:
        more = [set(group.parts) for group in assembly.groups if out & {*group.parts} and not out >= {*group.parts}]
        grown = bool(more)
        out.update(*more)
    return out


def _unknown(evidence: Evidence, bodies: Sequence[Body], parts: AbstractSet[str]) -> list[Answer]:
    """What the kinematics do not know of the bodies."""
    kinematics = evidence.kinematics
    out = []
    for separation in kinematics.separations:
        turns = [way for way in separation.releases if way.kind != "slide"]
        members = {part for member in separation.bodies for part in _parts(evidence, member)}
        if turns and len(turns) == len(separation.releases) and parts & members:
            out.append(undecided(
                f"{quoted(separation.bodies)} can {turns[0].words}, which opens all contact; where that leads is not "
                "followed", "See whether it comes out that way, and hold it where it does.",
            ))  # fmt: skip
    if kinematics.separations_reason:
        out.append(undecided(kinematics.separations_reason, "Group what is fastened, or export finer meshes."))
    for joint in kinematics.joints:
        if not any(body.name in joint.bodies for body in bodies):
            continue
        if joint.status == "ambiguous" and not joint.readings:
            said = f"joint '{joint.name}' is ambiguous: {joint.reason}"
            out.append(undecided(said, "See its joints."))
        elif joint.held is None:
            why = joint.held_reason or "its joint is stated, not shown by contact"
            said = f"contact does not say whether joint '{joint.name}' holds it: {why}"
            out.append(undecided(said, "See its joints."))
    return out


def _stays(evidence: Evidence, bodies: Sequence[Body], courses: Sequence[_Course]) -> Answer:
    message = "contact holds it in every direction that is not listed"
    if courses:
        far = max(courses, key=lambda course: course.end.travel)
        stop = f" before {quoted(far.end.by)} stops it" if far.end.by else ""
        message += f"; it moves {length(far.end.travel, evidence.units, 3)} along {direction(far.direction)}{stop}"
    names = {body.name for body in bodies}
    if any(joint.type == "screw" and names & {*joint.bodies} for joint in evidence.kinematics.joints):
        message += "; it can be unscrewed"
    return met(message)


def _leaves(evidence: Evidence, name: str, group: _Group, course: _Course, aside: Array | None = None) -> Answer:
    """The requirement is violated by a way out, alone or with what leaves together; `aside`: that after a piece of the
    course."""
    of_name = set(evidence.assembly.parts_of(name))
    others = [b for b in group.members if name != b and not _parts(evidence, b) <= of_name]
    others += sorted(course.parts - group.parts)
    together = f" together with {quoted(others)}" if others else ""
    does = "slide out" if _slides_along(group, course.direction) else "leave"
    then = "" if aside is None else f" and then along {direction(aside)}"
    return violated(
        f"'{name}' can {does} along {direction(course.direction)}{then}{together}; nothing stops it",
        found=direction(course.direction), intended="held, but for the listed directions",
        place=group.place, remedy=REMEDY,
        witness=_witness(evidence, course.parts, course, aside),
    )  # fmt: skip


def _witness(evidence: Evidence, parts: AbstractSet[str], course: _Course, aside: Array | None) -> Witness | None:
    """The way out of the parts, as far as they are clear of all others."""
    meshed = [part for part in evidence.assembly.parts if part.mesh is not None and len(part.mesh.faces)]
    boxes = {str(part.name): part.mesh.placed_box(part.X_WP) for part in meshed if part.mesh is not None}
    rest = [name for name in boxes if name not in parts]
    moving = [name for name in boxes if name in parts]
    if not rest or not moving:
        return None
    way, after = (course.direction, np.zeros(3)) if aside is None else (aside, _half_way(course))
    low, high = (np.array([box[end] for box in map(boxes.get, rest) if box]) for end in (0, 1))
    own_low, own_high = (np.array([box[end] for box in map(boxes.get, moving) if box]) + after for end in (0, 1))
    clear = np.where(way > 0.0, high.max(axis=0) - own_low.min(axis=0), own_high.max(axis=0) - low.min(axis=0))
    travel = float(np.min(np.maximum(clear, 0.0)[way != 0.0] / np.abs(way[way != 0.0])))
    margin = 0.01 * float(np.linalg.norm(own_high.max(axis=0) - own_low.min(axis=0)))
    return free_way(rest, moving, way, travel + margin, None if aside is None else after)


def _half_way(course: _Course) -> Array:
    """(3,) m: a displacement along a course, between where its parts have left what guides them and where they are
    stopped."""
    start = course.end.left if course.end.left < course.end.travel else 0.0
    return np.asarray(0.5 * (start + course.end.travel) * course.direction)


def _not_followed(name: str, course: _Course) -> Answer:
    return undecided(
        f"whether '{name}' can leave along {direction(course.direction)} is not known: {course.end.reason}",
        "List the direction if it may leave there, or remove what keeps it from being followed.",
    )


def _goes_far(evidence: Evidence, group: _Group, course: _Course) -> bool:
    """Whether something moves farther than its clearance before it is stopped."""
    meshes = [part.mesh for part in evidence.assembly.parts if part.mesh is not None and part.name in group.parts]
    return course.end.travel > CLEARANCE * max(mesh.diagonal for mesh in meshes)


def _slides_along(group: _Group, way: Array) -> bool:
    """Whether a group keeps its contact along a direction."""
    return bool(group.along) and _within(way, np.array(group.along))


def _aside(evidence: Evidence, course: _Course) -> Array | None:
    """A direction across a course in which it is free before it is stopped; None where none was found."""
    after = _half_way(course)
    for way in _across(evidence, sorted(course.parts), course.direction):
        if evidence.way_out(sorted(course.parts), way, after).status == "free":
            return way
    return None


def _across(evidence: Evidence, parts: Sequence[str], along: Array) -> list[Array]:
    """Unit directions across a direction: along and across flat faces of the parts, or all round where they have
    none."""
    out: list[Array] = []
    for normal in evidence.face_normals(parts):
        flat = normal - (normal @ along) * along
        if float(np.linalg.norm(flat)) > SAME_DIRECTION:
            first = flat / np.linalg.norm(flat)
            second = cross(along, first)
            out += [w for w in (first, -first, second, -second) if not _listed(w, np.array(out).reshape(-1, 3))]
    if not out:
        first, second = perpendicular(along)
        out = [first, second, -first, -second]
    return out


def _on_its_way(evidence: Evidence, name: str, course: _Course) -> Answer:
    end = course.end
    return undecided(
        f"'{name}' moves {length(end.travel, evidence.units, 3)} along {direction(course.direction)} before "
        f"{quoted(end.by)} stops it; whether it gets out from there another way is not followed",
        "Bring what stops it nearer, or list the direction if it may leave there.",
    )


def _courses(evidence: Evidence, group: _Group, listed: Array, every: Sequence[_Group]) -> Iterator[_Course]:
    """What becomes of a group along the directions of its cone that are not listed."""
    for sought in _directions(_with_faces(evidence, group), listed):
        parts, pushed = set(group.parts), 0
        end = evidence.way_out(sorted(parts), sought)
        while end.status == "stopped" and pushed < MOST_PUSHED:
            more = [g for g in every if g.parts & {*end.by} and _listed(sought, np.array(g.ways)) and g.parts - parts]
            if not more:
                break
            parts |= min(more, key=lambda g: len(g.parts)).parts
            pushed += 1
            end = evidence.way_out(sorted(parts), sought)
        yield _Course(sought, frozenset(parts), end)


def _with_faces(evidence: Evidence, group: _Group) -> _Group:
    """A group that slides in a plane or in space, along its own flat faces in place of any axes."""
    if group.line or not group.along:
        return group
    faces = [n for n in evidence.face_normals(sorted(group.parts)) if _slides_along(group, n)]
    if len(faces) < len(group.along) // 2:
        return group
    along = tuple(way for face in faces for way in (face, -face))
    others = tuple(way for way in group.ways if not _slides_along(group, way))
    return replace(group, ways=others + along, along=along)


def _directions(group: _Group, listed: Array) -> list[Array]:
    """Unit directions of the cone: those that it is given by, and sums of as many of them as it has dimensions, without
    what is listed."""
    out: list[Array] = []
    dimensions = 1 if group.line else int(np.linalg.matrix_rank(np.array(group.ways), SINE))
    for count in dict.fromkeys((1, dimensions)):
        for chosen in combinations(range(len(group.ways)), count):
            total = np.sum([group.ways[k] for k in chosen], axis=0)
            size = float(np.linalg.norm(total))
            if size < SINGLE:
                continue
            way = total / size
            if not _allowed(way, listed) and not _listed(way, np.array(out).reshape(-1, 3)):
                out.append(way)
    return out[:MOST_DIRECTIONS]


def _groups(evidence: Evidence) -> list[_Group]:
    """All that can leave as far as contact says, each with the directions in which it opens contact or slides."""
    found: dict[tuple[str, ...], list[Separation]] = {}
    for item in (*evidence.kinematics.separations, *evidence.kinematics.slides):
        found.setdefault(item.bodies, []).append(item)
    out = []
    for members, items in sorted(found.items()):
        ways = [way for item in items for way in item.releases if way.kind == "slide"]
        along = tuple(way.direction for item in items if not item.contacts for way in item.releases)
        line = len(ways) < 2 or (len(ways) == len(along) == 2)
        broken = {name for item in items for name in item.contacts}
        joints = [j for j in evidence.kinematics.joints if j.name in broken and j.point is not None]
        out.append(
            _Group(
                members, frozenset(part for member in members for part in _parts(evidence, member)),
                tuple(way.direction for way in ways), line and all(way.extreme for way in ways), along,
                joints[0].point if joints else None,
            )
        )  # fmt: skip
    return out


def _untouched(body: Body) -> _Group:
    """A body that touches nothing, and goes anywhere."""
    ways = [np.array(way, dtype=np.float64) for way in product((-1, 0, 1), repeat=3) if sum(map(abs, way)) == 1]
    return _Group((body.name,), frozenset(body.parts), tuple(ways), False, tuple(ways), None)


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


def _allowed(way: Array, listed: Array) -> bool:
    """Whether a direction is listed, or between listed ones."""
    from scipy.optimize import nnls

    return bool(len(listed) and nnls(listed.T, way)[1] < SINE)


def _slides(kinematics: Kinematics, body: Body, groups: Sequence[_Group], listed: Array) -> Answer | None:
    """Slides that keep contact while other bodies move too: without an end they lead out of it."""
    joints = [joint for joint in kinematics.joints if body.name in joint.bodies]
    index = [b.name for b in kinematics.bodies].index(body.name)
    alone = [np.array(group.along) for group in groups if group.along]
    open_: Answer | None = None
    for line in _pure_slides(kinematics.mobility.freedoms[:, index, :]):
        if any(_within(line, ways) for ways in alone):
            continue  # the meshes have said where that ends
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


def _within(line: Array, ways: Array) -> bool:
    """Whether a unit line (3,) lies in what directions (k, 3) span."""
    inside = np.linalg.lstsq(ways.T, line, rcond=None)[0] @ ways
    return float(np.linalg.norm(inside)) > SAME_DIRECTION


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
