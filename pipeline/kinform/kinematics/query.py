"""Answers whether a freedom is there: between two bodies, and in the whole assembly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.screws import Frame, rotation, rows, scaled, span, translation
from kinform.model.contacts import Patch
from kinform.model.design import Design
from kinform.model.kinematics import Joint

__all__ = ["QueryAnswer", "QueryBlocker", "query"]

Array = NDArray[np.float64]

THERE = 1e-3
"""A unit twist is there when less than this of it lies outside the freedoms (scaled by the size)."""


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


def query(
    design: Design, a: str, b: str, *, turn: tuple[Array, Array] | None = None, slide: Array | None = None
) -> QueryAnswer:
    """Whether b can turn about (axis, point m) or slide along a direction, relative to a.

    `a`, `b`: parts, groups or bodies. Raises KeyError for unknown names, ValueError unless exactly
    one of turn and slide is given with a direction that is not zero.
    """
    assert design.kinematics is not None
    if (turn is None) == (slide is None):
        raise ValueError("give either a turn or a slide")
    direction = np.asarray(turn[0] if turn is not None else slide, dtype=float)
    if not np.linalg.norm(direction) > 0.0:
        raise ValueError("the direction is zero")
    direction = direction / np.linalg.norm(direction)
    first, second = (_body(design, name) for name in (a, b))
    what = "turn" if turn is not None else "slide"
    if first == second:
        text = f"{a} and {b} are one body: no {what} between them"
        return QueryAnswer((first, second), False, None, 1.0, (), text)
    joint = next((j for j in design.kinematics.joints if set(j.bodies) == {first, second}), None)
    patches = _patches(design, first, second)
    points = [p.points for _, p in patches] if patches else [np.zeros((1, 3))]
    frame = Frame.of(np.concatenate([*points, turn[1][None]] if turn is not None else points))
    twist = rotation(direction, np.asarray(turn[1]), frame) if turn is not None else translation(direction)
    in_pair, residual = None, 1.0
    if joint is not None:
        residual = _outside(twist, joint.twists, frame)
        in_pair = residual < THERE
    outside = _in_assembly(design, first, second, twist, frame)
    in_all = outside < THERE
    left_out = {blocker.patch for blocker in joint.blockers} if joint is not None else set()
    blockers = _blockers([(k, p) for k, p in patches if in_pair is False or k in left_out], twist, frame)
    text = _sentence(a, b, what, in_pair, in_all and not blockers, blockers) + _doubt(design, joint)
    if blockers:
        in_pair = in_all = False
    return QueryAnswer(
        (first, second), in_pair, in_all, residual if joint is not None else outside, blockers, text
    )  # fmt: skip


def _body(design: Design, name: str) -> str:
    assert design.kinematics is not None
    if any(body.name == name for body in design.kinematics.bodies):
        return name
    try:
        part = design.assembly.parts_of(name)[0]
    except KeyError:
        known = sorted({*(b.name for b in design.kinematics.bodies), *(p.name for p in design.assembly.parts)})
        raise KeyError(f"no part, group or body {name!r}; there are: {', '.join(known)}") from None
    return design.kinematics.body_of(part).name


def _patches(design: Design, first: str, second: str) -> list[tuple[int, Patch]]:
    assert design.kinematics is not None
    if design.contacts is None:
        return []
    of_part = {p: b.name for b in design.kinematics.bodies for p in b.parts}
    return [(k, p) for k, p in enumerate(design.contacts.patches) if {of_part[n] for n in p.parts} == {first, second}]


def _outside(twist: Array, space: Array, frame: Frame) -> float:
    """Norm of the part of a unit twist outside the span of the (f, 6) twists."""
    basis = span(scaled(space.T, frame)) if len(space) else np.zeros((6, 0))
    return float(np.linalg.norm(twist - basis @ (basis.T @ twist)))


def _in_assembly(design: Design, first: str, second: str, twist: Array, frame: Frame) -> float:
    assert design.kinematics is not None
    index = {str(body.name): k for k, body in enumerate(design.kinematics.bodies)}
    freedoms = design.kinematics.mobility.freedoms
    relative = freedoms[:, index[second]] - freedoms[:, index[first]]
    size = np.linalg.norm(relative, axis=1) if len(relative) else np.zeros(0)
    return _outside(twist, relative[size > 1e-9], frame)


def _blockers(patches: list[tuple[int, Patch]], twist: Array, frame: Frame) -> tuple[QueryBlocker, ...]:
    out = []
    for k, patch in patches:
        speed = rows(patch.points, patch.normals, frame) @ twist
        arms = (patch.points - frame.centre) / frame.length
        motion = np.linalg.norm(twist[3:] + np.cross(twist[:3], arms), axis=1)
        if np.sqrt((speed**2).mean()) > 0.02 * max(np.sqrt((motion**2).mean()), 1e-12):
            out.append(QueryBlocker(patch.parts, k, patch.points.mean(axis=0), patch.area, patch.kind))
    return tuple(sorted(out, key=lambda q: (-q.area, q.patch)))


def _sentence(a: str, b: str, what: str, in_pair: bool | None, in_all: bool, blockers: tuple[QueryBlocker, ...]) -> str:
    where = f"{len(blockers)} {'patch' if len(blockers) == 1 else 'patches'}"
    head = {
        None: f"{a} and {b} do not touch",
        True: f"their contact leaves the {what} free" + (f" but for {where}, where it is blocked" if blockers else ""),
        False: f"their contact blocks the {what} at {where}",
    }[in_pair]
    return f"{head}; in the whole assembly it is {'free' if in_all else 'not free'}"


def _doubt(design: Design, joint: Joint | None) -> str:
    """What the answer counts on and is not certain, as an addition to the sentence."""
    assert design.kinematics is not None
    uncertain = design.kinematics.mobility.uncertain
    if joint is not None:
        return f"; their joint is ambiguous: {joint.reason}" if joint.status == "ambiguous" else ""
    return f"; this counts on joints that are not certain: {', '.join(uncertain)}" if uncertain else ""
