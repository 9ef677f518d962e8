"""Joints that part flats beside their axis only, although something goes round it: they are cut again on the axis.

A block that is glued on a plate, and named by a joint, is cheaper to part from it, one flat, than the plate from what
it turns on, a motor's face with its horn. Nothing of that cut is where the joint is stated to be, so the flat is held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.partition.constants import PARTED
from kinform.kinematics.partition.contact import ROLLING, PartPair, contact_of_pairs
from kinform.kinematics.partition.graph import Graph, graph_of
from kinform.kinematics.partition.labelling import Labelling, label_all
from kinform.kinematics.partition.split_prices import Prices, hints_of
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint

Cut = tuple[Graph, Labelling]


def cut_on_axes(
    assembly: Assembly, contacts: Contacts, joints: Sequence[IntendedJoint], merger: Merger, cut: Cut
) -> Cut:
    """The cut, or one that parts something round the axis of each joint that has it and parted none, where that breaks
    nothing more that no joint may part."""
    hints = hints_of(contacts.suggestions)
    tried: set[int] = set()
    while True:
        beside = {k: pairs for k, pairs in _beside(joints, cut, hints).items() if k not in tried}
        beside = {k: pairs for k, pairs in beside.items() if _round(joints[k], k, cut, hints, contacts)}
        if not beside:
            return cut
        number = min(beside)
        tried.add(number)
        costs = _held(cut[0].prices, number, beside[number])
        graph = graph_of(assembly, contacts, joints, merger, costs)
        again = graph, label_all(graph.nodes, graph.seeds, graph.edges)
        if _broken(again) <= _broken(cut) and number not in _beside(joints, again, hints) and _parts(again, number):
            cut = again


def _bodies(cut: Cut, pair: PartPair) -> tuple[int | None, ...]:
    graph, labelling = cut
    return tuple(labelling.labels[graph.piece_of[name]] for name in pair)


def _across(cut: Cut) -> dict[int, list[PartPair]]:
    """The pairs between the two sides of each joint that it may part, of joints that have such."""
    graph = cut[0]
    between: dict[frozenset[int | None], list[int]] = {}
    for number, ends in enumerate(graph.sides):
        between.setdefault(frozenset(ends), []).append(number)
    out: dict[int, list[PartPair]] = {}
    for pair, parted in graph.prices.by_joint.items():
        for number in between.get(frozenset(_bodies(cut, pair)), ()):
            if number in parted:
                out.setdefault(number, []).append(pair)
    return out


def _beside(joints: Sequence[IntendedJoint], cut: Cut, hints: dict[PartPair, float]) -> dict[int, tuple[PartPair, ...]]:
    """What each joint parts that parts flats beside its axis only."""
    return {
        number: tuple(pairs)
        for number, pairs in sorted(_across(cut).items())
        if joints[number].type not in ("prismatic", "planar")
        and all(_plain(cut, number, pair, hints) > PARTED for pair in pairs)
    }


def _plain(cut: Cut, number: int, pair: PartPair, hints: dict[PartPair, float]) -> float:
    return cut[0].prices.by_joint[pair][number] - hints.get(pair, 0.0)


def _round(joint: IntendedJoint, number: int, cut: Cut, hints: dict[PartPair, float], contacts: Contacts) -> bool:
    """Whether anything in one of the joint's bodies goes round its axis that it may part."""
    ends = set(cut[0].sides[number])
    inside = [
        pair
        for pair, parted in cut[0].prices.by_joint.items()
        if number in parted
        and ROLLING < _plain(cut, number, pair, hints) <= PARTED
        and len(set(_bodies(cut, pair))) == 1
        and set(_bodies(cut, pair)) <= ends
    ]
    if not inside:
        return False
    wanted = set(inside)
    touching = contact_of_pairs([patch for patch in contacts.patches if patch.parts in wanted])
    return any(contact.near(joint) for contact in touching.values())


def _held(costs: Prices, number: int, pairs: Sequence[PartPair]) -> Prices:
    """The prices where a joint may not part some pairs."""
    by_joint = dict(costs.by_joint)
    for pair in pairs:
        by_joint[pair] = {k: price for k, price in by_joint[pair].items() if k != number}
    return replace(costs, by_joint=by_joint)


def _broken(cut: Cut) -> int:
    """How many contacts are parted that no joint of the two bodies may part."""
    graph, labelling = cut
    count = 0
    for edge in graph.edges:
        first, second = (labelling.labels[end] for end in edge.ends)
        count += first is not None and second is not None and first != second and (first, second) not in edge.parted
    return count


def _parts(cut: Cut, number: int) -> bool:
    """Whether the joint is between two bodies, and parts something."""
    return len(set(cut[0].sides[number])) == 2 and number in _across(cut)
