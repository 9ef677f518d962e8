"""The cone {V : R V ≥ 0} of motions that unilateral contacts allow: is it more than its null space, and how.

V is a scaled twist, R has a row for each extreme sample. The null space of R is the contact-preserving
motion; what else the cone holds breaks contact (Sinha, Gupta, Paredis, Khosla 2002). By Stiemke's
lemma there is nothing else exactly when some λ > 0 has Rᵀλ = 0. That certificate is looked for with
Newton's method on Σ exp(−R V), for all pairs at once; only where it is not found a linear program decides.
Extreme directions come from the double description method (Motzkin et al. 1953). This module knows no
bodies and no patches.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.rounding import SINGLE, TINY
from kinform.frozen import dataclass
from kinform.kinematics.separation.constants import CONE_FREE, CONE_HELD, HIGHS_FEASIBLE
from kinform.model.arrays import Array, Flags, Ints

LONGEST_STEP = 2.0
"""Change of an exponent that one Newton step may make at most. Rows weigh e² less or more after one, so that the
quadratic model still holds roughly."""
FAR_EXPONENT = 40.0
"""Exponent at which the sum has evidently no minimum. exp(-40) is below the rounding of 1."""
MOST_RAYS = 48
"""Rays at an intermediate step beyond which there are too many to list. Chosen, not measured."""


_MIX = np.array([0x2C1B3C6D, 0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D, 0x27D4EB2F, 0x165667B1, 0x5BD1E995], dtype=np.int64)
"""Odd factors by which rows that are not equal hardly ever sum up to the same."""


@dataclass(frozen=True, eq=False)
class Opening:
    """What the linear program says: `held` is None where rows open by more than rounding and less than a fact."""

    held: bool | None
    motion: Array
    """(6,) scaled twist that opens the contact most; zero where held."""
    speed: float
    """Of the row that opens fastest, for components of the motion up to 1."""


def unit_rows(rows: Array) -> Array:
    """The rows (n, 6) scaled to length 1, without those that say nothing and those that say the same twice."""
    return unit_rows_of(rows, np.zeros(len(rows), dtype=np.int64))[0]


def unit_rows_of(rows: Array, group: Ints) -> tuple[Array, Ints]:
    """As `unit_rows`, of rows (n, d) that each belong to a group (n,), and the groups of those that are left."""
    size = np.sqrt(np.einsum("ij,ij->i", rows, rows))
    # Length below which what is left of a unit row says nothing. Chosen, not measured.
    long = size > 1e-3
    if not long.all():
        rows, size, group = rows[long], size[long], group[long]
    rows = rows / size[:, None]
    if len(rows) < 2:
        return rows, group
    keys = np.empty((len(rows), rows.shape[1] + 1), dtype=np.int64)
    keys[:, 0], keys[:, 1:] = group, np.rint(rows / SINGLE)
    order = (keys @ _MIX[: keys.shape[1]]).argsort(kind="stable")
    ordered = keys[order]
    again = (ordered[1:] == ordered[:-1]).all(axis=1)
    if not again.any():
        return rows, group
    kept = np.ones(len(rows), dtype=np.bool_)
    kept[order[1:][again]] = False
    return rows[kept], group[kept]


def rows_beside(rows: Array, fixed: Array) -> Array:
    """Unit rows as they are seen by twists that the orthonormal rows `fixed` (k, 6) do not see."""
    return unit_rows(rows - (rows @ fixed.T) @ fixed) if len(fixed) else rows


def split_directions(rows: Array) -> tuple[Array, Array]:
    """Bases (d, c) of the directions that unit rows (n, d) oppose and (d, d − c) of those they preserve."""
    if not len(rows):
        return np.zeros((rows.shape[1], 0)), np.eye(rows.shape[1])
    values, vectors = np.linalg.eigh(rows.T @ rows)
    moved = values > CONE_FREE**2 * len(rows)
    return vectors[:, moved], vectors[:, ~moved]


def held_for_certain(pairs: Sequence[Array]) -> Flags:
    """For each pair of bodies with unit rows (n, d), d = 6: is there λ > 0 with Rᵀλ = 0, so that nothing can leave?

    True is proven. False says only that no such λ was primal.
    """
    held = np.zeros(len(pairs), dtype=bool)
    active = np.array([k for k, rows in enumerate(pairs) if len(rows) > 1], dtype=np.int64)
    if not len(active):
        return held
    rows = np.concatenate([pairs[k] for k in active])
    counts = np.array([len(pairs[k]) for k in active])
    system = grams(rows, np.ones(len(rows)), counts)
    values, vectors = np.linalg.eigh(system)
    loose = values < CONE_FREE**2 * counts[:, None]
    still = np.einsum("pik,pk,pjk->pij", vectors, loose.astype(float), vectors)
    size = rows.shape[1]
    at = np.zeros((len(active), size))
    # Newton steps; certificates are found within a few. Chosen, not measured.
    for step_number in range(25):
        exponent = np.einsum("ij,ij->i", rows, np.repeat(at, counts, axis=0))
        weight = np.exp(-np.clip(exponent, -FAR_EXPONENT, FAR_EXPONENT))
        start = np.concatenate([[0], np.cumsum(counts)[:-1]])
        pull = np.add.reduceat(weight[:, None] * rows, start, axis=0)
        pull -= np.einsum("pij,pj->pi", still, pull)
        system = grams(rows, weight, counts) if step_number else system
        scale = np.trace(system, axis1=1, axis2=2)[:, None, None]
        step = np.linalg.solve(system + scale * (still + 1e-15 * np.eye(size)), pull[:, :, None])[:, :, 0]
        change = np.einsum("ij,ij->i", rows, np.repeat(step, counts, axis=0))
        certificate = weight * (1.0 - change)
        # where all rows agree on a side the certificate cancels to rounding: it must keep some of its weight
        proven = np.minimum.reduceat(certificate, start) > SINGLE * np.maximum.reduceat(weight, start)
        held[active[proven]] = True
        longest = np.maximum.reduceat(np.abs(change), start)
        at = at + step * np.minimum(1.0, LONGEST_STEP / np.maximum(longest, TINY))[:, None]
        keep = ~proven & (np.maximum.reduceat(np.abs(exponent), start) < FAR_EXPONENT)
        if not keep.any():
            break
        chosen = np.repeat(keep, counts)
        rows, counts, active, at, still = rows[chosen], counts[keep], active[keep], at[keep], still[keep]
    return held


def nothing_opens(rows: Array, fixed: Array) -> bool:
    """Whether V with fixed V = 0 and R V ≥ 0 has R V = 0 for certain; rows (n, d) and (m, d). False says nothing.

    For programs whose components are up to LARGEST_TWIST and where what counts opens by a half: each tolerance is
    so small that neither rounding nor what HiGHS admits comes near that.
    """
    return nothing_opens_in_each([(rows, fixed)])[0]


def nothing_opens_in_each(programs: Sequence[tuple[Array, Array]]) -> list[bool]:
    """As `nothing_opens`, of several programs (rows, fixed)."""
    within = zip(programs, _free(programs), strict=True)
    inner = [_scaled(rows @ free.T) for (rows, _), free in within]
    out = [not len(of) for of in inner]
    for size in {of.shape[1] for of in inner if len(of)}:
        members = [k for k, of in enumerate(inner) if len(of) and of.shape[1] == size]
        values = np.linalg.eigvalsh([inner[k].T @ inner[k] for k in members]) / [[len(inner[k])] for k in members]
        unsure = np.any((values > HIGHS_FEASIBLE**2) & (values < CONE_FREE**2), axis=1)
        clear = [k for k, doubt in zip(members, unsure, strict=True) if not doubt]
        for k, held in zip(clear, held_for_certain([inner[k] for k in clear]), strict=True):
            out[k] = bool(held)
    return out


def _free(programs: Sequence[tuple[Array, Array]]) -> list[Array]:
    """(k, d) of each program (rows, fixed): orthonormal motions that nothing fixed hinders for certain."""
    out = [np.eye(rows.shape[1]) for rows, _ in programs]
    for shape in {fixed.shape for _, fixed in programs if len(fixed)}:
        members = [k for k, (_, fixed) in enumerate(programs) if fixed.shape == shape]
        _, values, right = np.linalg.svd(np.array([programs[k][1] for k in members]))
        free = np.ones(right.shape[:2], dtype=np.bool_)
        # Singular value of what is held in a block from which on HiGHS, whose rows are good to 1e-7, moves nothing so.
        free[:, : values.shape[1]] = values < 1e-5
        for k, motions, chosen in zip(members, right, free, strict=True):
            out[k] = motions[chosen]
    return out


def _scaled(rows: Array) -> Array:
    """The rows (n, d) that move for certain, at length one."""
    size = np.linalg.norm(rows, axis=1)
    moves = size > HIGHS_FEASIBLE
    return np.asarray(rows[moves] / size[moves, None])


def grams(rows: Array, weight: Array, counts: Ints) -> Array:
    """(pairs, 6, 6) Σ w r rᵀ of each pair's rows, one pair's after the other's and at least one of each."""
    start = np.concatenate([[0], np.cumsum(counts)[:-1]])
    columns = np.ascontiguousarray(rows.T)
    out = np.empty((len(columns), len(columns), len(counts)))
    for sums, column in zip(out, columns * weight, strict=True):
        np.add.reduceat(column * columns, start, axis=1, out=sums)
    return np.ascontiguousarray(np.moveaxis(out, 2, 0))


