"""How pairs of bodies come apart: is the second body held by contact, and if not, how does it leave the first?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.screws import Frame, twist_at_origin
from kinform.foundation.algebra.vectors import cross
from kinform.kinematics.pair.answer import Answers, ask
from kinform.kinematics.separation.cone import (
    FREE,
    HELD,
    extreme_rays,
    held_for_certain,
    opening,
    reduced,
    unit_rows,
)
from kinform.kinematics.separation.contact_rows import Cone
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Release

__all__ = [
    "MOST",
    "Leaving",
    "certainly_held",
    "cone_of",
    "direction_words",
    "released",
    "with_releases",
]


MOST = 12
"""Extreme directions up to which each is told."""
STEPS = 200
SAME = 1e-3
"""Two unit directions that differ by less are one; a screw with less pitch (over the size) is a turn."""


@dataclass(frozen=True, eq=False)
class Leaving:
    """What the cone of a pair says; fields as of Joint."""

    held: bool | None
    releases: tuple[Release, ...] = ()
    extremes: int | None = None
    held_reason: str = ""


def with_releases(
    joints: Sequence[Joint], cones: Sequence[Cone | None], answers: Answers | None = None
) -> tuple[Joint, ...]:
    """The joints with whether contact holds them, and how they come apart."""
    known = [k for k, cone in enumerate(cones) if cone is not None]
    certain = dict(zip(known, certainly_held([cone for cone in cones if cone is not None]), strict=True))
    out = []
    for k, joint in enumerate(joints):
        cone = cones[k]
        if cone is None:
            out.append(replace(joint, held_reason="contact does not decide this joint"))
        elif certain[k]:
            out.append(replace(joint, held=True))
        else:
            out.append(replace(joint, **vars(ask(answers, "leaving", (cone,), partial(cone_of, cone)))))
    return tuple(out)


def certainly_held(cones: Sequence[Cone]) -> NDArray[np.bool_]:
    """Whether it is proven that nothing leaves."""
    nothing_left = np.array([not len(cone.rows) for cone in cones], dtype=np.bool_)
    return np.asarray(held_for_certain([cone.rows for cone in cones]) | nothing_left)


def cone_of(cone: Cone, *, turns: bool = True) -> Leaving:
    """Whether and how a pair that is not certainly held comes apart; without `turns` only slides, where there are."""
    slides, many = _slides(cone)
    if not len(slides):
        lp = opening(cone.rows)
        if lp.held:
            return Leaving(held=True)
        if lp.held is None:
            reason = (
                f"contact opens at {lp.speed:.2g} of the motion: between none (< {FREE:g}) and certain (> {HELD:g})"
            )
            return Leaving(None, held_reason=reason)
    rays = extreme_rays(cone.rows) if turns else None
    found = [released(np.concatenate([np.zeros(3), d]), cone.frame, extreme=not many) for d in slides]
    if rays is not None and len(rays) <= MOST:
        others = [ray for ray in rays if not _slides_off(ray, cone, slides)]
        found += _ordered([released(ray, cone.frame) for ray in others])
    elif not found:
        found = [released(lp.motion, cone.frame, extreme=False)]
    return Leaving(held=False, releases=tuple(found), extremes=None if rays is None else len(rays))


def _slides(cone: Cone) -> tuple[Array, bool]:
    """Unit directions (k, 3) in which it leaves without turning: the extreme ones, or, where those are many, the
    one in their middle (and True)."""
    straight = np.eye(3)
    if len(cone.fixed):
        _, values, right = np.linalg.svd(cone.fixed[:, 3:], full_matrices=True)
        straight = right[int(np.count_nonzero(values > SAME)) :].T
    normals = unit_rows(cone.rows[:, 3:] @ straight)
    none = np.zeros((0, 3))
    if not len(normals):
        return none, False
    rays = extreme_rays(normals)
    if rays is None:
        rays = _middle(normals)
        return rays @ straight.T, True
    # pure slides must break contact in fact, not by rounding
    rays = rays[(rays @ normals.T).max(axis=1, initial=0.0) > HELD] if len(rays) else none
    if not len(rays):
        return none, False
    rays = _distinct(rays @ straight.T)
    if len(rays) > MOST:
        middle = rays.sum(axis=0)
        return (middle / np.linalg.norm(middle))[None], True
    return rays[np.lexsort(np.round(rays, 6).T)[::-1]], False


def _middle(normals: Array) -> Array:
    """The direction (1, t) farthest inside a cone of very many extreme directions; (0, t) where it has no inside."""
    mean = normals.mean(axis=0)
    for _ in range(STEPS):
        speed = normals @ mean
        worst = int(speed.argmin())
        if speed[worst] > HELD * float(np.linalg.norm(mean)):
            return np.asarray(mean / np.linalg.norm(mean))[None]
        mean = mean + normals[worst] * (0.1 - speed[worst])
    return np.zeros((0, normals.shape[1]))


def _distinct(rays: Array) -> Array:
    kept: list[Array] = []
    for ray in rays:
        if all(np.linalg.norm(ray - other) > SAME for other in kept):
            kept.append(ray)
    return np.array(kept)


def _slides_off(ray: Array, cone: Cone, slides: Array) -> bool:
    """Is the ray one of the slides already told, but for contact-preserving motion?"""
    basis, _ = reduced(cone.rows)
    for slide in slides:
        shadow = basis @ (basis.T @ np.concatenate([np.zeros(3), slide]))
        size = float(np.linalg.norm(shadow))
        if size > SAME and np.linalg.norm(shadow / size - ray) < SAME:
            return True
    return False


def _ordered(found: list[Release]) -> list[Release]:
    return sorted(found, key=lambda r: (r.kind != "slide", r.kind != "turn", tuple(-np.round(r.twist, 6))))


def released(ray: Array, frame: Frame, *, extreme: bool = True) -> Release:
    """A scaled twist (6,) as a release: unit slide, turn or screw about a line, in words."""
    omega, velocity = ray[:3] / frame.length, ray[3:]
    turning = float(np.linalg.norm(ray[:3]))
    if turning < SAME * float(np.linalg.norm(ray)):
        direction = velocity / np.linalg.norm(velocity)
        twist = np.concatenate([np.zeros(3), direction])
        return Release("slide", twist, direction, None, extreme, f"lift off along {direction_words(direction)}")
    rate = float(np.linalg.norm(omega))
    direction = omega / rate
    lead = float(direction @ velocity) / rate
    point = frame.centre + cross(omega, velocity) / rate**2
    twist = (twist_at_origin(ray[:, None], frame) / rate).ravel()
    about = direction_words(direction)
    if abs(lead) < SAME * frame.length:
        return Release("turn", twist, direction, point, extreme, f"tip about {about}")
    sense = "along" if lead > 0.0 else "against"
    return Release("screw", twist, direction, point, extreme, f"turn about {about} while sliding {sense} it")


def direction_words(direction: Array) -> str:
    """A signed direction: "+z", "-x", or its components."""
    size = np.abs(direction)
    axis = int(size.argmax())
    if size[axis] > 1.0 - 0.5 * SAME**2:
        return f"{'+' if direction[axis] > 0.0 else '-'}{'xyz'[axis]}"
    return "(" + ", ".join(f"{x:.3g}" for x in np.where(size < 5e-4, 0.0, direction)) + ")"
