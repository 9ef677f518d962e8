"""How pairs of bodies come apart: is the second body held by contact, and if not, how does it leave the first?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinform.foundation.algebra.screws import Frame, twist_at_origin
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.records import altered
from kinform.kinematics import constants
from kinform.kinematics.separation.cone import extreme_rays, held_for_certain, opening, unit_rows
from kinform.kinematics.separation.contact_rows import Cone
from kinform.kinematics.wording import direction_words
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import Joint, Release


@dataclass(frozen=True, eq=False)
class Leaving:
    """What the cone of a pair says; fields as of Joint."""

    held: bool | None
    releases: tuple[Release, ...] = ()
    extremes: int | None = None
    held_reason: str = ""


def with_releases(joints: Sequence[Joint], cones: Sequence[Cone | None]) -> tuple[Joint, ...]:
    """The joints with whether contact holds them, and how they come apart."""
    certain = iter(certainly_held([cone for cone in cones if cone is not None]))
    out = []
    for joint, cone in zip(joints, cones, strict=True):
        if cone is None:
            out.append(altered(joint, held_reason="contact does not decide this joint"))
        elif next(certain):
            out.append(altered(joint, held=True))
        else:
            out.append(altered(joint, **vars(leaving_of(cone))))
    return tuple(out)


def certainly_held(cones: Sequence[Cone]) -> Flags:
    """Whether it is proven that nothing leaves."""
    nothing_left = np.array([not len(cone.rows) for cone in cones], dtype=np.bool_)
    return np.asarray(held_for_certain([cone.rows for cone in cones]) | nothing_left)


def leaving_of(cone: Cone, *, turns: bool = True) -> Leaving:
    """Whether and how a pair that is not certainly held comes apart; without `turns` only slides, where there are."""
    slides, many = _slides(cone)
    if not len(slides):
        lp = opening(cone.rows)
        if lp.held:
            return Leaving(held=True)
        if lp.held is None:
            bounds = f"between none (< {constants.CONE_FREE:g}) and certain (> {constants.CONE_HELD:g})"
            return Leaving(None, held_reason=f"contact opens at {lp.speed:.2g} of the motion: {bounds}")
    rays = extreme_rays(cone.rows, cone.opposed) if turns else None
    releases = [release_of(np.concatenate([np.zeros(3), d]), cone.frame, extreme=not many) for d in slides]
    if rays is not None and len(rays) <= constants.MOST_RELEASES:
        others = [ray for ray in rays if not _slides_off(ray, cone, slides)]
        releases += sorted((release_of(ray, cone.frame) for ray in others), key=_order)
    elif not releases:
        releases = [release_of(lp.motion, cone.frame, extreme=False)]
    return Leaving(held=False, releases=tuple(releases), extremes=None if rays is None else len(rays))


def _slides(cone: Cone) -> tuple[Array, bool]:
    """Unit directions (k, 3) in which it leaves without turning: the extreme ones, or, where those are many, the
    one in their middle (and True).

    What patches hold both ways leaves `straight` directions only; among these the rows' normals make a cone.
    """
    straight = np.eye(3)
    if len(cone.fixed):
        _, values, right = np.linalg.svd(cone.fixed[:, 3:], full_matrices=True)
        straight = right[int(np.count_nonzero(values > constants.SAME_DIRECTION)) :].T
    normals = unit_rows(cone.rows[:, 3:] @ straight)
    none = np.zeros((0, 3))
    if not len(normals):
        return none, False
    rays = extreme_rays(normals)
    if rays is None:
        rays = _middle(normals)
        return rays @ straight.T, True
    # pure slides must break contact in fact, not by rounding
    rays = rays[(rays @ normals.T).max(axis=1, initial=0.0) > constants.CONE_HELD] if len(rays) else none
    if not len(rays):
        return none, False
    rays = _distinct(rays @ straight.T) if len(rays) > 1 else rays @ straight.T
    if len(rays) > constants.MOST_RELEASES:
        middle = rays.sum(axis=0)
        return (middle / norm(middle))[None], True
    return rays[np.lexsort(np.round(rays, 6).T)[::-1]] if len(rays) > 1 else rays, False


def _middle(normals: Array) -> Array:
    """The direction (1, t) farthest inside a cone of very many extreme directions; (0, t) where it has no inside."""
    mean = normals.mean(axis=0)
    for _ in range(constants.MIDDLE_STEPS):
        speed = normals @ mean
        worst = int(speed.argmin())
        if speed[worst] > constants.CONE_HELD * norm(mean):
            return np.asarray(mean / norm(mean))[None]
        mean = mean + normals[worst] * (constants.MIDDLE_STRIDE - speed[worst])
    return np.zeros((0, normals.shape[1]))


def _distinct(rays: Array) -> Array:
    kept: list[Array] = []
    for ray in rays:
        if all(norm(ray - other) > constants.SAME_DIRECTION for other in kept):
            kept.append(ray)
    return np.array(kept)


def _slides_off(ray: Array, cone: Cone, slides: Array) -> bool:
    """Is the ray one of the slides already told, but for contact-preserving motion?"""
    basis = cone.opposed
    for slide in slides:
        shadow = basis @ (basis[3:].T @ slide)
        size = norm(shadow)
        if size > constants.SAME_DIRECTION and norm(shadow / size - ray) < constants.SAME_DIRECTION:
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
    if turning < constants.SAME_DIRECTION * norm(ray):
        direction = velocity / norm(velocity)
        twist = np.concatenate([np.zeros(3), direction])
        return Release("slide", twist, direction, None, extreme, f"lift off along {direction_words(direction)}")
    rate = norm(omega)
    direction = omega / rate
    lead = float(direction @ velocity) / rate
    point = frame.centre + cross(omega, velocity) / rate**2
    twist = (twist_at_origin(ray[:, None], frame) / rate).ravel()
    about = direction_words(direction)
    if abs(lead) < constants.SAME_DIRECTION * frame.length:
        return Release("turn", twist, direction, point, extreme, f"tip about {about}")
    sense = "along" if lead > 0.0 else "against"
    return Release("screw", twist, direction, point, extreme, f"turn about {about} while sliding {sense} it")
