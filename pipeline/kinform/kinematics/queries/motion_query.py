"""Answers whether a freedom is there: between two bodies, and in the whole assembly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, rows, scaled, span
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.name_hints import did_you_mean
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.kinematics.mobility.named_freedoms import Motions
from kinform.kinematics.queries.design_view import DesignView
from kinform.kinematics.queries.disconnected import disconnected_bodies, disconnected_in_words
from kinform.kinematics.queries.joint_insight import patches_between
from kinform.kinematics.queries.motion_senses import MOTION_THERE, Attempt, attempt, pair_ways
from kinform.kinematics.screws.wording import direction_words
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, body_of_part


@dataclass(frozen=True, eq=False)
class QueryBlocker:
    """A contact patch that the motion would press into or lift off."""

    parts: tuple[str, str]
    patch: int
    place: Array
    """(3,) m, centroid."""
    area: float
    kind: str


@dataclass(frozen=True, eq=False)
class QueryAnswer:
    """Is the motion of b relative to a free? `free_in_pair` is None where the two do not touch;
    `free_in_assembly` is None where they are one body. What blocks a joint makes both False."""

    bodies: tuple[str, str]
    free_in_pair: bool | None
    free_in_assembly: bool | None
    residual: float
    """Share of the motion that the pair (or without contact the assembly) does not allow."""
    blocked_by: tuple[QueryBlocker, ...]
    text: str
    pair_ways: tuple[bool, bool] | None = None
    """Whether the pair's contact lets b move in the sense asked, and in the reverse; None where it does not say."""
    assembly_ways: tuple[bool | None, bool | None] = (None, None)
    """Likewise in the whole assembly, whose contacts may be broken too; None where it could not be decided."""
    assembly_blocked_by: tuple[QueryBlocker, ...] = ()
    """Without these contacts anywhere in the assembly the motion would be there, in the sense asked."""
    assembly_blocked_by_joints: tuple[str, ...] = ()
    """Joints that somebody stated, which would have to give too."""


def query(
    design: DesignView, a: str, b: str, *, turn: tuple[Array, Array] | None = None, slide: Array | None = None
) -> QueryAnswer:
    """Whether b can turn about (axis, point m) or slide along a direction, relative to a.

    `a`, `b`: parts, groups or bodies. Raises KeyError for unknown names, ValueError unless exactly
    one of turn and slide is given with a direction that is not zero.
    """
    assert design.kinematics is not None
    if (turn is None) == (slide is None):
        raise ValueError("give either a turn or a slide")
    direction = np.asarray(turn[0] if turn is not None else slide, dtype=float)
    if not norm(direction) > 0.0:
        raise ValueError("the direction is zero")
    direction = direction / norm(direction)
    if turn is None:
        return query_twist(design, a, b, np.concatenate([np.zeros(3), direction]), "slide")
    point = np.asarray(turn[1], dtype=float)
    return query_twist(design, a, b, np.concatenate([direction, cross(point, direction)]), "turn")


def query_twist(design: DesignView, a: str, b: str, motion: Array, what: str) -> QueryAnswer:
    """Whether b can move by the twist `motion` (ω; v at the world's origin) relative to a; `what` names it.

    Asked are the freedoms of the pair's joint, those of the whole assembly, what blocks the joint, and, where all this
    does not say yes, both senses of the motion against contacts that only push. Raises KeyError for unknown names.
    """
    kinematics = design.kinematics
    assert kinematics is not None
    first, second = (_body(design, name) for name in (a, b))
    if first == second:
        text = f"{a} and {b} are one body: no {what} between them"
        return QueryAnswer((first, second), False, None, 1.0, (), text, (False, False), (False, False))
    joint = next((j for j in kinematics.joints if set(j.bodies) == {first, second}), None)
    patches = [(k, patch) for k, patch, _ in patches_between(design, first, second)]
    points = [p.points for _, p in patches] if patches else [np.zeros((1, 3))]
    if motion[:3].any():
        points.append((cross(motion[:3], motion[3:]) / float(motion[:3] @ motion[:3]))[None])
    frame = Frame.of(np.concatenate(points))
    twist = scaled(motion[:, None], frame)[:, 0]
    twist = twist / norm(twist)
    in_pair, residual = None, 1.0
    if joint is not None:
        residual = _outside(twist, joint.twists, frame)
        in_pair = residual < MOTION_THERE
    outside = _in_assembly(design, first, second, twist, frame)
    left_out = set(joint.touching).difference(joint.patches) if joint is not None else set()
    blockers = _blockers([(k, p) for k, p in patches if in_pair is False or k in left_out], twist, frame)
    if blockers:
        in_pair = False if joint is not None else None
    every = design.contacts.patches if design.contacts is not None else ()
    ways = None
    if joint is not None:
        of_joint = motion if joint.bodies[0] == first else -motion
        ways = (True, True) if in_pair else pair_ways(kinematics, every, joint, of_joint)
    if outside < MOTION_THERE and not blockers and all(joint.status != "blocked" for joint in kinematics.joints):
        forward = backward = Attempt(True)
    else:
        forward, backward = (attempt(kinematics, every, first, second, s * motion, frame) for s in (1.0, -1.0))
    possible = (forward.possible, backward.possible)
    in_all = (outside < MOTION_THERE if None in possible else all(possible)) and not blockers
    culprits = tuple(_blocker(k, every[k]) for k in forward.patches)
    answer = QueryAnswer(
        (first, second), in_pair, in_all, residual if joint is not None else outside, blockers, "",
        ways, possible, culprits, forward.joints,
    )  # fmt: skip
    freed = residual < MOTION_THERE and joint is not None
    apart = f"{a} and {b} {_apart(design, first, second)}"
    text = _sentence(apart, b, what, motion, answer, freed=freed)
    return replace(answer, text=text + _doubt(design, joint, (first, second)))


