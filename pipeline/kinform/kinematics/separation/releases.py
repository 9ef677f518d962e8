"""How pairs of bodies come apart: is the second body held by contact, and if not, how does it leave the first?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, twist_at_origin
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.records import altered
from kinform.frozen import dataclass
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.screws.wording import direction_words
from kinform.kinematics.separation.cone import extreme_rays, held_for_certain, opening, unit_rows
from kinform.kinematics.separation.constants import CONE_FREE, CONE_HELD
from kinform.kinematics.separation.contact_rows import Cone
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Joint, Release

MOST_RELEASES = 12
"""Extreme directions up to which each is told. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Leaving:
    """What the cone of a pair says; fields as of Joint."""

    held: bool | None
    releases: tuple[Release, ...] = ()
    extremes: int | None = None
    held_reason: str = ""


def with_releases(joints: Sequence[Joint], cones: Sequence[Cone | None]) -> tuple[Joint, ...]:
    """The joints with whether contact holds them, and how they come apart."""
    decided = [cone for cone in cones if cone is not None]
    held = certainly_held(decided)
    certain = iter(held)
    leaving = iter(leaving_of_each([cone for cone, sure in zip(decided, held, strict=True) if not sure]))
    out = []
    for joint, cone in zip(joints, cones, strict=True):
        if cone is None:
            out.append(altered(joint, held_reason="contact does not decide this joint"))
        elif next(certain):
            out.append(altered(joint, held=True))
        else:
            out.append(altered(joint, **vars(next(leaving))))
    return tuple(out)


def certainly_held(cones: Sequence[Cone]) -> Flags:
    """Whether it is proven that nothing leaves."""
    nothing_left = np.array([not len(cone.rows) for cone in cones], dtype=np.bool_)
    return np.asarray(held_for_certain([cone.rows for cone in cones]) | nothing_left)


def leaving_of_each(cones: Sequence[Cone], *, turns: bool = True) -> list[Leaving]:
    """Whether and how pairs that are not certainly held come apart; without `turns` only slides, where there are."""
    return [_leaving_of(cone, straight, turns) for cone, straight in zip(cones, _straight(cones), strict=True)]


def _straight(cones: Sequence[Cone]) -> list[Array]:
    """(3, k) of each cone: orthonormal directions in which nothing that is held both ways hinders a slide."""
    out = [np.eye(3) for _ in cones]
    for count in {len(cone.fixed) for cone in cones} - {0}:
        members = [k for k, cone in enumerate(cones) if len(cone.fixed) == count]
        _, values, right = np.linalg.svd(np.array([cones[k].fixed[:, 3:] for k in members]), full_matrices=True)
        held = np.count_nonzero(values > SAME_DIRECTION, axis=1).tolist()
        for k, rank, directions in zip(members, held, right, strict=True):
            out[k] = directions[rank:].T
    return out


def _leaving_of(cone: Cone, straight: Array, turns: bool) -> Leaving:
    """Of one pair, whose slides are within the `straight` directions (3, k)."""
    slides, many = _slides(cone, straight)
    if not len(slides):
        lp = opening(cone.rows)
        if lp.held:
            return Leaving(held=True)
        if lp.held is None:
            bounds = f"between none (< {CONE_FREE:g}) and certain (> {CONE_HELD:g})"
            return Leaving(None, held_reason=f"contact opens at {lp.speed:.2g} of the motion: {bounds}")
    rays = extreme_rays(cone.rows, cone.opposed) if turns else None
    releases = [release_of(np.concatenate([np.zeros(3), d]), cone.frame, extreme=not many) for d in slides]
    if rays is not None and len(rays) <= MOST_RELEASES:
        others = [ray for ray in rays if not _slides_off(ray, cone, slides)]
        releases += sorted((release_of(ray, cone.frame) for ray in others), key=_order)
    elif not releases:
        releases = [release_of(lp.motion, cone.frame, extreme=False)]
    return Leaving(held=False, releases=tuple(releases), extremes=None if rays is None else len(rays))


