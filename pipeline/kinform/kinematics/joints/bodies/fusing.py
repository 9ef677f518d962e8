"""The bodies of an assembly, and the joint of every two that touch.

Bodies are given, where the function states all joints, or they grow: groups and assumptions fuse parts, so does contact
that leaves no freedom, and so do suggestions (screws that are not modelled) where the manifest asks for them.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.classification import Pairs, decide_all
from kinform.kinematics.joints.bodies.fasteners import fasten, fastenings, harmless
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.stated_joints import Pair
from kinform.kinematics.joints.pair.question import Answer
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Suggestion
from kinform.model.kinematics import Body, Joint
from kinform.model.names import PartName


@dataclass(frozen=True, eq=False)
class Fused:
    """Which parts are one body, and what contact decides between the bodies."""

    merger: Merger
    decided: dict[Pair, tuple[Answer, Joint]]
    """Of every two bodies that touch."""
    suggestions: tuple[Suggestion, ...] = ()
    """Those that were applied."""

    def clusters(self, assembly: Assembly) -> tuple[Body, ...]:
        """The bodies if contact fused nothing."""
        merger = Merger(assembly)
        fasten(self.suggestions, merger)
        return merger.bodies()


def fuse_as_given(pairs: Pairs, bodies: Sequence[Sequence[PartName]]) -> Fused:
    """The given bodies; contact and suggestions fuse nothing more."""
    merger = Merger(pairs.assembly)
    for parts in bodies:
        for other in parts[1:]:
            merger.fuse(parts[0], other, "function: contact that no stated joint moves holds")
    return Fused(merger, decide_all(pairs, merger, fusing=False))


def fuse_by_contact(pairs: Pairs, contacts: Contacts) -> Fused:
    """Bodies by groups, assumptions and contact of rank six; then by suggestions.

    Suggestions are applied to what contact alone makes of the parts. Where contact then fuses what the manifest keeps
    apart, it is started again without those that led to it.
    """
    merger = Merger(pairs.assembly)
    decided = decide_all(pairs, merger)
    applied = fastenings(pairs.assembly, contacts, merger)
    while True:
        joined = merger.copy()
        if not fasten(applied, joined):
            return Fused(merger, decided, tuple(applied))
        anew = decide_all(pairs, joined)
        believed = harmless(applied, pairs.assembly, merger, joined)
        if len(believed) == len(applied):
            return Fused(joined, anew, tuple(applied))
        applied = believed
