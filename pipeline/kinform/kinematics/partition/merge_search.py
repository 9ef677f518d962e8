"""Search for the labels to merge: the merges and moves that leave the least cost of separated contact.

The best merge is taken again and again; where few sets of connected joints are left, all sequences of merges are tried.
Costs are computed region by region (`cuts`), and again only where a later merge concerns them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import islice

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition.constants import FASTENED, PARTED
from kinform.kinematics.partition.cuts import Change, Cut, Cuts, Joined, whole
from kinform.kinematics.partition.labelling import Edge, Labels
from kinform.kinematics.partition.loops import Loops
from kinform.model.arrays import Array

MOST_CUTS = 600
"""So many ways of joining names are cut at most; then the best so far is taken. Chosen, not measured."""
LOOK_AHEAD = 4
"""Up to so many sets of joints that hang together all ways of joining their names are looked at. Chosen, not
measured."""


class MergeSearch:
    """Which labels to merge, by the cost of what is separated then."""

    def __init__(
        self, seeds: Mapping[int, int], edges: Sequence[Edge], joints: Sequence[Labels], loops: Loops | None
    ) -> None:
        self.seeds, self.edges, self.joints, self.loops = seeds, edges, joints, loops
        self.nodes = 1 + max([*seeds, *(node for edge in edges for node in edge.ends)], default=-1)
        self.cuts = Cuts(self.nodes, seeds, edges, joints)
        self._least: dict[Joined, int] = {}
        self._looked_at: set[Joined] = set()

    def settled(self, start: Sequence[int]) -> tuple[list[int], set[int]]:
        """The best that is found from there by joining labels and moving them, and what could be elsewhere."""
        cut = self.joined(self.cuts.cut(start))
        while True:
            better, close = self.moved(cut)
            if better is None:
                return list(cut.now), close
            cut = better

    def joined(self, cut: Cut) -> Cut:
        """A cut with those labels joined that leave the least to be parted."""
        known: dict[Labels, Change] = {}
        self.look_at(cut.now)
        while True:
            sets = self.hanging(cut.now)
            ways = self.ways(cut, sets)
            if not ways:
                return cut
            for pair in ways:
                if pair not in known:
                    known[pair] = self.cuts.joining(cut, *pair)
                self.look_at(cut.now, pair)
            if sum(sets.find(label) == label for label in range(len(cut.now))) <= LOOK_AHEAD:
                gain, pair = min((self.least(self.after(cut, pair)) - cut.cost, pair[::-1]) for pair in ways)
            else:
                gain, pair = min((known[pair].cost, pair[::-1]) for pair in ways)
            if gain >= 0:
                return cut
            cut = self.after(cut, pair[::-1])
            known = {other: change for other, change in known.items() if change.met.isdisjoint(pair)}

    def after(self, cut: Cut, pair: Labels) -> Cut:
        """The cut with two bodies joined."""
        return self.cuts.after(cut, self.cuts.joining(cut, *pair))

    def least(self, cut: Cut) -> int:
        """The cost of the best that may follow."""
        if cut.now not in self._least:
            self.look_at(cut.now)
            after = [self.after(cut, pair) for pair in self.ways(cut, self.hanging(cut.now))]
            self._least[cut.now] = min([cut.cost, *(self.least(way) for way in after)])
        return self._least[cut.now]

    def look_at(self, now: Joined, pair: Labels | None = None) -> None:
        """Count the ways of joining labels that were looked at, with these two bodies joined, up to the most."""
        if len(self._looked_at) <= MOST_CUTS:
            self._looked_at.add(now if pair is None else tuple(pair[0] if one == pair[1] else one for one in now))

    def moved(self, cut: Cut) -> tuple[Cut | None, set[int]]:
        """A cut with one label taken from those that it is one with and joined to others, where that saves as much as
        screw holes cost; else None, and the labels that this would touch at less or nearly the same cost. If only
        journals part, all stay."""
        close: set[int] = set()
        if not any(share.dear for share in cut.shares):
            return None, close
        for label, body in enumerate(cut.now):
            if len(cut.bodies[body]) == 1:
                continue
            if len(self._looked_at) > MOST_CUTS:
                return None, close
            apart = self.cuts.after(cut, self.cuts.leaving(cut, label))
            self.look_at(apart.now)
            for pair in self.likely(apart):
                way = self.cuts.joining(apart, *pair)
                self.look_at(way.now)
                dearer = apart.cost + way.cost - cut.cost
                if dearer <= -whole(FASTENED["holes"]):
                    return self.cuts.after(apart, way), close
                if dearer < whole(PARTED):
                    close |= _differing(cut.now, way.now)
        return None, close

    def hanging(self, now: Sequence[int]) -> UnionFind:
        """Sets of labels that joints hang together."""
        sets = UnionFind(len(now))
        for label, other in enumerate(now):
            sets.union(label, other)
        for pair in self.joints:
            sets.union(*pair)
        return sets

    def ways(self, cut: Cut, sets: UnionFind) -> list[Labels]:
        """Two bodies each that touch, and that may be one, sorted."""
        return [pair for pair in sorted(cut.parted) if self.joins(cut, sets, pair)]

    def likely(self, cut: Cut) -> list[Labels]:
        """Two bodies that joints do not hang together: the few with most between them, and those that contact joins
        most firmly."""
        sets = self.hanging(cut.now)

        def few(pairs: Iterable[Labels]) -> list[Labels]:
            # Six of the bodies that a name may be moved to are tried: those that contact joins most firmly. Chosen, not
            # measured.
            return list(islice((pair for pair in pairs if self.joins(cut, sets, pair)), 6))

        across = sorted((-cost, pair) for pair, (_, cost) in cut.parted.items())
        return list(dict.fromkeys([*few(pair for _, pair in across), *few(self.firmest(cut))]))

    def firmest(self, cut: Cut) -> Iterable[Labels]:
        """Two bodies each, those first that contact joins most firmly."""
        bodies = sorted(cut.bodies)
        order = [label for body in bodies for label in cut.bodies[body]]
        start = np.cumsum([0, *(len(cut.bodies[body]) for body in bodies[:-1])])
        firm = np.maximum.reduceat(np.maximum.reduceat(self.firm[np.ix_(order, order)], start, 0), start, 1)
        first, second = np.triu_indices(len(bodies), 1)
        for k in np.argsort(-firm[first, second], kind="stable"):
            yield bodies[first[k]], bodies[second[k]]

    def joins(self, cut: Cut, sets: UnionFind, pair: Labels) -> bool:
        """Whether two bodies may be one: joints do not hang them together, or the loop can move, and where names alone
        connect all joints a joint finds what goes round its axis only then."""
        first, second = pair
        if sets.find(first) != sets.find(second):
            return True
        if self.loops is None or any(
            cut.now[other] == second for label in cut.bodies[first] for other in self.cuts.partners.get(label, ())
        ):
            return False
        way = [first if body == second else body for body in cut.now]
        if not self.loops.move(way):
            return False
        return not self.loops.connected or self.asked(cut, pair)

    def asked(self, cut: Cut, pair: Labels) -> bool:
        """Whether a joint has something that goes round its axis only if two bodies are one: what none may part else,
        or what is inside of one body else."""
        before = self.on_axes(cut)
        after = self.on_axes(self.after(cut, pair))
        having, others = {joint for joint, _ in before}, {ends for _, ends in before}
        if any(joint not in having and ends not in others for joint, ends in after):
            return True
        broken = {ends for share in cut.shares for ends in share.broken}
        return bool(broken & {ends for _, ends in after})

    def on_axes(self, cut: Cut) -> set[tuple[int, tuple[int, int]]]:
        """What joints part that goes round their axis: the joint, and the nodes."""
        between: dict[Labels, list[int]] = {}
        for k, sides in enumerate(self.joints):
            first, second = sorted(cut.now[one] for one in sides)
            between.setdefault((first, second), []).append(k)
        return {(k, ends) for share in cut.shares for pair, ends in share.about for k in between.get(pair, ())}

    @cached_property
    def firm(self) -> Array:
        """(labels, labels) by how firm a chain of contacts each two are joined: the weakest of it, whatever is
        parted."""
        count = 1 + max((max(pair) for pair in self.joints), default=-1)
        out = np.zeros((count, count))
        sets = UnionFind(self.nodes)
        inside = {node: [label] for node, label in self.seeds.items()}
        holds = [min([edge.broken, *edge.parted.values()]) for edge in self.edges]
        for k in sorted(range(len(holds)), key=lambda k: (-holds[k], self.edges[k].ends)):
            a, b = (sets.find(end) for end in self.edges[k].ends)
            if a == b:
                continue
            ones, others = inside.pop(a, []), inside.pop(b, [])
            if ones and others:
                out[np.ix_(ones, others)] = out[np.ix_(others, ones)] = holds[k]
            sets.union(a, b)
            inside[sets.find(a)] = [*ones, *others]
        return out


def _differing(one: Sequence[int], other: Sequence[int]) -> set[int]:
    """Labels that are one with others here than there."""
    here, there = _sets(one), _sets(other)
    return {k for k, pair in enumerate(zip(one, other, strict=True)) if here[pair[0]] != there[pair[1]]}


def _sets(now: Sequence[int]) -> dict[int, list[int]]:
    """The labels that are each body."""
    out: dict[int, list[int]] = {}
    for label, body in enumerate(now):
        out.setdefault(body, []).append(label)
    return out