def _slides(cone: Cone, straight: Array) -> tuple[Array, bool]:
    """Unit directions (k, 3) in which it leaves without turning: the extreme ones, or, where those are many, the
    one in their middle (and True).

    What patches hold both ways leaves `straight` directions only; among these the rows' normals make a cone.
    """
    normals = unit_rows(cone.rows[:, 3:] @ straight)
    none = np.zeros((0, 3))
    if not len(normals):
        return none, False
    rays = extreme_rays(normals)
    if rays is None:
        rays = _middle(normals)
        return rays @ straight.T, True
    # pure slides must break contact in fact, not by rounding
    rays = rays[(rays @ normals.T).max(axis=1, initial=0.0) > CONE_HELD] if len(rays) else none
    if not len(rays):
        return none, False
    rays = _distinct(rays @ straight.T) if len(rays) > 1 else rays @ straight.T
    if len(rays) > MOST_RELEASES:
        middle = rays.sum(axis=0)
        return (middle / norm(middle))[None], True
    return rays[np.lexsort(np.round(rays, 6).T)[::-1]] if len(rays) > 1 else rays, False


def _middle(normals: Array) -> Array:
    """The direction (1, t) farthest inside a cone of very many extreme directions; (0, t) where it has no inside."""
    mean = normals.mean(axis=0)
    # Steps in which a direction inside a cone of very many extreme directions is looked for. Chosen, not measured.
    for _ in range(200):
        speed = normals @ mean
        worst = int(speed.argmin())
        if speed[worst] > CONE_HELD * norm(mean):
            return np.asarray(mean / norm(mean))[None]
        # Speed that such a step gives to the worst row. Chosen, not measured.
        mean = mean + normals[worst] * (0.1 - speed[worst])
    return np.zeros((0, normals.shape[1]))


def _distinct(rays: Array) -> Array:
    kept: list[Array] = []
    for ray in rays:
        if all(norm(ray - other) > SAME_DIRECTION for other in kept):
            kept.append(ray)
    return np.array(kept)


def _slides_off(ray: Array, cone: Cone, slides: Array) -> bool:
    """Is the ray one of the slides already told, but for contact-preserving motion?"""
    basis = cone.opposed
    for slide in slides:
        shadow = basis @ (basis[3:].T @ slide)
        size = norm(shadow)
        if size > SAME_DIRECTION and norm(shadow / size - ray) < SAME_DIRECTION:
            return True
    return False


def _order(release: Release) -> tuple[bool, bool, tuple[float, ...]]:
    """Slides before turns before screws, and along +x first."""
    return release.kind != "slide", release.kind != "turn", tuple(-np.round(release.twist, 6))


def release_of(ray: Array, frame: Frame, *, extreme: bool = True) -> Release:
    """A twist (6,), scaled in `frame`, as a release: unit slide, turn or screw about a line, in words; `extreme`: it is
    no sum of other releases."""
    omega, velocity = ray[:3] / frame.length, ray[3:]
    turning = norm(ray[:3])
    if turning < SAME_DIRECTION * norm(ray):
        direction = velocity / norm(velocity)
        twist = np.concatenate([np.zeros(3), direction])
        return Release("slide", twist, direction, None, extreme, f"lift off along {direction_words(direction)}")
    rate = norm(omega)
    direction = omega / rate
    lead = float(direction @ velocity) / rate
    point = frame.centre + cross(omega, velocity) / rate**2
    twist = (twist_at_origin(ray[:, None], frame) / rate).ravel()
    about = direction_words(direction)
    if abs(lead) < SAME_DIRECTION * frame.length:
        return Release("turn", twist, direction, point, extreme, f"tip about {about}")
    sense = "along" if lead > 0.0 else "against"
    return Release("screw", twist, direction, point, extreme, f"turn about {about} while sliding {sense} it")
