"""Decides what two bodies may do relative to each other, from the evidence of their contacts.

The freedoms are the motions that every patch preserves. Where that leaves nothing, consensus: patches may be left out
only if they interfere, or oppose the motion in one direction only, and only when they are a small part of the contact;
the answer is then `blocked`, and in doubt where what is kept may be a stop as well (`stops`), or could have been left
out instead: in a corner two walls oppose two motions, and which of them is meant is not known. What opposes a motion
both ways holds it, as two sides of a slot hold a pin, be it of known surfaces or of facets. The package's docstring
has an example.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import norm, sine
from kinform.foundation.lockstep import run_in_lockstep
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.certainty import Certainty, certainty, momentary
from kinform.kinematics.joints.pair.evidence import COAXIAL, GUIDES, Evidence, Item
from kinform.kinematics.joints.pair.freedoms import freedoms
from kinform.kinematics.joints.pair.hypotheses import Motion, candidate_motions
from kinform.kinematics.joints.pair.in_step import NEW_FREEDOM, Steps, remains
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.preserved import preserved_by_each
from kinform.kinematics.joints.pair.stops import (
    ALONG_AXIS,
    OPPOSING_SPEED,
    ROLES,
    ends_inside,
    faces_in_words,
    stop_reading,
)
from kinform.kinematics.joints.pair.touches import TOUCHING, beside_flange
from kinform.kinematics.joints.pair.uncertainty import uncertainty_doubt
from kinform.model.arrays import Array, Flags
from kinform.model.kinematics import JointStatus, ReadingCause
from kinform.model.tolerances import Tolerances

DEEP_OVERLAP = 0.2
"""Overlaps below this share of the contact tolerance are presses: they never excuse a patch. Chosen, not measured."""
PRESS_RATIO = 2.0
"""Nor do overlaps within this many times those of the patches that carry the joint. Chosen, not measured."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that consensus may leave out. Chosen, not measured."""
MOST_STOPPED = 0.6
"""Largest share that end stops of a turn may have: a closed gripper's jaws touch over more than its hinge."""
RIVAL = 2.0
"""Times as much area that others may have which could be left out instead of what is: of a block in a corner nobody
knows along which of two walls it slides, unless one is much longer. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Decision:
    """The freedoms (columns of `basis`, scaled in the evidence's frame) and how they were found."""

    form: JointForm
    basis: Array
    """(6, k) orthonormal."""
    strict: Array
    """(6, k') freedoms when every patch counts; differs from `basis` when blocked."""
    status: JointStatus
    reason: str
    kept: tuple[int, ...]
    """Items that carry the joint."""
    left_out: tuple[tuple[int, Motion], ...]
    """Items left out, each with the motion that it forbids."""
    singular_values: Array
    """(6,) ascending."""
    other: Decision | None = None
    """What else the contact may mean, of an ambiguous answer."""
    role: ReadingCause = ""
    """Of such another reading: what the patches are that it leaves out (`stops.ROLES`)."""


def decide(evidence: Evidence, tolerances: Tolerances) -> Decision:
    """The joint between the two bodies of the evidence."""
    return decide_each([(evidence, tolerances)])[0]


def decide_each(pairs: Sequence[tuple[Evidence, Tolerances]]) -> list[Decision]:
    """The joints of several pairs of bodies, each by the evidence of its own contacts alone."""
    candidates = [candidate_motions(evidence, tolerances.alignment) for evidence, tolerances in pairs]
    twists = [np.array([m.twist for m in of_pair]).reshape(-1, 6).T for of_pair in candidates]
    preserved = preserved_by_each([(evidence, of_pair) for (evidence, _), of_pair in zip(pairs, twists, strict=True)])
    of_each = zip(pairs, candidates, twists, preserved, strict=True)
    return run_in_lockstep(
        [_decide(*pair, motions, of_pair, flags) for pair, motions, of_pair, flags in of_each], remains
    )


def _decide(
    evidence: Evidence, tolerances: Tolerances, candidates: tuple[Motion, ...], twists: Array, preserved: Flags
) -> Steps[Decision]:
    """The joint by what the patches say of candidate motions, their `twists` (6, n), of which `preserved` (items, n)
    says which patch preserves which."""
    everything = np.ones(len(evidence.items), dtype=bool)
    strict, values = yield from freedoms(evidence, twists, preserved, everything, tolerances)
    chosen = _consensus(evidence, candidates, preserved, strict)
    if chosen is not None:
        keep = chosen.keep
        basis, loosened = yield from freedoms(evidence, twists, preserved, keep, tolerances)
    if chosen is None or basis.shape[1] <= strict.shape[1]:
        sure = yield from certainty(evidence, twists, preserved, strict, values, tolerances)
        kept = tuple(range(len(evidence.items)))
        form = JointForm("general") if momentary(evidence, strict) else evidence.form(strict)
        other = None if sure.other is None else _other(evidence, sure, candidates, preserved, values)
        return Decision(form, strict, strict, sure.status, sure.reason, kept, (), values, other)
    out = tuple((int(k), chosen.motion) for k in np.flatnonzero(~keep))
    area = evidence.areas
    share = float(area[~keep].sum() / area.sum())
    reason = f"{len(out)} of {len(area)} patches ({100 * share:.1f} % of the area) left out: they block it"
    kept = tuple(int(k) for k in np.flatnonzero(keep))
    form = evidence.form(basis)
    doubt = uncertainty_doubt(evidence.chosen(keep), form, evidence.frame.length)
    if doubt:
        return Decision(form, basis, strict, "ambiguous", f"{doubt}; {reason}", kept, out, loosened)
    if chosen.rivals:
        doubt = f"{form.type} if {faces_in_words(evidence, chosen.rivals)} holds, which may block it as well"
        return Decision(form, basis, strict, "ambiguous", f"{doubt}; {reason}", kept, out, loosened)
    stop = yield from stop_reading(evidence, twists, preserved, basis, tolerances, keep)
    if stop is None:
        return Decision(form, basis, strict, "blocked", reason, kept, out, loosened)
    words = f"{form.type} if {faces_in_words(evidence, stop.out)} holds"
    if not ends_inside(evidence, stop, keep):
        # as in the corner of a slot: which of two walls is a stop, or whether both are, is not known
        reason = f"{words}, which may be an end stop as well as what blocks it; {reason}"
        return Decision(form, basis, strict, "ambiguous", reason, kept, out, loosened)
    reason = f"{words}; {stop.form.type} if it is {ROLES[stop.role]}; {reason}"
    both = replace(stop, out=tuple(sorted({*stop.out, *(k for k, _ in out)})))
    other = _other(evidence, Certainty("ambiguous", reason, both), candidates, preserved, loosened)
    return Decision(form, basis, strict, "ambiguous", reason, kept, out, loosened, other)


def _other(
    evidence: Evidence, sure: Certainty, candidates: tuple[Motion, ...], preserved: Flags, values: Array
) -> Decision:
    """The other reading of a doubtful answer, as a decision of its own: what it leaves out forbids a motion."""
    other = sure.other
    assert other is not None
    keep = np.ones(len(evidence.items), dtype=bool)
    keep[list(other.out)] = False
    free = preserved[keep].all(axis=0)
    # each forbids a motion that the kept patches leave; where it does so only together with others, any that it forbids
    out = []
    for k in other.out:
        forbids = free & ~preserved[k]
        out.append((k, candidates[int(np.argmax(forbids if forbids.any() else ~preserved[k]))]))
    kept = tuple(int(k) for k in np.flatnonzero(keep))
    return Decision(
        other.form, other.basis, other.basis, "inferred", sure.reason, kept, tuple(out), values, role=other.role
    )


@dataclass(frozen=True, eq=False)
class _Consensus:
    """Patches to keep, and the motion that they free."""

    keep: Flags
    motion: Motion
    rivals: tuple[int, ...]
    """Items of those that would have been left out as well, of another consensus."""


def _consensus(
    evidence: Evidence, candidates: tuple[Motion, ...], preserved: Flags, strict: Array
) -> _Consensus | None:
    """The patches to keep and the motion that they free, or None when all patches agree.

    Of the candidates the one that leaves out the smallest share of the area, the first of equals; `preserved` (items,
    candidates). Where contact already leaves a freedom (`strict`), only a turn about a curved surface may be added.
    Rivals of it leave out others that it keeps, and little more of the area.
    """
    total = float(evidence.areas.sum())
    found: list[tuple[float, Flags, Motion]] = []
    for n in np.flatnonzero(preserved.any(axis=0) & ~preserved.all(axis=0)):
        keep, motion = preserved[:, n], candidates[n]
        share = sum(item.area for item in evidence.chosen(~keep)) / total
        small = share <= MOST_LEFT_OUT
        stopped = share <= MOST_STOPPED and _turns_on_journal(evidence, motion, keep)
        least = min((of for of, _, _ in found), default=math.inf)
        if not (small or stopped) or share > RIVAL * least:
            continue
        beyond = norm(motion.twist - strict @ (strict.T @ motion.twist))
        if strict.shape[1] and (not (motion.turn and motion.curved) or beyond < NEW_FREEDOM):
            continue
        if _frees_thrust(evidence, motion, keep):
            continue
        if _excusable(evidence, motion, ~keep, stops_only=not small):
            found.append((share, keep, motion))
    if not found:
        return None
    share, keep, motion = min(found, key=lambda one: one[0])
    beside = [other for of, other, _ in found if of <= RIVAL * share and (keep | other).all()]
    rivals = tuple(np.flatnonzero(~beside[0]).tolist()) if beside else ()
    return _Consensus(keep, motion, rivals)


def _frees_thrust(evidence: Evidence, motion: Motion, keep: Flags) -> bool:
    """Would a shaft slide out because the face that locates it along its axis is left out?"""
    if motion.turn:
        return False

    def along(item: Item) -> bool:
        return sine(item.patch.axis, motion.axis) < ALONG_AXIS

    shaft = any(item.patch.kind in COAXIAL and along(item) for item in evidence.chosen(keep))
    return shaft and any(item.patch.kind == "plane" and along(item) for item in evidence.chosen(~keep))


def _turns_on_journal(evidence: Evidence, motion: Motion, keep: Flags) -> bool:
    """Is it a turn about a curved surface that both bodies have, and that is kept?"""
    patches = (item.patch for item in evidence.chosen(keep))
    return motion.turn and motion.curved and any(p.kind in (*COAXIAL, "sphere") and not p.one_sided for p in patches)


def _excusable(evidence: Evidence, motion: Motion, out: Flags, *, stops_only: bool) -> bool:
    """May these patches be left out of the decision for this motion? `stops_only`: only end stops may.

    A shaft in its bore, a ball in its socket never, nor locators: what opposes the motion both ways, be it
    one patch or two that face each other. An overlap excuses a patch where it is a mistake, not a press: well
    beyond what the patches that are kept overlap by.
    """
    if _in_corner(evidence, out) or _rolls(evidence, out):
        return False
    guides = [item for item in evidence.chosen(~out) if _guides(item, motion)]
    press = max([0.0, *(-item.patch.gap for item in guides)])
    senses: set[int] = set()
    for k in np.flatnonzero(out):
        item = evidence.items[k]
        curved = item.patch.kind in GUIDES
        if curved and not item.patch.one_sided:
            return False
        along = evidence.rows[evidence.start[k] : evidence.start[k + 1]] @ motion.twist
        large = OPPOSING_SPEED * float(np.abs(along).max())
        up, down = bool((along > large).any()), bool((along < -large).any())
        if not curved and item.patch.one_sided and not stops_only and not (up and down):
            continue
        deep = item.interferes and not stops_only
        if not curved and deep and -item.patch.gap > PRESS_RATIO * press + DEEP_OVERLAP * evidence.contact:
            continue
        if up and down:
            return False
        senses.add(1 if up else -1)
    return len(senses) <= 1


def _in_corner(evidence: Evidence, out: Flags) -> bool:
    """Would a pin be taken off one wall that stays at another? Which of them should not hold is not known."""
    held, left = (
        {(item.patch.parts[k], item.patch.surfaces[k]) for item in of for k in (0, 1) if item.patch.radii[k] > 0.0}
        for of in ([i for i in evidence.chosen(flags) if i.patch.kind in TOUCHING] for flags in (~out, out))
    )
    return not held.isdisjoint(left)


def _rolls(evidence: Evidence, out: Flags) -> bool:
    """Would a roller be taken off the line along which it rolls, that stays at the ball on which its end slides?"""
    lines = [item.patch for item in evidence.chosen(out) if item.patch.kind == "line"]
    balls = [item.patch for item in evidence.chosen(~out) if item.patch.kind == "sphere"]
    return any(beside_flange(line, ball) for line in lines for ball in balls)


def _guides(item: Item, motion: Motion) -> bool:
    """Is this one of the patches on which the motion runs, not a face that merely ends it sideways?"""
    return item.patch.kind in (*COAXIAL, "sphere") or not motion.turn
