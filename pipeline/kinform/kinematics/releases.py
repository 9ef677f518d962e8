"""Contact-breaking motion of every pair: is the second body held, and if not, how does it leave the first?

Rows come from the assembly's J, which is consistent with the snapped freedoms; those of patches that block
count too. Joints that somebody stated, or that an axis suggested by rims made, are not decided by contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.cone import (
    FREE,
    HELD,
    extreme_rays,
    grams,
    held_for_certain,
    opening,
    reduced,
    unit_rows,
    unit_rows_of,
)
from kinform.kinematics.constraints import extreme_samples
from kinform.kinematics.questions import Answers, ask
from kinform.kinematics.screws import Frame, cross, twist_at_origin
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Joint, Release
from kinform.model.names import BodyName, PartName

__all__ = [
    "MOST",
    "Cone",
    "ContactRows",
    "Leaving",
    "certainly_held",
    "cone_of",
    "direction_words",
    "pair_cones",
    "released",
    "stated",
    "with_releases",
]

Array = NDArray[np.float64]

Members = Sequence[tuple[int, bool]]
"""Patches by index, each turned when its part a belongs to the second body."""

MOST = 12
"""Extreme directions up to which each is told."""
STEPS = 200
SAME = 1e-3
"""Two unit directions that differ by less are one; a screw with less pitch (over the size) is a turn."""


@dataclass(frozen=True, eq=False)
class Cone:
    """What contact allows the second body relative to the first, twists scaled in `frame`."""

    fixed: Array
    """(k, 6) orthonormal: directions that single patches hold both ways, as a shaft in its bore does."""
    rows: Array
    """(n, 6) unit: what the other patches allow one way; perpendicular to `fixed`."""
    frame: Frame

    @property
    def preserved(self) -> Array:
        """(6, f) orthonormal: contact-preserving motion."""
        moved = np.hstack([reduced(self.rows)[0], self.fixed.T])
        return np.linalg.svd(moved, full_matrices=True)[0][:, moved.shape[1] :] if moved.shape[1] else np.eye(6)


@dataclass(frozen=True, eq=False)
class Leaving:
    """What the cone of a pair says; fields as of Joint."""

    held: bool | None
    releases: tuple[Release, ...] = ()
    extremes: int | None = None
    held_reason: str = ""


class ContactRows:
    """Rows of patches: of the assembled J where they are in it, else of the patch itself."""

    def __init__(self, matrix: ConstraintMatrix, bodies: Sequence[Body], patches: Sequence[Patch]):
        self._matrix, self._patches = matrix, patches
        self._body = {part: k for k, body in enumerate(bodies) for part in body.parts}
        self._parts = {body.name: frozenset(body.parts) for body in bodies}
        self._cones: dict[tuple[tuple[int, bool], ...], Cone | None] = {}
        self._held: frozenset[int] | None = None
        order = np.argsort(matrix.patch, kind="stable")
        owner = matrix.patch[order]
        self._bounds = np.searchsorted(owner, np.arange(len(patches) + 1)).tolist()
        start = np.cumsum([0, *(len(patch.points) for patch in patches)])[:-1]
        every = np.concatenate([np.zeros((0, 3)), *(patch.points for patch in patches)])
        ahead = np.array([self._body[patch.parts[0]] < self._body[patch.parts[1]] for patch in patches], np.bool_)
        blocks = matrix.data.reshape(-1, 12)[order]
        rows = np.where(ahead[owner, None], blocks[:, 6:], blocks[:, :6])
        self._points = every[start[owner] + matrix.sample[order]] if len(owner) else every[:0]
        self._normals, self._moments = rows[:, 3:], rows[:, :3] * matrix.length

    def parts_of(self, body: BodyName) -> frozenset[PartName]:
        """The parts of a body."""
        return self._parts[body]

    def cone(self, members: Members) -> Cone | None:
        """The cone of patches given as (index, turned): turned when part a belongs to the second body."""
        return self.cones([members])[0]

    def cones(self, pairs: Sequence[Members]) -> list[Cone | None]:
        """The cones of several pairs, which take little longer than one."""
        keys = [tuple(members) for members in pairs]
        new = [key for key in dict.fromkeys(keys) if key not in self._cones]
        pieces = {key: [self.samples(k, turned=turned) for k, turned in key] for key in new}
        some = [key for key in new if any(len(points) for points, _, _ in pieces[key])]
        self._cones |= dict.fromkeys(new)
        if some:
            self._cones |= dict(zip(some, self._found(some, [pieces[key] for key in some]), strict=True))
        return [self._cones[key] for key in keys]

    def _found(self, keys: Sequence[Members], pieces: Sequence[Sequence[tuple[Array, Array, Array]]]) -> list[Cone]:
        """The cones of pairs with samples."""
        points, normals, moments = (np.concatenate([one[k] for own in pieces for one in own]) for k in range(3))
        counts = np.array([sum(len(one[0]) for one in own) for own in pieces])
        owner = np.repeat(np.arange(len(keys)), counts)
        frames = _frames(points, counts)
        rows = self._rows(normals, moments, frames, owner)
        alone = [self._two_way(k) for key in keys for k, _ in key]
        two = np.repeat(np.array(alone, np.bool_), [len(one[0]) for own in pieces for one in own])
        rows, group = unit_rows_of(rows, 2 * owner + ~two)
        of_both, of_one = group % 2 == 0, group % 2 == 1
        fixed = _opposed(rows[of_both], group[of_both] // 2, len(keys))
        across = np.array([np.eye(6) - own.T @ own for own in fixed])
        rows, owner = rows[of_one], group[of_one] // 2
        rows, owner = unit_rows_of(np.einsum("ni,nij->nj", rows, across[owner]), owner)
        parts = np.split(rows, np.cumsum(np.bincount(owner, minlength=len(keys)))[:-1])
        return [Cone(*found) for found in zip(fixed, parts, frames, strict=True)]

    def _rows(self, normals: Array, moments: Array, frames: Sequence[Frame], owner: NDArray[np.int64]) -> Array:
        """Rows (n, 6) of normals and moments (n, 3), each against twists scaled in the frame of its owner."""
        offset = np.array([self._matrix.centre - frame.centre for frame in frames])
        length = np.array([frame.length for frame in frames])
        moved = moments + cross(offset[owner], normals)
        return np.concatenate([moved / length[owner, None], normals], axis=1)

    def rows(self, k: int, frame: Frame, *, turned: bool) -> Array:
        """Rows (n, 6) of the extreme samples of one patch, against twists scaled in `frame`."""
        _, normals, moments = self.samples(k, turned=turned)
        out = np.empty((len(normals), 6))
        out[:, :3] = (moments + cross(self._matrix.centre - frame.centre, normals)) / frame.length
        out[:, 3:] = normals
        return out

    def _two_way(self, k: int) -> bool:
        """Does this patch alone hold whatever it does not let slide?"""
        if self._held is None:
            # a plane has one normal, and holds nothing both ways
            curved = [k for k, p in enumerate(self._patches) if p.kind != "plane" and len(p.points) > 1]
            self._held = frozenset(np.array(curved, dtype=int)[self._hold(curved)].tolist()) if curved else frozenset()
        return k in self._held

    def _hold(self, curved: Sequence[int]) -> NDArray[np.bool_]:
        """Of each of these patches, whether it is proven to hold what it touches."""
        counts = np.array([len(self._patches[k].points) for k in curved])
        frames = _frames(np.concatenate([self._patches[k].points for k in curved]), counts)
        pieces = [self.samples(k, turned=False) for k in curved]
        owner = np.repeat(np.arange(len(curved)), [len(points) for points, _, _ in pieces])
        normals, moments = (np.concatenate([one[k] for one in pieces]) for k in (1, 2))
        rows, owner = unit_rows_of(self._rows(normals, moments, frames, owner), owner)
        return held_for_certain(np.split(rows, np.cumsum(np.bincount(owner, minlength=len(curved)))[:-1]))

    def samples(self, k: int, *, turned: bool) -> tuple[Array, Array, Array]:
        """Points, normals and moments (m) about the centre of J, of the extreme samples of one patch."""
        sign = -1.0 if turned else 1.0
        own = slice(self._bounds[k], self._bounds[k + 1])
        if own.start < own.stop:
            return self._points[own], sign * self._normals[own], sign * self._moments[own]
        patch = self._patches[k]
        samples = extreme_samples(patch)
        points, normals = patch.points[samples], sign * patch.normals[samples]
        return points, normals, cross(points - self._matrix.centre, normals)


def pair_cones(rows: ContactRows, joints: Sequence[Joint], patches: Sequence[Patch]) -> list[Cone | None]:
    """The rows of each joint's patches and blockers; None for joints that contact does not decide."""
    decided = [k for k, joint in enumerate(joints) if not stated(joint)]
    members: list[Members] = []
    for k in decided:
        own = sorted({*joints[k].patches, *(blocker.patch for blocker in joints[k].blockers)})
        first = rows.parts_of(joints[k].bodies[0])
        members.append([(n, patches[n].parts[0] not in first) for n in own])
    found = dict(zip(decided, rows.cones(members), strict=True))
    return [found.get(k) for k in range(len(joints))]


