"""Contact that may not hold what its rows say, as data.

The rows of a pair take each patch as it was found, in both senses. What contact lets go in one sense the cone of
motions knows. It cannot know that a patch is there by the mesh alone (facets, scatter, an edge that dips in), that a
place or a direction is vague, or that a face ends a motion that is meant. Generators list such contact as `Suspect`s;
`certainty` tries, in the order of its table, what becomes of the joint if they are right.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Literal

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.constants import VAGUE_AXIS
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.kinematics.joints.pair.freedoms import beyond, freedoms
from kinform.kinematics.joints.pair.hypotheses import Motion
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import MotionCone
from kinform.kinematics.joints.pair.touches import HIGHER, meets, momentary
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import ReadingCause
from kinform.model.tolerances import Tolerances

Role = Literal["doubt", "drop", "widen", "stop", "sliver", "flank", "pin", "prism", "bend"]
"""What is done with suspects. doubt: nothing, the answer is in doubt whatever they hold. drop: left out; in doubt if
more is free then. widen: the same with their tolerances widened. stop, sliver, flank, pin: left out; if more is free,
both readings are kept. prism, bend: they hold more than their rows say, and both readings are kept."""
ROLES = {
    "stop": "an end stop",
    "sliver": "too slight to decide",
    "flank": "the flank of a tooth or cam, which bears nothing",
    "prism": "those of a prism",
    "pin": "of a pin that has play in its slot",
    "bend": "a line along which a roller lies in its ring",
}
"""What faces are that may not be meant to hold, or hold more."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """Contact that may not hold what its rows say."""

    items: tuple[int, ...]
    """Of the evidence."""
    role: Role
    words: str = ""
    """Why the answer is in doubt; of readings the answer has its own words."""


def suspect(flags: Flags, role: Role, words: str = "") -> Suspect:
    """The items whose flags (items,) are set."""
    return Suspect(tuple(np.flatnonzero(flags).tolist()), role, words)


@dataclass(frozen=True, eq=False)
class OtherReading:
    """What the patches say if suspects are right."""

    form: JointForm
    basis: Array
    """(6, k) scaled freedoms."""
    out: tuple[int, ...]
    """Items that are left out; none of a prism or a bend."""
    role: ReadingCause


@dataclass(frozen=True, eq=False)
class Pair:
    """What is known of a pair: its patches, and which of them preserve which candidate motions."""

    evidence: Evidence
    tolerances: Tolerances
    bounds: Sequence[Ints]
    """Of each item the samples that bound its patch."""
    candidates: tuple[Motion, ...]
    twists: Array
    """(6, n) of the candidates."""
    preserved: Flags
    """(items, n)."""

    def left_by(self, keep: Flags) -> tuple[Array, Array]:
        """Freedoms (6, k) that the items (items,) leave, and the singular values (6,)."""
        return freedoms(self.evidence, self.twists, self.preserved, keep, self.tolerances)

    def without(self, out: Flags) -> Pair:
        """The pair if these items (items,) were not there."""
        bounds = [samples for samples, left in zip(self.bounds, ~out, strict=True) if left]
        evidence, preserved = self.evidence.without(out), self.preserved[~out]
        return Pair(evidence, self.tolerances, bounds, self.candidates, self.twists, preserved)


@dataclass(frozen=True, eq=False)
class AtRest(Pair):
    """A pair with what all of its contact leaves."""

    basis: Array
    """(6, k) freedoms at rest, orthonormal."""
    values: Array
    """(6,) singular values, ascending."""
    cone: MotionCone

    @property
    def count(self) -> int:
        """How many freedoms there are."""
        return int(self.basis.shape[1])

    @cached_property
    def patches(self) -> list[Patch]:
        """Of the items."""
        return [item.patch for item in self.evidence.items]

    @cached_property
    def form(self) -> JointForm:
        """The joint at rest."""
        return self.evidence.form(self.basis)

    @cached_property
    def momentary(self) -> bool:
        """Whether points and lines alone leave a turn of this instant."""
        return momentary(self.evidence, self.basis)

    @cached_property
    def touching(self) -> bool:
        """Whether the bodies only touch at points and along lines, and make no lower pair there."""
        return self.momentary or (self.form.type == "general" and meets(self.patches))

    @cached_property
    def firm(self) -> Flags:
        """(items,) whether they are of known surfaces, on both sides where they leave no freedom."""
        return np.array(
            [patch.kind not in HIGHER and (self.count > 0 or not patch.one_sided) for patch in self.patches]
        )

    @cached_property
    def vague(self) -> Array:
        """(items,) rad: how well the direction of each patch is known, by the better of its surfaces, or, where they
        leave no freedom, by both."""
        return np.array([max(p.uncertainty[0], 0.0 if self.count else p.mismatch[0]) for p in self.patches])

    @cached_property
    def sure(self) -> Flags:
        """(items,) whether they are of known surfaces whose directions are known."""
        return self.firm & (self.vague <= VAGUE_AXIS)

    def freed(self, keep: Flags) -> tuple[Array, Array]:
        """Freedoms (6, k) that the items (items,) leave, and what they are beyond those at rest (6, n)."""
        free = self.left_by(keep)[0] if keep.any() else np.eye(6)
        return free, beyond(free, self.basis)
