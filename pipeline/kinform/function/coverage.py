"""How near a point, or a direction, of a body comes to targets while joints stay within their ranges.

Configurations are sampled (at random in the box of ranges; along closed loops by a walk from the pose of the meshes
where there are loops), and from the best of them each target is approached by damped least squares with the loops
and the ranges as constraints (Levenberg and Marquardt, projected). A target that is reached is proved by its
configuration. One that is not was not found from that many starts: the nearest is given. Collisions play no part.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.function.configurations import Chain
from kinform.mechanism.closing import close
from kinform.mechanism.constants import FREE
from kinform.model.arrays import Array, Flags
from kinform.requirements.evidence import Coverage

SAMPLES = 4000
"""Configurations in the box of ranges: 16 values of each of three joints. Chosen, not measured."""
WALK = 600
"""Configurations along closed loops, each of which takes a closure of its own: 24 by 24 of two freedoms. Chosen, not
measured."""
AGAIN = 40
"""How many of the farthest targets are approached again, ..."""
STARTS_AGAIN = 48
"""... and from how many samples: one that is missed makes the region not reached. Both chosen, not measured."""
TOGETHER = 400
"""Approaches that are made at once: with 20 coordinates their matrices take 1 MB, what a cache holds."""
TURNS = 60
"""Steps of an approach at most: with `APPROACH_STEP` a coordinate may go five turns. Chosen, not measured."""
FAR = 1.0
"""Loops may close in several ways: what is farther (rad, or sizes) from all that the walk came through is not
counted."""
STIFF = 10.0
"""Weight of a loop that is open beside a target that is missed: loops close first. Chosen, not measured."""
DAMPING = 1e-3
"""Levenberg and Marquardt's damping at the start, ..."""
DAMPING_BETTER = 0.2
"""... its factor after a step that came nearer, ..."""
DAMPING_WORSE = 5.0
"""... and after one that did not: textbook values."""
DAMPING_RANGE = (1e-12, 1e6)
"""Where it stays."""
APPROACH_STEP = 0.5
"""rad, or share of the size, that one step changes a coordinate at most: within 30° a first order is of use. The walk
along closed loops takes half of it, so that it does not jump from one branch to another. Chosen, not measured."""


def cover(chain: Chain, body: str, carried: Array, targets: Array, *, directions: bool, near: float = 0.0) -> Coverage:
    """`carried` (3,): the point (m) or unit direction of the body at the pose of the meshes; `targets` (k, 3).

    Those of the farthest targets that stay beyond `near` (m or rad) are approached again from many more samples.
    """
    tip = chain.index(body)
    image_of = carried if directions else chain.linkage.local(carried)
    aims = targets if directions else chain.linkage.local(targets)
    enough = near if directions else near / chain.frame.length
    q = _sampled(chain)
    images = _images(chain, tip, image_of, q, directions)
    # a sample itself is an answer too
    gaps = _distance(images[:, None], aims[None], directions)
    first = gaps.argmin(axis=0)
    best, where = gaps[first, np.arange(len(aims))], images[first]

    def attempt(which: NDArray[np.intp], starts: int) -> None:
        size = max(1, TOGETHER // starts)
        for chunk in (which[k : k + size] for k in range(0, len(which), size)):
            seeds = _seeds(aims[chunk], images, starts)
            repeated = np.repeat(aims[chunk], seeds.shape[1], axis=0)
            solved, image, valid = _approach(chain, tip, image_of, q[seeds.ravel()], repeated, directions)
            if chain.looped:
                valid &= np.abs(solved - q[seeds.ravel()]).max(axis=1) < FAR
            miss = np.where(valid, _distance(image, repeated, directions), np.inf).reshape(seeds.shape)
            pick = miss.argmin(axis=1)
            nearest = miss[np.arange(len(chunk)), pick]
            better = nearest < best[chunk]
            best[chunk[better]] = nearest[better]
            where[chunk[better]] = image.reshape(*seeds.shape, 3)[np.arange(len(chunk)), pick][better]

    # Samples from which each target is approached: the nearest may lie behind the end of a range. Chosen, not measured.
    attempt(np.arange(len(aims)), 6)
    missed = np.flatnonzero(best > enough)
    attempt(missed[np.argsort(-best[missed], kind="stable")][:AGAIN], STARTS_AGAIN)
    if not directions:
        best, where = best * chain.frame.length, where * chain.frame.length + chain.frame.centre
    return Coverage(best, where, len(q))


def _sampled(chain: Chain) -> Array:
    """(m, n) closed configurations within the ranges, the pose of the meshes first."""
    rng = np.random.default_rng(0)
    low, high = _box(chain)
    start = np.zeros(len(low))
    if not chain.looped:
        return np.vstack([np.clip(start, low, high), rng.uniform(low, high, (SAMPLES, len(low)))])
    closed, tries = [start], 0
    # Steps for each configuration after which the walk ends.
    while len(closed) < WALK and tries < 8 * WALK:
        base = closed[int(rng.integers(len(closed)))]
        tries += 1
        loose = null_space(chain.system.equations(base[None]).jacobian[0], FREE)
        if not len(loose):
            break
        way = rng.normal(size=len(loose)) @ loose
        stepped = close(chain.system, (base + APPROACH_STEP / 2.0 * way / np.abs(way).max())[None]).one()
        slack = SOLVED
        if stepped is not None and ((stepped >= low - slack) & (stepped <= high + slack)).all():
            closed.append(stepped)
    return np.array(closed)


def _box(chain: Chain) -> tuple[Array, Array]:
    """Ranges of all coordinates: a full turn where no range of a turn is known, or it is free."""
    low, high = chain.lower, chain.upper
    # what gears tie turns as often as its partner needs
    tied = chain.system.ties.any(axis=0)
    turns = np.array([c.turns for c in chain.coordinates], dtype=np.bool_) & ~tied
    return np.where(turns, np.maximum(low, -np.pi), low), np.where(turns, np.minimum(high, np.pi), high)


def _images(chain: Chain, tip: int, image_of: Array, q: Array, directions: bool) -> Array:
    X = chain.system.bodies(q)[:, tip]
    turned = X[:, :3, :3] @ image_of
    return np.asarray(turned if directions else turned + X[:, :3, 3])


def _distance(a: Array, b: Array, directions: bool) -> Array:
    apart = np.linalg.norm(a - b, axis=-1)
    return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * apart, 1.0)) if directions else apart)


