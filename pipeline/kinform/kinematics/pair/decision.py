"""Decides what two bodies may do relative to each other, from the evidence of their contacts.

The freedoms are the motions that every patch preserves. Where that leaves nothing, consensus: patches may be left out only if they
interfere, or oppose the motion in one direction only, or lie on facets of no known surface, and only
when they are a small part of the contact; the answer is then `blocked` (design section 4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import cross
from kinform.kinematics.pair.certainty import certainty, momentary
from kinform.kinematics.pair.evidence import COAXIAL, GUIDES, Evidence, Item
from kinform.kinematics.pair.freedoms import INDEPENDENT, fits, freedoms
from kinform.kinematics.pair.hypotheses import Motion, motions
from kinform.kinematics.pair.subspace import JointForm, name_space
from kinform.model.arrays import Array
from kinform.model.tolerances import Tolerances

__all__ = ["Decision", "decide"]


DEEP = 0.2
"""Overlaps below this share of the contact tolerance are presses: they never excuse a patch."""
PRESSED = 2.0
"""Nor do overlaps within this many times those of the patches that carry the joint."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that consensus may leave out."""
MOST_STOPPED = 0.6
"""Largest share that end stops of a turn may have: a closed gripper's jaws touch over more than its hinge."""


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
    preserved = fits(evidence, twists, speeds)
    everything = np.ones(len(evidence.items), dtype=bool)
    strict, values = freedoms(evidence, twists, preserved, everything, tolerances)
    chosen = _consensus(evidence, candidates, preserved, speeds, strict)
    if chosen is not None:
        keep, motion = chosen
        basis, loosened = freedoms(evidence, twists, preserved, keep, tolerances)
    if chosen is None or basis.shape[1] <= strict.shape[1]:
        status, reason = certainty(evidence, twists, strict, values, tolerances)
        kept = tuple(range(len(evidence.items)))
        form = JointForm("general") if momentary(evidence, strict) else name_space(strict, evidence.frame)
        return Decision(form, strict, strict, status, reason, kept, (), values)
    out = tuple((int(k), motion) for k in np.flatnonzero(~keep))
    area = evidence.areas
    share = float(area[~keep].sum() / area.sum())
    reason = f"{len(out)} of {len(area)} patches ({100 * share:.1f} % of the area) left out: they block it"
    kept = tuple(int(k) for k in np.flatnonzero(keep))
    return Decision(name_space(basis, evidence.frame), basis, strict, "blocked", reason, kept, out, loosened)


def _consensus(
    evidence: Evidence,
    candidates: tuple[Motion, ...],
    preserved: NDArray[np.bool_],
    speeds: Array,
    strict: Array,
) -> tuple[NDArray[np.bool_], Motion] | None:
    """The patches to keep and the motion that they free, or None when all patches agree.

    Where contact already leaves a freedom, only a turn about a curved surface may be added.
    """
    area = evidence.areas
    best: tuple[tuple[float, int], NDArray[np.bool_], Motion] | None = None
    for k, motion in enumerate(candidates):
        keep = preserved[:, k]
        if keep.all() or not keep.any():
            continue
        share = float(area[~keep].sum() / area.sum())
        small = share <= MOST_LEFT_OUT
        stopped = share <= MOST_STOPPED and _turns_on_journal(evidence, motion, keep)
        if not (small or stopped) or (best is not None and (share, k) >= best[0]):
            continue
        if strict.shape[1] and not (motion.turn and motion.curved):
            continue
        if strict.shape[1] and float(np.linalg.norm(motion.twist - strict @ (strict.T @ motion.twist))) < INDEPENDENT:
            continue
        if _frees_thrust(evidence, motion, keep):
            continue
        if _excusable(evidence, motion, ~keep, speeds[:, k], stops_only=not small):
            best = ((share, k), keep, motion)
    return None if best is None else (best[1], best[2])


def _frees_thrust(evidence: Evidence, motion: Motion, keep: NDArray[np.bool_]) -> bool:
    """Would a shaft slide out because the face that locates it along its axis is left out?"""
    if motion.turn:
        return False

    def along(item: Item) -> bool:
        return float(np.linalg.norm(cross(item.patch.axis, motion.axis))) < 0.01

    shaft = any(item.patch.kind in COAXIAL and along(item) for item, k in zip(evidence.items, keep, strict=True) if k)
    faces = (item for item, k in zip(evidence.items, keep, strict=True) if not k)
    return shaft and any(item.patch.kind == "plane" and along(item) for item in faces)


def _turns_on_journal(evidence: Evidence, motion: Motion, keep: NDArray[np.bool_]) -> bool:
    """Is it a turn about a curved surface that both bodies have, and that is kept?"""
    kept = (item.patch for item, k in zip(evidence.items, keep, strict=True) if k)
    return motion.turn and motion.curved and any(p.kind in (*COAXIAL, "sphere") and not p.one_sided for p in kept)


def _excusable(evidence: Evidence, motion: Motion, out: NDArray[np.bool_], speed: Array, *, stops_only: bool) -> bool:
    """May these patches be left out of the decision for this motion? `stops_only`: only end stops may.

    A shaft in its bore, a ball in its socket never, nor locators: what opposes the motion both ways, be it
    one patch or two that face each other. An overlap excuses a patch where it is a mistake, not a press: well
    beyond what the patches that are kept overlap by.
    """
    guides = [evidence.items[k] for k in np.flatnonzero(~out) if _guides(evidence.items[k], motion)]
    press = max([0.0, *(-item.patch.gap for item in guides)])
    senses: set[int] = set()
    for k in np.flatnonzero(out):
        item = evidence.items[k]
        curved = item.patch.kind in GUIDES
        if curved and not item.patch.one_sided:
            return False
        if not curved and item.patch.one_sided and not stops_only:
            continue
        deep = item.interferes and not stops_only
        if not curved and deep and -item.patch.gap > PRESSED * press + DEEP * evidence.contact:
            continue
        own = speed[evidence.start[k] : evidence.start[k + 1]]
        large = 0.05 * float(np.abs(own).max())
        up, down = bool((own > large).any()), bool((own < -large).any())
        if up and down:
            return False
        senses.add(1 if up else -1)
    return len(senses) <= 1


def _guides(item: Item, motion: Motion) -> bool:
    """Is this one of the patches on which the motion runs, not a face that merely ends it sideways?"""
    return item.patch.kind in (*COAXIAL, "sphere") or not motion.turn
