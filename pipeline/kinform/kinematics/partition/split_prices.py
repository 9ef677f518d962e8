"""The price of separating two parts that touch along the motion of a joint.

A joint's motions are a few twists. It may separate two parts where nearly none of the area between them opposes any of
them. The price is low for a journal or a collar about the joint's axis, which joints are made of; higher for an annular
face without a journal, which may be a flange; and high for a flat beside the axis, which a turn frees by chance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import field, replace

from kinform.frozen import dataclass
from kinform.kinematics.partition.constants import BROKEN, FASTENED
from kinform.kinematics.partition.contact import FLAT_BESIDE, JOURNAL, LOOSE_JOURNAL, Asked, PartPair, contact_of_pairs
from kinform.model.arrays import Array
from kinform.model.contacts import Patch, Suggestion
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName


@dataclass(frozen=True, eq=False)
class Prices:
    """What parting each pair of parts costs."""

    by_joint: Mapping[PartPair, Mapping[int, float]]
    """For each pair that touches, the joints that may part it, by number, and the price. Without any it is held."""
    held: Mapping[PartPair, float]
    """What it costs to part a pair although no joint may: what holds it is broken."""
    hints: Mapping[PartPair, float] = field(default_factory=dict)
    """What of these prices is there because something suggests that a pair is fastened."""
    slight: frozenset[PartPair] = frozenset()
    """Pairs that touch at points or along lines only."""

    def of(self, numbers: Sequence[int]) -> Prices:
        """The prices of some of the joints, numbered anew."""
        new = {number: k for k, number in enumerate(numbers)}
        some = {
            pair: {new[k]: price for k, price in parted.items() if k in new} for pair, parted in self.by_joint.items()
        }
        return replace(self, by_joint=some)

    def firm(self) -> list[PartPair]:
        """The pairs that no joint may part: they are one body wherever that joins no two.

        What touches at points or along lines is none of them, nor are two parts with journals about axes of different
        joints, as gears in mesh: what each of them goes with says more.
        """
        turning: dict[PartName, set[int]] = {}
        for pair, parted in self.by_joint.items():
            hint = self.hints.get(pair, 0.0)
            about = {k for k, price in parted.items() if LOOSE_JOURNAL <= price - hint <= JOURNAL}
            for name in pair:
                turning.setdefault(name, set()).update(about)
        return [
            (first, second)
            for (first, second), parted in self.by_joint.items()
            if not parted and (first, second) not in self.slight and _same_turns(turning[first], turning[second])
        ]


def _same_turns(first: Set[int], second: Set[int]) -> bool:
    """Whether parts that turn about the axes of these joints may be one body by that."""
    return not first or not second or bool(first & second)


def prices(
    joints: Sequence[IntendedJoint],
    twists: Sequence[Array | None],
    patches: Sequence[Patch],
    suggestions: Sequence[Suggestion],
) -> Prices:
    """The price of parting every pair of parts that touch, by every joint that may."""
    hints = hints_of(suggestions)
    by_joint, held, slight = {}, {}, set()
    asked = Asked.of(joints, twists)
    for pair, contact in contact_of_pairs(patches).items():
        hint = hints.get(pair, 0.0)
        by_joint[pair] = {number: cost + hint for number, cost in contact.costs(asked).items()}
        held[pair] = (FLAT_BESIDE if contact.slight else BROKEN) + hint
        slight |= {pair} if contact.slight else set()
    return Prices(by_joint, held, hints, frozenset(slight))


def hints_of(suggestions: Sequence[Suggestion]) -> dict[PartPair, float]:
    """What parting pairs costs beside, as something suggests that they are fastened."""
    out: dict[PartPair, float] = {}
    for suggestion in suggestions:
        worth = FASTENED.get(suggestion.kind)
        if worth is not None:
            out[suggestion.parts] = max(out.get(suggestion.parts, 0.0), worth)
    return out