def _seeds(aims: Array, images: Array, starts: int) -> NDArray[np.intp]:
    """(k, starts) samples to start from: the nearest, and ever sparser ones after it, to the farthest."""
    order = np.argsort(np.linalg.norm(aims[:, None] - images[None], axis=-1), axis=1, kind="stable")
    last = len(images) - 1
    picks = np.unique(np.round(np.geomspace(1, last + 1, starts)).astype(np.int64) - 1)
    return order[:, np.minimum(picks, last)]


def _approach(
    chain: Chain, tip: int, image_of: Array, q: Array, aims: Array, directions: bool
) -> tuple[Array, Array, Flags]:
    """Configurations (d, n), their images (d, 3), and which of them are closed."""
    system = chain.system
    low, high = _box(chain)
    damping = np.full(len(q), DAMPING)
    image, miss, rows, residual = _linear(chain, tip, image_of, q, aims, directions)
    for _ in range(TURNS):
        gradient = (np.swapaxes(rows, 1, 2) @ residual[..., None])[..., 0]
        stuck = ((q <= low + ARITHMETIC) & (gradient > 0.0)) | ((q >= high - ARITHMETIC) & (gradient < 0.0))
        active = np.where(stuck[:, None, :], 0.0, rows)
        normal = np.swapaxes(active, 1, 2) @ active
        normal += damping[:, None, None] * np.eye(system.coordinates)
        step = -np.linalg.solve(normal, (np.swapaxes(active, 1, 2) @ residual[..., None]))[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True)
        step *= np.minimum(1.0, APPROACH_STEP / np.maximum(longest, TINY))
        trial = np.clip(q + step, low, high)
        new_image, new_miss, new_rows, new_residual = _linear(chain, tip, image_of, trial, aims, directions)
        better = new_miss < miss
        q = np.where(better[:, None], trial, q)
        image = np.where(better[:, None], new_image, image)
        rows = np.where(better[:, None, None], new_rows, rows)
        residual = np.where(better[:, None], new_residual, residual)
        miss = np.where(better, new_miss, miss)
        damping = np.clip(np.where(better, DAMPING_BETTER, DAMPING_WORSE) * damping, *DAMPING_RANGE)
        # Where no approach comes nearer and none is damped by less, all have ended.
        if not better.any() and damping.min() > 1e2:
            break
    opened = np.abs(residual[:, 3:]).max(axis=1, initial=0.0) / STIFF
    # Residual at which the loops of an approach count as closed: it ends damped, a step before `SOLVED`.
    return q, image, opened < 1e-8


def _linear(
    chain: Chain, tip: int, image_of: Array, q: Array, aims: Array, directions: bool
) -> tuple[Array, Array, Array, Array]:
    """Images (d, 3), squared misses (d,), derivatives (d, 3 + loops, n) and residuals (d, 3 + loops)."""
    system = chain.system
    image = _images(chain, tip, image_of, q, directions)
    state = system.equations(q)
    columns = state.columns * system.reach[tip][None, :, None]
    turn = cross(columns[..., :3], image[:, None, :])
    moves = turn if directions else turn + columns[..., 3:]
    rows = np.concatenate([np.swapaxes(moves, 1, 2), STIFF * state.jacobian], axis=1)
    residual = np.concatenate([image - aims, STIFF * state.residual], axis=1)
    return image, np.einsum("di,di->d", residual, residual), rows, residual