def _frames(points: Array, counts: NDArray[np.int64]) -> list[Frame]:
    """The frames of groups of points (n, 3), one group after the other and none of them empty."""
    start = np.cumsum(counts) - counts
    low, high = np.minimum.reduceat(points, start), np.maximum.reduceat(points, start)
    half = (0.5 * np.linalg.norm(high - low, axis=1)).tolist()
    return [Frame(centre, size or 1.0) for centre, size in zip(0.5 * (low + high), half, strict=True)]


def _opposed(rows: Array, group: NDArray[np.int64], count: int) -> list[Array]:
    """(k, 6) orthonormal directions that the unit rows (n, 6) of each group, ascending, oppose."""
    out = [np.zeros((0, 6))] * count
    counts = np.bincount(group, minlength=count)
    some = np.flatnonzero(counts)
    if len(some):
        values, vectors = np.linalg.eigh(grams(rows, np.ones(len(rows)), counts[some]))
        moved = values > FREE**2 * counts[some, None]
        for k, chosen, own in zip(some.tolist(), moved, vectors, strict=True):
            out[k] = own[:, chosen].T
    return out


def stated(joint: Joint) -> bool:
    """Is the joint what somebody stated, or what rims suggested, rather than what contact leaves?"""
    return not joint.patches or bool({"rim", "bolt circle", "assumption", "function"}.intersection(joint.evidence))


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
