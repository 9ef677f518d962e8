"""The search for labels that are one body, region by region, beside one that cuts the whole graph anew every time."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
from hypothesis import event, given, settings
from hypothesis import strategies as st

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition.labelling import JAMMED, Edge, label_all
from kinform.kinematics.partition.loops import Loops
from kinform.kinematics.partition.merge_search import LOOK_AHEAD, MOST_CUTS, MergeSearch

PRICES = (1.0, 30.0, 40.0, 300.0, 5030.0)
TURN = np.array([[0.0, 0.0, 1.0]])


@st.composite
def graphs(draw):
    """A seed for each label, free nodes, contacts in a row and some more, joints, and labels that are one at first."""
    labels, free = draw(st.integers(4, 11)), draw(st.integers(0, 12))
    some = st.integers(0, labels - 1)
    joints = [
        (a, b) if draw(st.booleans()) else (b, a)
        for a, b in zip(range(0, labels - 1, 2), range(1, labels, 2), strict=False)
    ]
    joints += [ends for ends in draw(st.lists(st.tuples(some, some), max_size=3)) if ends[0] != ends[1]]
    if labels % 2:
        joints.append((labels - 1, 0))
    count = labels + free
    node = st.integers(0, count - 1)
    order = draw(st.permutations(range(count)))
    pairs = [*zip(order, order[1:], strict=False), *draw(st.lists(st.tuples(node, node), max_size=count))]
    jointed = frozenset(ends for a, b in joints for ends in ((a, b), (b, a)))
    edges = []
    for number, ends in enumerate(dict.fromkeys(tuple(sorted(pair)) for pair in pairs if pair[0] != pair[1])):
        touch = draw(st.sampled_from([0.125, 0.25, 0.375])) + number / 1024.0  # no two ways cost the same
        table = {}
        for k in draw(st.lists(st.integers(0, len(joints) - 1), max_size=3)):
            for sides in (joints[k], joints[k][::-1]):
                table[sides] = min(draw(st.sampled_from(PRICES)) + touch, table.get(sides, np.inf))
        broken = draw(st.sampled_from([300.0, 20000.0])) + touch
        edges.append(Edge(ends, table, broken, 0.0, jointed if draw(st.booleans()) else frozenset()))
    together = UnionFind(labels)
    for a, b in draw(st.lists(st.tuples(some, some), max_size=2)):
        together.union(a, b)
    start = [together.find(k) for k in range(labels)]
    loops = Loops(
        [np.hstack([TURN, [[k % 3, k // 3, 0.0]]]) for k in range(len(joints))], joints, 3.0, draw(st.booleans())
    )
    return labels, count, edges, joints, start, draw(st.sampled_from([None, loops]))


class Whole:
    """The same search on the whole graph: its edges with new labels, and all its nodes labelled, for every way."""

    def __init__(self, labels, count, edges, joints, loops):
        self.seeds = {k: k for k in range(labels)}
        self.count, self.edges, self.joints, self.loops = count, edges, joints, loops
        self.looked_at, self.cuts, self.leasts = set(), {}, {}

    def cut(self, now):
        if tuple(now) not in self.cuts:
            edges = [relabelled(edge, now) for edge in self.edges]
            seeds = {node: now[label] for node, label in self.seeds.items()}
            labels = label_all(self.count, seeds, edges).labels
            self.cuts[tuple(now)] = [(edge, *(labels[end] for end in edge.ends)) for edge in edges]
        return self.cuts[tuple(now)]

    def parted(self, now):
        self.looked_at.add(tuple(now))
        out = {}
        for edge, a, b in self.cut(now):
            if a is not None and b is not None and a != b:
                pair = min(a, b), max(a, b)
                out[pair] = out.get(pair, 0) + Fraction(edge.price(a, b))
        return out

    def cost(self, now):
        return sum(self.parted(now).values())

    def sets(self, now):
        sets = UnionFind(len(now))
        for pair in [*enumerate(now), *self.joints]:
            sets.union(*pair)
        return [sets.find(label) for label in range(len(now))]

    def joins(self, now, first, second):
        sets = self.sets(now)
        if sets[first] != sets[second]:
            return True
        way = one(now, first, second)
        if self.loops is None or not self.loops.move(way):
            return False
        return not self.loops.connected or self.asked(now, way)

    def asked(self, now, way):
        before, after = self.about(now), self.about(way)
        if any(k not in {j for j, _ in before} and ends not in {e for _, e in before} for k, ends in after):
            return True
        broken = {e.ends for e, a, b in self.cut(now) if a is not None and b is not None and e.price(a, b) >= e.broken}
        return bool(broken & {ends for _, ends in after})

    def about(self, now):
        return {
            (k, edge.ends)
            for edge, a, b in self.cut(now)
            if None not in (a, b) and a != b and (a, b) in edge.parted and edge.plain(a, b) <= 100.5
            for k, sides in enumerate(self.joints)
            if {now[side] for side in sides} == {a, b}
        }

    def ways(self, now):
        return [one(now, *pair) for pair in sorted(self.parted(now)) if self.joins(now, *pair)]

    def least(self, now):
        if tuple(now) not in self.leasts:
            self.leasts[tuple(now)] = min([self.cost(now), *(self.least(way) for way in self.ways(now))])
        return self.leasts[tuple(now)]

    def joined(self, now):
        while ways := self.ways(now):
            deep = len(set(self.sets(now))) <= LOOK_AHEAD
            for way in ways:
                self.cost(way)
            cost, best = min((self.least(way) if deep else self.cost(way), way) for way in ways)
            if cost >= self.cost(now):
                break
            now = best
        return now


def one(now, first, second):
    return [first if label == second else label for label in now]


def relabelled(edge, now):
    table = {}
    for (a, b), price in edge.parted.items():
        if now[a] != now[b]:
            table[now[a], now[b]] = min(price, table.get((now[a], now[b]), price))
    jointed = {(now[a], now[b]) for a, b in edge.jointed if now[a] != now[b]}
    return Edge(edge.ends, table, edge.broken, edge.hint, frozenset(jointed))


@settings(max_examples=5, deadline=None)
@given(graphs())
def test_what_is_joined_and_what_it_costs_is_what_cutting_the_whole_graph_tells(graph):
    labels, count, edges, joints, start, loops = graph
    whole = Whole(labels, count, edges, joints, loops)
    search = MergeSearch(whole.seeds, edges, joints, loops)
    cut = search.cuts.cut(start)
    wanted = whole.joined(start)
    found = search.joined(cut)
    event(f"{len(set(start)) - len(set(wanted))} joined")
    assert list(found.now) == wanted
    assert Fraction(found.cost, 2**52) == whole.cost(wanted)
    assert {pair: Fraction(cost, 2**52) for pair, (_, cost) in found.parted.items()} == whole.parted(wanted)
    assert search.on_axes(found) == whole.about(wanted)
    assert len(search._looked_at) == min(len(whole.looked_at), MOST_CUTS + 1)


@settings(max_examples=15, deadline=None)
@given(graphs(), st.data())
def test_a_cut_that_is_changed_step_by_step_is_the_cut_from_the_start(graph, data):
    labels, _, edges, joints, start, _ = graph
    cuts = MergeSearch({k: k for k in range(labels)}, edges, joints, None).cuts
    cut = cuts.cut(start)
    for _ in range(5):
        many = [label for label, body in enumerate(cut.now) if len(cut.bodies[body]) > 1]
        if many and data.draw(st.booleans()):
            cut = cuts.after(cut, cuts.leaving(cut, data.draw(st.sampled_from(many))))
        elif len(cut.bodies) > 1:
            pair = sorted(data.draw(st.permutations(sorted(cut.bodies)))[:2])
            cut = cuts.after(cut, cuts.joining(cut, *pair))
        fresh = cuts.cut(cut.now)
        assert (cut.parted, cut.cost, cut.bodies) == (fresh.parted, fresh.cost, fresh.bodies)
        assert {body: k for body, k in cut.near.items() if k} == {body: k for body, k in fresh.near.items() if k}


@settings(max_examples=10, deadline=None)
@given(graphs(), st.data())
def test_the_cost_of_a_merge_stays_until_a_merge_that_concerns_it(graph, data):
    labels, _, edges, joints, start, _ = graph
    cuts = MergeSearch({k: k for k in range(labels)}, edges, joints, None).cuts
    cut = cuts.cut(start)
    known = {pair: cuts.joining(cut, *pair) for pair in combinations(sorted(cut.bodies), 2)}
    for pair in data.draw(st.permutations(sorted(known)))[:8]:
        after = cuts.after(cut, known[pair])
        for other in data.draw(st.permutations(sorted(known)))[:8]:
            if known[other].met.isdisjoint(pair):
                assert cuts.joining(after, *other).cost == known[other].cost


def test_the_cost_of_a_merge_depends_on_bodies_with_a_joint_to_either():
    """A and X have joints with D, and a region that touches neither also C: when C and D are one it touches both."""
    a, x, c, d, e, one, other = range(7)
    joints = [(a, d), (x, d), (c, e)]
    jams = frozenset({(c, e), (e, c)})
    edges = [
        Edge((c, one), {(a, d): 1.0, (d, a): 1.0}, 20000.0, 0.0, jams),
        Edge((c, other), {(x, d): 1.0, (d, x): 1.0}, 20000.0, 0.0, jams),
        Edge((e, one), {}, 1000.0, 0.0, jams),
        Edge((e, other), {}, 1000.0, 0.0, jams),
        Edge((one, other), {}, 500.0),
    ]
    cuts = MergeSearch({k: k for k in range(5)}, edges, joints, None).cuts
    cut = cuts.cut(range(5))
    known = cuts.joining(cut, a, x)
    assert not known.cost
    later = cuts.joining(cuts.after(cut, cuts.joining(cut, c, d)), a, x)
    assert Fraction(later.cost, 2**52) == 2 * (1.0 - JAMMED)
    assert not known.met.isdisjoint((c, d))