def opening(rows: Array) -> Opening:
    """Primal: max 1ᵀRV/n with RV ≥ 0, |V|∞ ≤ 1; "held" must be confirmed by the dual Rᵀλ = 0, λ ≥ 1.

    `rows` (n, 6), unit.
    """
    from scipy.optimize import linprog

    basis, _ = split_directions(rows)
    if basis.shape[1] == 0:
        return Opening(True, np.zeros(6), 0.0)
    inner = rows @ basis
    primal = linprog(-inner.mean(axis=0), A_ub=-inner, b_ub=np.zeros(len(inner)), bounds=(-1.0, 1.0), method="highs")
    if primal.status != 0:
        return Opening(None, np.zeros(6), 0.0)
    speed = float((inner @ primal.x).max())
    if speed > CONE_HELD:
        return Opening(False, basis @ primal.x, speed)
    if speed >= CONE_FREE:
        return Opening(None, basis @ primal.x, speed)
    dual = linprog(np.ones(len(inner)), A_eq=inner.T, b_eq=np.zeros(inner.shape[1]), bounds=(1.0, None), method="highs")
    return Opening(True if dual.status == 0 else None, np.zeros(6), speed)


def opens_at_once(rows: Array) -> bool:
    """Whether one motion opens all unit rows (n, 6) at once, each for certain."""
    from scipy.optimize import linprog

    n, size = rows.shape
    aim = np.append(np.zeros(size), -1.0)
    upper = np.hstack([-rows, np.ones((n, 1))])
    bounds = [(-1.0, 1.0)] * size + [(0.0, 1.0)]
    solved = linprog(aim, A_ub=upper, b_ub=np.zeros(n), bounds=bounds, method="highs")
    return bool(solved.status == 0 and solved.x[-1] > CONE_HELD)


