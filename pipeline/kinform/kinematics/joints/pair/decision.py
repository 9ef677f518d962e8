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

from kinform.foundation.algebra.vectors import norm
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.certainty import Certainty, certainty
from kinform.kinematics.joints.pair.evidence import COAXIAL, GUIDES, Evidence
from kinform.kinematics.joints.pair.extremes import extreme_samples
from kinform.kinematics.joints.pair.freedoms import NEW_FREEDOM, beyond
from kinform.kinematics.joints.pair.hypotheses import Motion, candidate_motions
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import MotionCone, motion_cone
from kinform.kinematics.joints.pair.one_sided import lets_turn, new_turns
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.kinematics.joints.pair.suspects import AtRest, Pair, suspect
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.kinematics import JointStatus, ReadingCause
from kinform.model.tolerances import Tolerances

DEEP_OVERLAP = 0.2
"""Overlaps below this share of the contact tolerance are presses: they never excuse a patch. Chosen, not measured."""
PRESS_RATIO = 2.0
"""Nor do overlaps within this many times those of the patches that carry the joint. Chosen, not measured."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that may be left out as an overlap. Chosen, not measured."""


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


def decide(evidence: Evidence, tolerances: Tolerances, bounds: Sequence[Ints] | None = None) -> Decision:
    """The joint between the two bodies of the evidence; `bounds`: of each item the samples that bound its patch, where
    these are known."""
    if bounds is None:
        bounds = extreme_samples([item.patch for item in evidence.items])
    candidates = candidate_motions(evidence, tolerances.alignment)
    twists = np.array([motion.twist for motion in candidates]).reshape(-1, 6).T
    return _decide(Pair(evidence, tolerances, bounds, candidates, twists, preserved_motions(evidence, twists)))


def _decide(pair: Pair) -> Decision:
    """The joint by what the patches say of candidate motions."""
    evidence = pair.evidence
    strict, values = pair.left_by(np.ones(len(evidence.items), dtype=bool))
    cone = motion_cone(evidence, strict, pair.bounds)
    if cone.extra and not cone.opened.all():
        cone = cone.exactly(beyond(pair.left_by(~cone.opened)[0], strict))
    rest = AtRest(
        evidence, pair.tolerances, pair.bounds, pair.candidates, pair.twists, pair.preserved, strict, values, cone
    )
    decided = (_at_stop(rest) if cone.extra else None) or _blocked(rest)
    if decided is not None:
        return decided
    sure = certainty(rest)
    kept = tuple(range(len(evidence.items)))
    form = JointForm("general") if rest.momentary else rest.form
    other = None if sure.other is None else _other(rest, sure)
    return Decision(form, strict, strict, sure.status, sure.reason, kept, (), values, other, cone=cone)


def _at_stop(pair: AtRest) -> Decision | None:
    """The joint of a pair that is drawn where contact ends its rotation: that of the rest of the contact, where it
    leaves what is at rest and a turn about its journal; None where there is no such turn."""
    for motion, out, journal in new_turns(pair):
        basis, freed = pair.freed(~out) if journal else (pair.basis, pair.basis[:, :0])
        if not freed.shape[1] or lets_turn(pair, suspect(out, "stop"), basis, freed) is None:
            continue
        rest = _decide(pair.without(out))
        if rest.basis.shape[1] != basis.shape[1] or rest.status == "blocked":
            continue
        sense = 0.0 if freed.shape[1] > 1 else -_sense(pair.evidence.speeds_of(out, motion.twist))
        ended = tuple((int(k), motion, sense) for k in np.flatnonzero(out))
        return _with_left_out(rest, out, motion, pair.basis, pair.cone.exactly(freed), ended, "")
    return None


def _sense(speeds: Array) -> float:
    """1 where the greatest of speeds (n,) along normals opens, else −1."""
    return 1.0 if float(speeds.max()) > -float(speeds.min()) else -1.0


def _blocked(pair: AtRest) -> Decision | None:
    """The joint of a pair of which a small part is drawn into each other and forbids what the rest of the contact
    allows; None where none does. Of the candidates the one that leaves out the smallest share of the area, the first of
    equals; where contact already leaves a freedom, only a turn about a curved surface may be added."""
    evidence, strict, total = pair.evidence, pair.basis, float(pair.evidence.areas.sum())
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
    basis, _ = pair.left_by(~out)
    if basis.shape[1] <= strict.shape[1]:
        return None
    rest = _decide(pair.without(out))
    words = f"{int(out.sum())} of {len(out)} patches ({100 * share:.1f} % of the area) left out: they block it"
    return _with_left_out(rest, out, pair.candidates[n], strict, pair.cone, (), words)


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


def _other(pair: AtRest, sure: Certainty) -> Decision:
    """The other reading of a doubtful answer, as a decision of its own: what it leaves out forbids a motion."""
    other = sure.other
    assert other is not None
    keep = np.ones(len(pair.patches), dtype=bool)
    keep[list(other.out)] = False
    free = pair.preserved[keep].all(axis=0)
    # each forbids a motion that the kept patches leave; where it does so only together with others, any that it forbids
    out = []
    for k in other.out:
        forbids = free & ~pair.preserved[k]
        out.append((k, pair.candidates[int(np.argmax(forbids if forbids.any() else ~pair.preserved[k]))]))
    kept = tuple(int(k) for k in np.flatnonzero(keep))
    return Decision(
        other.form, other.basis, other.basis, "inferred", sure.reason, kept, tuple(out), pair.values, role=other.role
    )
