"""Decides what two bodies may do relative to each other, from the evidence of their contacts.

The freedoms at rest are the motions that every patch preserves; the cone of motions (`motion_cone`) says what contact
lets go in one sense beside them. The answer, in this order:

1. A rotation about a journal that goes more than half round, ended in one sense by contact beside it, is a freedom:
   the joint is that of the other contact, drawn at its end stop.
2. Patches that are drawn into each other, and that alone forbid a motion that the rest of the contact allows, are left
   out: the joint is `blocked` by them.
3. Else the joint is what is at rest, and `certainty` says how sure that is.

What opposes a motion both ways holds it, as two sides of a slot hold a pin, be it of known surfaces or of facets. The
package's docstring has an example.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import norm, sine, widest_gap
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.certainty import Certainty, certainty, doubtful, momentary
from kinform.kinematics.joints.pair.evidence import COAXIAL, GUIDES, Evidence, Item
from kinform.kinematics.joints.pair.extremes import extreme_samples
from kinform.kinematics.joints.pair.freedoms import NEW_FREEDOM, freedoms, freedoms_beyond
from kinform.kinematics.joints.pair.hypotheses import Motion, candidate_motions
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import SLIDES, MotionCone, motion_cone
from kinform.kinematics.joints.pair.one_sided import ALONG_AXIS, HALF_ROUND, OtherReading, leaves_several_ways
from kinform.kinematics.joints.pair.preserved import preserved_by_each
from kinform.kinematics.joints.pair.touches import TOUCHING
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.kinematics import JointStatus, ReadingCause
from kinform.model.tolerances import Tolerances

DEEP_OVERLAP = 0.2
"""Overlaps below this share of the contact tolerance are presses: they never excuse a patch. Chosen, not measured."""
PRESS_RATIO = 2.0
"""Nor do overlaps within this many times those of the patches that carry the joint. Chosen, not measured."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that may be left out as an overlap. Chosen, not measured."""
IN_CLOSED = 0.1
"""Share of a motion that may be outside of what is closed, which is known to slack only. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Decision:
    """The freedoms (columns of `basis`, scaled in the evidence's frame) and how they were found."""

    form: JointForm
    basis: Array
    """(6, k) orthonormal."""
    strict: Array
    """(6, k') freedoms when every patch counts; differs from `basis` when blocked or at an end stop."""
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
    """Of such another reading: what the patches are that it leaves out (`one_sided.ROLES`)."""
    cone: MotionCone | None = None
    """Of all contact; None of another reading."""
    ended: tuple[tuple[int, Motion, float], ...] = ()
    """Items left out that end a motion at this pose, each with the motion and the sense in which it ends it."""


Question = tuple[Evidence, Tolerances, Sequence[Ints]]
"""The evidence of a pair, and of each of its items the samples that bound its patch."""


def decide(evidence: Evidence, tolerances: Tolerances) -> Decision:
    """The joint between the two bodies of the evidence."""
    return decide_each([(evidence, tolerances, extreme_samples([item.patch for item in evidence.items]))])[0]


def decide_each(pairs: Sequence[Question]) -> list[Decision]:
    """The joints of several pairs of bodies, each by the evidence of its own contacts alone."""
    candidates = [candidate_motions(evidence, tolerances.alignment) for evidence, tolerances, _ in pairs]
    twists = [np.array([m.twist for m in of_pair]).reshape(-1, 6).T for of_pair in candidates]
    preserved = preserved_by_each([(evidence, of_pair) for (evidence, *_), of_pair in zip(pairs, twists, strict=True)])
    of_each = zip(pairs, candidates, twists, preserved, strict=True)
    return [_decide(_Pair(*pair, motions, of_pair, flags)) for pair, motions, of_pair, flags in of_each]


@dataclass(frozen=True, eq=False)
class _Pair:
    """What is known of a pair: its patches, and which of them preserve which candidate motions."""

    evidence: Evidence
    tolerances: Tolerances
    bounds: Sequence[Ints]
    candidates: tuple[Motion, ...]
    twists: Array
    """(6, n)."""
    preserved: Flags
    """(items, n)."""

    def without(self, out: Flags) -> _Pair:
        """The pair if these items (items,) were not there."""
        bounds = [samples for samples, left in zip(self.bounds, ~out, strict=True) if left]
        return replace(self, evidence=self.evidence.without(out), bounds=bounds, preserved=self.preserved[~out])


def _decide(pair: _Pair) -> Decision:
    """The joint by what the patches say of candidate motions."""
    evidence, preserved = pair.evidence, pair.preserved
    everything = np.ones(len(evidence.items), dtype=bool)
    strict, values = freedoms(evidence, pair.twists, preserved, everything, pair.tolerances)
    cone = motion_cone(evidence, strict, pair.bounds)
    turned: OtherReading | None = None
    if cone.extra and not cone.opened.all():
        _, freed = freedoms_beyond(evidence, pair.twists, preserved, ~cone.opened, pair.tolerances, strict)
        cone = cone.exactly(freed)
    if cone.extra:
        stopped = _at_stop(pair, strict, cone)
        if isinstance(stopped, Decision):
            return stopped
        turned = stopped
    blocked = _blocked(pair, strict, cone)
    if blocked is not None:
        return blocked
    sure = certainty(evidence, pair.twists, preserved, strict, values, pair.tolerances, cone)
    if turned is not None and sure.status == "determined" and not cone.plainly_open:
        sure = doubtful(evidence, strict, turned)
    elif sure.status == "determined" and leaves_several_ways(cone):
        sure = Certainty(
            "ambiguous",
            f"fixed while all contact holds; {counted(cone.extra, 'motion')} beside that go one "
            "way only, and no one opens all of it",
        )
    kept = tuple(range(len(evidence.items)))
    form = JointForm("general") if momentary(evidence, strict) else evidence.form(strict)
    other = None if sure.other is None else _other(evidence, sure, pair.candidates, preserved, values)
    return Decision(form, strict, strict, sure.status, sure.reason, kept, (), values, other, cone=cone)


def _at_stop(pair: _Pair, strict: Array, cone: MotionCone) -> Decision | OtherReading | None:
    """The joint of a pair that is drawn where contact ends its rotation: that of the rest of the contact, where it
    leaves what is at rest and a turn about its journal; a reading where the journal does not go more than half round,
    None where there is no such turn."""
    evidence = pair.evidence
    reading: OtherReading | None = None
    for n, motion in _new_turns(pair, strict):
        out = ~pair.preserved[:, n]
        journal = _journal(evidence.chosen(~out), motion)
        if not (journal or reading is None) or _in_corner(evidence, out):
            continue
        basis, freed = freedoms_beyond(evidence, pair.twists, pair.preserved, ~out, pair.tolerances, strict)
        if not freed.shape[1] or not _in_one_sense(cone, basis, freed):
            continue
        if not journal:
            reading = OtherReading(evidence.form(basis), basis, tuple(np.flatnonzero(out).tolist()), "stop")
            continue
        rest = _decide(pair.without(out))
        if rest.basis.shape[1] != basis.shape[1] or rest.status == "blocked":
            continue
        sense = 0.0 if freed.shape[1] > 1 else -_sense(evidence.speeds_of(out, motion.twist))
        ended = tuple((int(k), motion, sense) for k in np.flatnonzero(out))
        return _with_left_out(rest, out, motion, strict, cone.exactly(freed), ended, "")
    return reading


def _in_corner(evidence: Evidence, out: Flags) -> bool:
    """Would a pin be taken off one wall that stays at another? Which of them it leaves is not known."""
    held, left = (
        {(item.patch.parts[k], item.patch.surfaces[k]) for item in of for k in (0, 1) if item.patch.radii[k] > 0.0}
        for of in ([i for i in evidence.chosen(flags) if i.patch.kind in TOUCHING] for flags in (~out, out))
    )
    return not held.isdisjoint(left)


def _in_one_sense(cone: MotionCone, basis: Array, freed: Array) -> bool:
    """Whether contact lets go in some sense whatever its rest leaves free beside what is at rest, and that is turns."""
    turning = np.linalg.svd(freed[:3], compute_uv=False).min() > SLIDES
    missed = basis - cone.closed @ (cone.closed.T @ basis)
    return bool(turning and np.linalg.norm(missed, axis=0).max() < IN_CLOSED)


def _new_turns(pair: _Pair, strict: Array) -> list[tuple[int, Motion]]:
    """Turns about curved surfaces that are no freedoms at rest, and that some patch preserves, best supported first."""
    some = pair.preserved.any(axis=0) & ~pair.preserved.all(axis=0)
    turns = [(int(n), pair.candidates[n]) for n in np.flatnonzero(some)]
    return [
        (n, motion)
        for n, motion in turns
        if motion.turn
        and motion.curved
        and not motion.pitch
        and norm(motion.twist - strict @ (strict.T @ motion.twist)) > NEW_FREEDOM
    ]


def _journal(kept: Sequence[Item], motion: Motion) -> bool:
    """Do surfaces that both bodies have go more than half round the axis of the turn, all of them together, or a ball
    more than half round its centre?"""
    rounds = [item for item in kept if not item.patch.one_sided]
    about = [
        item.normals
        for item in rounds
        if item.patch.kind in COAXIAL and sine(item.patch.axis, motion.axis) < ALONG_AXIS
    ]
    if about and widest_gap(np.concatenate(about), motion.axis) < HALF_ROUND:
        return True
    return any(
        item.patch.kind == "sphere" and float((item.normals @ item.normals.mean(axis=0)).min()) < 0.0 for item in rounds
    )


def _sense(speeds: Array) -> float:
    """1 where the greatest of speeds (n,) along normals opens, else −1."""
    return 1.0 if float(speeds.max()) > -float(speeds.min()) else -1.0


def _blocked(pair: _Pair, strict: Array, cone: MotionCone) -> Decision | None:
    """The joint of a pair of which a small part is drawn into each other and forbids what the rest of the contact
    allows; None where none does. Of the candidates the one that leaves out the smallest share of the area, the first of
    equals; where contact already leaves a freedom, only a turn about a curved surface may be added."""
    evidence, total = pair.evidence, float(pair.evidence.areas.sum())
    if not any(item.interferes for item in evidence.items):
        return None
    found: list[tuple[float, int]] = []
    some = pair.preserved.any(axis=0) & ~pair.preserved.all(axis=0)
    for n in np.flatnonzero(some).tolist():
        motion, out = pair.candidates[n], ~pair.preserved[:, n]
        share = float(evidence.areas[out].sum()) / total
        beyond = norm(motion.twist - strict @ (strict.T @ motion.twist))
        if share > MOST_LEFT_OUT or beyond < NEW_FREEDOM or (strict.shape[1] and not (motion.turn and motion.curved)):
            continue
        if _overlaps(evidence, motion, out):
            found.append((share, n))
    if not found:
        return None
    share, n = min(found)
    out = ~pair.preserved[:, n]
    basis, _ = freedoms(evidence, pair.twists, pair.preserved, ~out, pair.tolerances)
    if basis.shape[1] <= strict.shape[1]:
        return None
    rest = _decide(pair.without(out))
    words = f"{int(out.sum())} of {len(out)} patches ({100 * share:.1f} % of the area) left out: they block it"
    return _with_left_out(rest, out, pair.candidates[n], strict, cone, (), words)


def _overlaps(evidence: Evidence, motion: Motion, out: Flags) -> bool:
    """Are these patches drawn into each other by mistake, well beyond a press and the overlaps of what is kept? A shaft
    in its bore, a ball in its socket never are."""
    guides = [item for item in evidence.chosen(~out) if item.patch.kind in (*COAXIAL, "sphere") or not motion.turn]
    press = max([0.0, *(-item.patch.gap for item in guides)])
    return all(
        item.interferes
        and -item.patch.gap > PRESS_RATIO * press + DEEP_OVERLAP * evidence.contact
        and (item.patch.kind not in GUIDES or item.patch.one_sided)
        for item in evidence.chosen(out)
    )


def _with_left_out(
    rest: Decision,
    out: Flags,
    motion: Motion,
    strict: Array,
    cone: MotionCone,
    ended: tuple[tuple[int, Motion, float], ...],
    blocked: str,
) -> Decision:
    """The decision of the rest of the contact, in the numbers of all items; `blocked` says why what is left out blocks
    it, where it does not only end a motion."""
    place = np.flatnonzero(~out)

    def numbered(of: tuple[tuple[int, Motion], ...]) -> tuple[tuple[int, Motion], ...]:
        return tuple((int(place[k]), why) for k, why in of)

    status: JointStatus = "blocked" if blocked and rest.status == "determined" else rest.status
    left = tuple((int(k), motion) for k in np.flatnonzero(out)) if blocked else ()
    other = rest.other
    if other is not None:
        other = replace(other, kept=tuple(int(place[k]) for k in other.kept), left_out=numbered(other.left_out))
    return replace(
        rest,
        strict=strict,
        status=status,
        reason="; ".join(filter(None, (rest.reason, blocked))),
        kept=tuple(int(place[k]) for k in rest.kept),
        left_out=numbered(rest.left_out) + left,
        other=other,
        cone=cone,
        ended=tuple((int(place[k]), ends, sense) for k, ends, sense in rest.ended) + ended,
    )


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