def extreme_rays(rows: Array, opposed: Array | None = None) -> Array | None:
    """Extreme rays (k, d), unit, of {x : rows x ≥ 0} without its lineality; None where they are too many.

    `rows` (n, d), unit; `opposed`: what `split_directions` says that they oppose, where that is known. The rays are
    perpendicular to the lineality. Rows tight within rounding count as tight.
    """
    if len(rows) == 1:
        return rows
    basis = split_directions(rows)[0] if opposed is None else opposed
    inner = rows @ basis
    size = inner.shape[1]
    if size == 0:
        return np.zeros((0, rows.shape[1]))
    first = _independent(inner)
    corner = np.linalg.inv(inner[first]).T
    rays = np.asarray(corner / np.linalg.norm(corner, axis=1)[:, None], dtype=np.float64)
    done = list(first)
    rest = [k for k in range(len(inner)) if k not in set(first)]
    while rest:
        # the row that most rays violate cuts most away
        speeds = rays @ inner[rest].T
        broken = (speeds < -SINGLE).sum(axis=0)
        done += [k for k, n in zip(rest, broken, strict=True) if n == 0]
        rest = [k for k, n in zip(rest, broken, strict=True) if n > 0]
        if not rest:
            break
        broken = broken[broken > 0]
        chosen = rest.pop(int(np.argmax(broken)))
        cut = _cut(rays, inner, done, inner[chosen])
        if cut is None:
            return None
        rays = cut
        done.append(chosen)
        if not len(rays):
            break
    return rays @ basis.T


def _independent(inner: Array) -> list[int]:
    """Indices of rows that span their space, each as far as possible from those before."""
    left, chosen = inner.copy(), []
    for _ in range(inner.shape[1]):
        size = np.linalg.norm(left, axis=1)
        best = int(np.argmax(np.round(size, 9)))
        chosen.append(best)
        unit = left[best] / size[best]
        left = left - np.outer(left @ unit, unit)
    return chosen


def _cut(rays: Array, inner: Array, done: Sequence[int], row: Array) -> Array | None:
    """The rays after one more row: those inside, and where edges of the cone cross it."""
    speed = rays @ row
    inside, outside = np.flatnonzero(speed > SINGLE), np.flatnonzero(speed < -SINGLE)
    kept = rays[speed >= -SINGLE]
    if not len(inside):
        return kept
    tight = np.abs(rays @ inner[list(done)].T) <= SINGLE
    common = (tight[inside][:, None] & tight[outside][None]).reshape(-1, tight.shape[1])
    a, b = (x.ravel() for x in np.meshgrid(inside, outside, indexing="ij"))
    enough = common.sum(axis=1) >= rays.shape[1] - 2
    a, b, common = a[enough], b[enough], common[enough]
    # neighbours: no third ray is tight wherever both are
    shared = common.astype(np.float32) @ (~tight).astype(np.float32).T == 0.0
    neighbours = shared.sum(axis=1) == 2
    a, b = a[neighbours], b[neighbours]
    new = rays[b] * speed[a][:, None] - rays[a] * speed[b][:, None]
    new /= np.maximum(np.linalg.norm(new, axis=1), TINY)[:, None]
    if len(kept) + len(new) > MOST_RAYS:
        return None
    return np.vstack([kept, new])
