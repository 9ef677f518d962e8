"""Decides what two bodies may do relative to each other, from the evidence of their contacts.

Each candidate motion is tested against each patch; the freedoms are the motions that every patch
preserves, and the singular values of the rows, made exactly consistent with those, confirm that
nothing else is free. Where that leaves nothing, consensus: patches may be left out only if they
interfere, or oppose the motion in one direction only, or lie on facets of no known surface, and only
when they are a small part of the contact; the answer is then `blocked` (design section 4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.hypotheses import Motion, motions
from kinform.kinematics.screws import span
from kinform.kinematics.subspace import JointForm, name_space, nearest_pair
from kinform.model.tolerances import Tolerances

__all__ = ["Decision", "decide"]

Array = NDArray[np.float64]

INDEPENDENT = 0.03
"""A motion adds a freedom when this much of its unit twist lies outside those already found."""
CLEARLY = 0.5
"""Above this share a further motion is not a variant of those already found."""
RESIDUAL = 2.0
"""What is left of a further motion may be off by this many times the tolerances: it is a difference."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that consensus may leave out."""


@dataclass(frozen=True, eq=False)
class Decision:
    """The freedoms (columns of `basis`, scaled in the evidence's frame) and how they were found."""

    form: JointForm
    basis: Array
    """(6, k) orthonormal."""
    strict: Array
    """(6, k') freedoms when every patch counts; differs from `basis` when blocked."""
    status: str
    reason: str
    kept: tuple[int, ...]
    """Items that carry the joint."""
    left_out: tuple[tuple[int, Motion], ...]
    """Items left out, each with the motion that it forbids."""
    singular_values: Array
    """(6,) ascending."""


def decide(evidence: Evidence, tolerances: Tolerances) -> Decision:
    """The joint between the two bodies of the evidence."""
    candidates = motions(evidence, tolerances.alignment)
    twists = np.array([m.twist for m in candidates]).reshape(-1, 6).T
    speeds = evidence.rows @ twists
    fits = _fits(evidence, twists, speeds)
    everything = np.ones(len(evidence.items), dtype=bool)
    strict, values = _freedoms(evidence, twists, fits, everything, tolerances)
    chosen = _consensus(evidence, candidates, fits, speeds, strict)
    if chosen is None:
        status, reason = _certainty(values, strict.shape[1], tolerances)
        kept = tuple(range(len(evidence.items)))
        form = name_space(strict, evidence.frame)
        return Decision(form, strict, strict, status, reason, kept, (), values)
    keep, motion = chosen
    basis, values = _freedoms(evidence, twists, fits, keep, tolerances)
    if basis.shape[1] <= strict.shape[1]:
        status, reason = _certainty(values, strict.shape[1], tolerances)
        kept = tuple(range(len(evidence.items)))
        return Decision(name_space(strict, evidence.frame), strict, strict, status, reason, kept, (), values)
    out = tuple((int(k), motion) for k in np.flatnonzero(~keep))
    area = evidence.areas
    share = float(area[~keep].sum() / area.sum())
    reason = f"{len(out)} of {len(area)} patches ({100 * share:.1f} % of the area) left out: they block it"
    kept = tuple(int(k) for k in np.flatnonzero(keep))
    return Decision(name_space(basis, evidence.frame), basis, strict, "blocked", reason, kept, out, values)


def _fits(evidence: Evidence, twists: Array, speeds: Array, slack: float = 1.0) -> NDArray[np.bool_]:
    """(items, motions): does the patch slide on itself, within `slack` times its tolerances?"""
    length = evidence.frame.length
    velocity = twists[3:].T[None] + np.cross(twists[:3].T[None], evidence.arms[:, None])
    speed = np.linalg.norm(velocity, axis=2)
    turning = np.linalg.norm(twists[:3], axis=0)
    allowed = evidence.angle[:, None] * speed + evidence.position[:, None] / length * turning
    for k, item in enumerate(evidence.items):
        if item.patch.kind == "cone":
            # the slope of a cone is a fact, not a misalignment: slides along it have no slack
            own = slice(evidence.start[k], evidence.start[k + 1])
            slides = turning < 1e-9
            allowed[own, slides] = (3.0 * item.patch.uncertainty[0] + 1e-6) * speed[own, slides]
    weight = evidence.share[:, None]
    first = evidence.start[:-1]
    found = np.add.reduceat(weight * speeds**2, first, axis=0)
    limit = np.add.reduceat(weight * allowed**2, first, axis=0)
    fits: NDArray[np.bool_] = found <= slack**2 * limit + 1e-24
    return fits