def _body(design: DesignView, name: str) -> str:
    assert design.kinematics is not None
    if any(body.name == name for body in design.kinematics.bodies):
        return name
    try:
        part = design.assembly.parts_of(name)[0]
    except KeyError:
        groups = (group.name for group in design.assembly.groups)
        names = {*(b.name for b in design.kinematics.bodies), *(p.name for p in design.assembly.parts), *groups}
        known = did_you_mean(name, map(str, names), "the parts, groups and bodies")
        raise KeyError(f"no part, group or body {name!r}: {known}") from None
    return design.kinematics.body_of(part).name


def _outside(twist: Array, space: Array, frame: Frame) -> float:
    """Norm of the part of a unit twist outside the span of the (f, 6) twists."""
    basis = span(scaled(space.T, frame)) if len(space) else np.zeros((6, 0))
    return norm(twist - basis @ (basis.T @ twist))


def _in_assembly(design: DesignView, first: str, second: str, twist: Array, frame: Frame) -> float:
    assert design.kinematics is not None
    freedoms = design.kinematics.mobility.freedoms
    if len(freedoms) < design.kinematics.mobility.instantaneous:
        relative = Motions.of(design.kinematics).relative(first, second)
    else:
        node = {str(body.name): k for k, body in enumerate(design.kinematics.bodies)}
        relative = freedoms[:, node[second]] - freedoms[:, node[first]]
    size = np.linalg.norm(relative, axis=1) if len(relative) else np.zeros(0)
    return _outside(twist, relative[size > SOLVED], frame)


def _blockers(patches: list[tuple[int, Patch]], twist: Array, frame: Frame) -> tuple[QueryBlocker, ...]:
    out = []
    for k, patch in patches:
        speed = rows(patch.points, patch.normals, frame) @ twist
        arms = (patch.points - frame.centre) / frame.length
        motion = np.linalg.norm(twist[3:] + cross(twist[:3], arms), axis=1)
        # Share of a patch's speed along its normals from which on it is named as blocking. Chosen, not measured.
        if np.sqrt((speed**2).mean()) > 0.02 * max(np.sqrt((motion**2).mean()), ARITHMETIC):
            out.append(_blocker(k, patch))
    return tuple(sorted(out, key=lambda q: (-q.area, q.patch)))


def _blocker(k: int, patch: Patch) -> QueryBlocker:
    return QueryBlocker(patch.parts, k, patch.points.mean(axis=0), patch.area, patch.kind)


def _apart(design: DesignView, first: str, second: str) -> str:
    """What two bodies without contact do."""
    assert design.kinematics is not None
    of_part = body_of_part(design.kinematics.bodies)
    overlaps = design.contacts.interferences if design.contacts is not None else ()
    depth = max((one.depth for one in overlaps if {of_part[part] for part in one.parts} == {first, second}), default=0)
    return f"overlap by {1e3 * depth:.2g} mm where nothing mates" if depth > 0.0 else "do not touch"


def _sentence(apart: str, b: str, what: str, motion: Array, answer: QueryAnswer, *, freed: bool) -> str:
    """What contact does to the motion, and what is left of it in the assembly; `apart` is said where there is none,
    `freed`: the joint has it."""
    blockers = answer.blocked_by
    where = counted(len(blockers), "patch", "patches")
    if answer.free_in_pair is None:
        head = apart
    elif freed:
        head = f"their contact leaves the {what} free" + (f" but for {where}, where it is blocked" if blockers else "")
    else:
        head = f"their contact blocks the {what} at {where}"
    if answer.pair_ways in ((True, False), (False, True)):
        sense = _sense(what, motion, forward=answer.pair_ways[0])
        if freed:
            head += f", so that it goes one way only, in {sense}"
        else:
            head = f"their contact leaves the {what} free one way only: {b} leaves contact in {sense}"
    elif answer.pair_ways == (True, True) and not freed:
        head = f"their contact does not stop the {what} either way, but breaks"
    there, back = answer.assembly_ways
    if answer.free_in_assembly:
        tail = "free"
    elif there and back:
        tail = "not blocked, but breaks contact"
    elif there or back:
        tail = f"free one way only, in {_sense(what, motion, forward=bool(there))}"
    else:
        tail = "not free"
    return f"{head}; in the whole assembly it is {tail}"


def _sense(what: str, motion: Array, *, forward: bool) -> str:
    """The sense of a motion: "+z", or "+z" of the axis of a turn."""
    axis = motion[:3] if motion[:3].any() else motion[3:]
    axis = axis / norm(axis)
    words = direction_words(axis if forward else -axis)
    return words if what == "slide" else f"the sense of {words}"


def _doubt(design: DesignView, joint: Joint | None, bodies: tuple[str, str]) -> str:
    """What the answer about these bodies counts on and is not certain, as an addition to the sentence."""
    assert design.kinematics is not None
    uncertain = design.kinematics.mobility.uncertain
    if joint is not None:
        return f"; their joint is ambiguous: {joint.reason}" if joint.status == "ambiguous" else ""
    out = f"; this counts on joints that are not certain: {', '.join(uncertain)}" if uncertain else ""
    loose = disconnected_bodies(design.kinematics, design.contacts) if design.contacts is not None else ()
    asked = [one for one in loose if len({*bodies} & {*one.bodies}) == 1]
    return out + (f"; but {disconnected_in_words(asked)}" if asked else "")
