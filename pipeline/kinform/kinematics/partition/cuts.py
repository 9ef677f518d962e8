"""What is parted when labels are joined, region by region: only what a joining touches is asked anew.

A region is what seeds separate: nodes without a seed that contacts connect, with all contacts around them. Seeds stay
where they are whichever labels are one, so regions do; a contact between two seeds is one by itself. What a region's
nodes become, and what is parted in it, hangs on its candidates alone: the bodies that it touches, and those across
their joints. So joining or parting bodies concerns the regions that have one of them for a
candidate, and no other. What joining two bodies costs stays what it is as long as none of the bodies is joined that
are candidates in those regions, before or after, or that have a joint with one of the two (`Change.met`).

Costs are whole numbers, of 2⁻⁵² each: prices are 1 or more, so that they are exact, and their sums do not hang on an
order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set

from kinform.frozen import dataclass
from kinform.kinematics.partition.constants import PARTED, TOUCH_WORTH
from kinform.kinematics.partition.labelling import Edge, Labels, labels_of, regions

Joined = tuple[int, ...]
"""Of every label, the least of those that are one body with it."""


def whole(price: float) -> int:
    """A price as costs are counted."""
    return int(price * 2.0**52)


@dataclass(frozen=True, eq=False)
class Region:
    """Nodes without a seed that contacts connect, and the contacts around them; or one contact between two seeds."""

    nodes: tuple[int, ...]
    edges: tuple[Edge, ...]
    seeds: Mapping[int, int]
    """Labels of the seeds that it touches."""
    tables: frozenset[Labels]
    """Labels for which any of its contacts is parted by a joint."""


@dataclass(frozen=True, eq=False)
class Share:
    """What is parted in a region."""

    candidates: frozenset[int]
    parted: Mapping[Labels, int]
    """Its cost between every two bodies."""
    cost: int
    dear: bool
    """Whether any of it costs more than serrations."""
    about: tuple[tuple[Labels, tuple[int, int]], ...]
    """What joints part that goes round their axis: the two bodies, and the nodes."""
    broken: tuple[tuple[int, int], ...]
    """The nodes of what no joint of the two bodies may part."""


@dataclass(frozen=True, eq=False)
class Cut:
    """What is parted when some labels are one."""

    now: Joined
    bodies: Mapping[int, tuple[int, ...]]
    """The labels that are each body, which is called by the least."""
    shares: Sequence[Share]
    """Of the regions."""
    near: Mapping[int, frozenset[int]]
    """The regions that have a body for a candidate."""
    parted: Mapping[Labels, tuple[int, int]]
    """Between every two bodies that touch: in how many regions, and at what cost."""
    cost: int


@dataclass(frozen=True, eq=False)
class Change:
    """What is otherwise in a cut when other labels are one."""

    now: Joined
    bodies: Mapping[int, tuple[int, ...]]
    shares: Mapping[int, Share]
    """Of the regions that it concerns."""
    cost: int
    """By how much it is dearer."""
    met: Set[int]
    """The bodies on which that depends."""


class Cuts:
    """The cuts of a graph, by which labels are one. `joints` are the labels of their sides: those of `Edge.parted`."""

    def __init__(self, nodes: int, seeds: Mapping[int, int], edges: Sequence[Edge], joints: Sequence[Labels]) -> None:
        self.partners: dict[int, tuple[int, ...]] = {}
        for one, other in sorted({ends for a, b in joints if a != b for ends in ((a, b), (b, a))}):
            self.partners[one] = (*self.partners.get(one, ()), other)
        self.regions = [_region((), (edge,), seeds) for edge in edges if set(edge.ends) <= seeds.keys()]
        self.regions += [_region(members, near, seeds) for members, near in regions(nodes, seeds, edges)]
        self._known: list[dict[object, Share]] = [{} for _ in self.regions]

    def cut(self, now: Sequence[int]) -> Cut:
        """The cut where label k is the body now[k]."""
        bodies: dict[int, tuple[int, ...]] = {}
        for label, body in enumerate(now):
            bodies[body] = (*bodies.get(body, ()), label)
        seen = _Joints(now, bodies, self.partners)
        shares = {k: self._share(k, seen) for k in range(len(self.regions))}
        nothing = Share(frozenset(), {}, 0, False, (), ())
        empty = Cut((), {}, [nothing] * len(shares), {}, {}, 0)
        cost = sum(share.cost for share in shares.values())
        return self.after(empty, Change(tuple(now), bodies, shares, cost, set()))

    def joining(self, cut: Cut, first: int, second: int) -> Change:
        """What is otherwise when the second body is one with the first."""
        now = list(cut.now)
        for label in cut.bodies[second]:
            now[label] = first
        bodies = dict(cut.bodies)
        bodies[first] = tuple(sorted((*bodies[first], *bodies.pop(second))))
        return self._change(cut, tuple(now), bodies, {first, second})

    def leaving(self, cut: Cut, label: int) -> Change:
        """What is otherwise when a label is none with the rest of its body, which has others."""
        body = cut.now[label]
        rest = tuple(one for one in cut.bodies[body] if one != label)
        now = list(cut.now)
        for one in rest:
            now[one] = rest[0]
        now[label] = label
        bodies = dict(cut.bodies) | {label: (label,), rest[0]: rest}
        return self._change(cut, tuple(now), bodies, {body, label, rest[0]})

    def after(self, cut: Cut, change: Change) -> Cut:
        """The cut with the change."""
        shares, near, parted = list(cut.shares), dict(cut.near), dict(cut.parted)
        gone: dict[int, set[int]] = {}
        come: dict[int, set[int]] = {}
        for k, share in change.shares.items():
            before, shares[k] = shares[k], share
            for body in before.candidates - share.candidates:
                gone.setdefault(body, set()).add(k)
            for body in share.candidates - before.candidates:
                come.setdefault(body, set()).add(k)
            for sign, part in ((-1, before.parted), (1, share.parted)):
                for pair, cost in part.items():
                    count, total = parted.get(pair, (0, 0))
                    parted[pair] = (count + sign, total + sign * cost)
                    if not count + sign:
                        del parted[pair]
        for body in gone.keys() | come.keys():
            near[body] = (near.get(body, frozenset()) - gone.get(body, set())) | come.get(body, set())
        return Cut(change.now, change.bodies, shares, near, parted, cut.cost + change.cost)

    def _change(self, cut: Cut, now: Joined, bodies: Mapping[int, tuple[int, ...]], concerned: Iterable[int]) -> Change:
        """What is otherwise when labels of these bodies, before or after, are joined in another way."""
        seen = _Joints(now, bodies, self.partners)
        shares = {}
        cost = 0
        met = set(concerned)
        for body in tuple(met):
            met.update(seen.of(body))
        for k in {k for body in concerned for k in cut.near.get(body, ())}:
            before, share = cut.shares[k], self._share(k, seen)
            shares[k] = share
            cost += share.cost - before.cost
            met |= before.candidates
            met |= share.candidates
        return Change(now, bodies, shares, cost, met)

    def _share(self, number: int, joints: _Joints) -> Share:
        """What is parted in a region."""
        region = self.regions[number]
        seeds = {node: joints.now[label] for node, label in region.seeds.items()}
        candidates = set(seeds.values())
        if region.nodes:
            for body in tuple(candidates):
                for other, pairs in joints.of(body).items():
                    if other not in candidates and not region.tables.isdisjoint(pairs):
                        candidates.add(other)
        hinges = {
            (body, other): pairs
            for body in sorted(candidates)
            for other, pairs in joints.of(body).items()
            if other in candidates
        }
        known = self._known[number]
        key = tuple(seeds.values()), tuple(hinges.items())
        if key not in known:
            known[key] = _share(region, frozenset(candidates), seeds, hinges)
        return known[key]


class _Joints:
    """The joints between bodies."""

    def __init__(
        self, now: Sequence[int], bodies: Mapping[int, tuple[int, ...]], partners: Mapping[int, tuple[int, ...]]
    ) -> None:
        self.now, self.bodies, self.partners = now, bodies, partners
        self._of: dict[int, dict[int, tuple[Labels, ...]]] = {}

    def of(self, body: int) -> Mapping[int, tuple[Labels, ...]]:
        """The bodies that have a joint with one, and the labels of those joints."""
        if body not in self._of:
            found: dict[int, list[Labels]] = {}
            for label in self.bodies.get(body, ()):
                for other in self.partners.get(label, ()):
                    if self.now[other] != body:
                        found.setdefault(self.now[other], []).append((label, other))
            self._of[body] = {other: tuple(pairs) for other, pairs in found.items()}
        return self._of[body]


def _region(nodes: Sequence[int], edges: Sequence[Edge], seeds: Mapping[int, int]) -> Region:
    touched = {node: seeds[node] for edge in edges for node in edge.ends if node in seeds}
    return Region(tuple(nodes), tuple(edges), touched, frozenset().union(*(edge.parted for edge in edges)))


def _share(
    region: Region, candidates: frozenset[int], seeds: Mapping[int, int], hinges: Mapping[Labels, Sequence[Labels]]
) -> Share:
    """What is parted in a region where its seeds have these labels, and these joints are between its candidates."""
    edges = [_between(edge, hinges) for edge in region.edges]
    labels = labels_of(region.nodes, sorted(candidates), edges, seeds)[0] if region.nodes and candidates else {}
    parted: dict[Labels, int] = {}
    dear, about, broken = False, [], []
    for edge in edges:
        first, second = (seeds.get(end, labels.get(end)) for end in edge.ends)
        if first is None or second is None or first == second:
            continue
        price, pair = edge.price(first, second), (min(first, second), max(first, second))
        parted[pair] = parted.get(pair, 0) + whole(price)
        dear |= price > PARTED
        if price >= edge.broken:
            broken.append(edge.ends)
        if (first, second) in edge.parted and edge.plain(first, second) <= PARTED + TOUCH_WORTH:
            about.append((pair, edge.ends))
    return Share(candidates, parted, sum(parted.values()), dear, tuple(about), tuple(broken))


def _between(edge: Edge, hinges: Mapping[Labels, Sequence[Labels]]) -> Edge:
    """The edge with prices for bodies: the least of those of the joints between them."""
    table = {}
    for bodies, joints in hinges.items():
        prices = [edge.parted[labels] for labels in joints if labels in edge.parted]
        if prices:
            table[bodies] = min(prices)
    jointed = (bodies for bodies, joints in hinges.items() if not edge.jointed.isdisjoint(joints))
    return Edge(edge.ends, table, edge.broken, edge.hint, frozenset(jointed))