def _freedoms(
    evidence: Evidence,
    twists: Array,
    fits: NDArray[np.bool_],
    keep: NDArray[np.bool_],
    tolerances: Tolerances,
) -> tuple[Array, Array]:
    """Basis (6, k) of what the kept patches leave free, and the singular values that say so.

    A motion that differs from those already found by less than the patches can tell adds nothing.
    """
    basis = np.zeros((6, 0))
    for twist in twists[:, fits[keep].all(axis=0)].T:
        rest = twist - basis @ (basis.T @ twist)
        size = float(np.linalg.norm(rest))
        if size > INDEPENDENT and (size > CLEARLY or _preserved(evidence, (rest / size)[:, None], keep, RESIDUAL)):
            basis = np.column_stack([basis, rest / size])
    chosen = np.repeat(keep, np.diff(evidence.start))
    rows = evidence.rows[chosen] * np.sqrt(evidence.share[chosen] / evidence.share[chosen].sum())[:, None]
    basis, values = _completed(rows, basis, tolerances)
    if name_space(basis, evidence.frame).type == "general":
        rounded = nearest_pair(basis, evidence.frame)
        if rounded is not None and _preserved(evidence, rounded, keep):
            return _completed(rows, rounded, tolerances)
    return basis, values


def _completed(rows: Array, basis: Array, tolerances: Tolerances) -> tuple[Array, Array]:
    """The basis with whatever else the rows leave free, and the singular values (6,) ascending."""
    rows = rows - (rows @ basis) @ basis.T
    triangle = np.linalg.qr(rows, mode="r") if len(rows) >= 6 else rows
    _, values, right = np.linalg.svd(np.vstack([triangle, np.zeros((6, 6))]))
    values = values[:6][::-1]
    null = right[:6][::-1][values < tolerances.free].T
    return span(null), values


def _preserved(evidence: Evidence, twists: Array, keep: NDArray[np.bool_], slack: float = 1.0) -> bool:
    """Does every kept patch slide on itself under each of the twists (6, n), within its tolerances?"""
    return bool(_fits(evidence, twists, evidence.rows @ twists, slack)[keep].all())


def _certainty(values: Array, freedoms: int, tolerances: Tolerances) -> tuple[str, str]:
    """Status and reason from the singular values beyond those of the freedoms."""
    if freedoms < 6 and values[freedoms] < tolerances.held:
        return "ambiguous", (
            f"singular value {values[freedoms]:.2g} lies between free (< {tolerances.free:g}) "
            f"and held (> {tolerances.held:g})"
        )
    weakest = f"; the weakest constraint has singular value {values[freedoms]:.2g}" if freedoms < 6 else ""
    return "determined", f"the contact leaves {freedoms} freedom{'' if freedoms == 1 else 's'}{weakest}"


def _consensus(
    evidence: Evidence,
    candidates: tuple[Motion, ...],
    fits: NDArray[np.bool_],
    speeds: Array,
    strict: Array,
) -> tuple[NDArray[np.bool_], Motion] | None:
    """The patches to keep and the motion that they free, or None when all patches agree.

    Where contact already leaves a freedom, only a turn about a curved surface may be added.
    """
    area = evidence.areas
    best: tuple[tuple[float, int], NDArray[np.bool_], Motion] | None = None
    for k, motion in enumerate(candidates):
        keep = fits[:, k]
        if keep.all() or not keep.any():
            continue
        share = float(area[~keep].sum() / area.sum())
        if share > MOST_LEFT_OUT or (best is not None and (share, k) >= best[0]):
            continue
        if strict.shape[1] and not (motion.turn and motion.curved):
            continue
        if strict.shape[1] and float(np.linalg.norm(motion.twist - strict @ (strict.T @ motion.twist))) < INDEPENDENT:
            continue
        if _frees_thrust(evidence, motion, keep):
            continue
        if _excusable(evidence, motion, ~keep, speeds[:, k]):
            best = ((share, k), keep, motion)
    return None if best is None else (best[1], best[2])


def _frees_thrust(evidence: Evidence, motion: Motion, keep: NDArray[np.bool_]) -> bool:
    """Would a shaft slide out because the face that locates it along its axis is left out?"""
    if motion.turn:
        return False

    def along(item: Item) -> bool:
        return float(np.linalg.norm(np.cross(item.patch.axis, motion.axis))) < 0.01

    shaft = any(item.patch.kind in COAXIAL and along(item) for item, k in zip(evidence.items, keep, strict=True) if k)
    faces = (item for item, k in zip(evidence.items, keep, strict=True) if not k)
    return shaft and any(item.patch.kind == "plane" and along(item) for item in faces)


def _excusable(evidence: Evidence, motion: Motion, out: NDArray[np.bool_], speed: Array) -> bool:
    """May these patches be left out of the decision for this motion? A shaft in its bore, a ball in its
    socket never."""
    signs: list[int] = []
    for k in np.flatnonzero(out):
        item = evidence.items[k]
        if item.patch.kind in (*COAXIAL, "sphere") and not item.patch.one_sided:
            return False
        if item.interferes and item.patch.kind not in (*COAXIAL, "sphere"):
            continue
        if item.patch.one_sided and item.patch.kind not in (*COAXIAL, "sphere"):
            continue
        own = speed[evidence.start[k] : evidence.start[k + 1]]
        large = 0.05 * float(np.abs(own).max())
        up, down = bool((own > large).any()), bool((own < -large).any())
        if up and down:
            return False
        signs.append(1 if up else -1)
    return len(set(signs)) <= 1
