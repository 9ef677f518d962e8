"""Bodies from the function: every part's body, what holds it there, and what is not clear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace

import fcl
import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.current_work import working_on
from kinform.foundation.graphs.graph import UnionFind, shortest_path
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose
from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.kinematics.partition.contact import PartPair
from kinform.kinematics.partition.graph import Graph, graph_of, stated_merger
from kinform.kinematics.partition.labelling import Labelling, Margin, label_all, margins
from kinform.kinematics.partition.on_axis import cut_on_axes
from kinform.kinematics.partition.standard_parts import StandardPart, standard_parts
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import MembershipCause
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

EITHER = 25.0
"""Margin up to which a part may go either way: less than the price of a flange."""
EITHER_WAY = 150.0
"""The same without what suggests that parts are fastened, where joints may part all that would be parted: half a flat
beside the axis, more than three journals. Horns are screwed to what they drive or to what drives them, and screw holes
line up either way. On 17 robots the greatest of a part whose author put it elsewhere is 70, and no part's lies between
120 and 200: with 300 as many are listed for nothing as for a reason."""
HELD_ACROSS = 250.0
"""Price beyond which contact that was parted, a flat beside the axis or more, says that bodies guessed from different
names are not sure. Less than `FLAT_BESIDE`."""
NAMED_HOLDS = 3
"""Of the parts that hold another in its body, or that it was parted from, so many are named. Chosen, not measured."""


@dataclass(frozen=True)
class Placed:
    """A part in its body."""

    part: PartName
    body: int
    how: MembershipCause
    margin: float
    """By how much another body would be dearer; infinite where no other comes into question."""
    other: int | None
    """The body that is next best."""
    along: tuple[PartName, ...] = ()
    """Parts that would go there with it."""
    either: bool = False
    """Whether it could as well be elsewhere by contact alone, as far as joints may part it; of what touches nothing,
    always."""
    evidence: str = ""
    """What holds it there, what was parted, and which standard part it is."""

    @property
    def unclear(self) -> bool:
        """Whether it could go either way."""
        return self.either or self.margin < EITHER


@dataclass(frozen=True, eq=False)
class Partition:
    """Which parts move as one."""

    names: tuple[str, ...]
    """Of the bodies: the first name that a joint gives it."""
    parts: tuple[tuple[PartName, ...], ...]
    placed: Mapping[PartName, Placed]
    unparted: Mapping[str, tuple[PartName, ...]] = field(default_factory=dict)
    """Joints whose two sides contact holds together, with a chain of parts from one side to the other."""
    proven: bool = True

    @property
    def unclear(self) -> tuple[Placed, ...]:
        """Parts that could go either way, sorted by name."""
        return tuple(p for _, p in sorted(self.placed.items()) if p.unclear)


def partition(
    assembly: Assembly,
    contacts: Contacts,
    joints: Sequence[IntendedJoint],
    surfaces: Mapping[str, MeshSurfaces] | None = None,
) -> Partition:
    """The bodies that the intended joints ask for; every part of the assembly is in one. `surfaces` tell standard
    parts, which is evidence for the reader and decides nothing.

    Groups and assumptions stand. The result does not depend on the order of parts or joints.
    """
    joints = sorted(joints, key=lambda joint: joint.name)
    merger = stated_merger(assembly, joints)
    moving = [joint for joint in joints if joint.type != "fixed"]
    graph = graph_of(assembly, contacts, moving, merger)
    cut = graph, label_all(graph.nodes, graph.seeds, graph.edges)
    graph, labelling = cut_on_axes(assembly, contacts, moving, merger, cut)
    placed = _placed(assembly, graph, labelling)
    doubtful = _doubtful(graph, labelling)
    placed = {name: replace(p, either=p.either or p.body in doubtful) for name, p in placed.items()}
    known = {} if surfaces is None else standard_parts(assembly, surfaces)
    placed = {name: replace(p, evidence=_evidence(graph, placed, p, known.get(name))) for name, p in placed.items()}
    parts = tuple(
        tuple(sorted(name for name, p in placed.items() if p.body == label)) for label in range(len(graph.names))
    )
    return Partition(graph.names, parts, placed, _unparted(graph, moving, placed), labelling.proven)


def _placed(assembly: Assembly, graph: Graph, labelling: Labelling) -> dict[PartName, Placed]:
    """Every part in its body; what touches none of them, with what it touches, in that of the nearest part."""
    margin = margins(labelling.labels, graph.seeds, graph.edges)
    labels = list(labelling.labels)
    placed: dict[PartName, Placed] = {}
    members: dict[int, list[PartName]] = {}
    for name, piece in graph.piece_of.items():
        members.setdefault(piece, []).append(name)
    shaped = {part.name for part in assembly.parts if part.mesh is not None}
    lost = [name for name in sorted(graph.piece_of) if labels[graph.piece_of[name]] is None and name in shaped]
    known = [name for name in sorted(graph.piece_of) if labels[graph.piece_of[name]] is not None]
    for name in known:
        piece = graph.piece_of[name]
        label = labels[piece]
        assert label is not None
        if piece in graph.seeds:
            placed[name] = Placed(name, label, "held", float("inf"), None)
            continue
        m = margin.get(piece, Margin(float("inf"), None, (), moves=False))
        along = tuple(sorted(part for n in m.along for part in members[n] if part != name))
        placed[name] = Placed(name, label, "cut", m.cost, m.label, along, m.plain < EITHER_WAY)
    models: dict[PartName, fcl.BVHModel] = {}
    for cluster in _touching(graph, lost):
        ways = [(*found, name) for name in cluster if (found := _nearest(assembly, name, known, models)) is not None]
        label = placed[min(ways)[1]].body if ways else 0
        for name in cluster:
            placed[name] = Placed(name, label, "nearest", 0.0, None, (), either=True)
    return placed


def _touching(graph: Graph, names: Sequence[PartName]) -> list[list[PartName]]:
    """Of these parts those that touch one another, as balls and their cage: they stay together."""
    index = {name: k for k, name in enumerate(names)}
    sets = UnionFind(len(names))
    for name in names:
        for pair in graph.pairs_of.get(name, ()):
            if pair[0] in index and pair[1] in index:
                sets.union(index[pair[0]], index[pair[1]])
    out: dict[int, list[PartName]] = {}
    for name in names:
        out.setdefault(sets.find(index[name]), []).append(name)
    return list(out.values())


def _doubtful(graph: Graph, labelling: Labelling) -> set[int]:
    """Bodies that were guessed from parts with different names, where contact that was parted may as well say that
    they are others: all of them then, with those that it lies between, and those that joints connect with them."""
    out: set[int] = set(graph.open)
    for edge in graph.edges if graph.guessed else ():
        first, second = (labelling.labels[end] for end in edge.ends)
        if first is not None and second is not None and edge.price(first, second) > HELD_ACROSS:
            out |= {first, second, *graph.guessed}
    return out | {body for ends in graph.sides if out & set(ends) for body in ends}


def _evidence(graph: Graph, placed: Mapping[PartName, Placed], one: Placed, standard: StandardPart | None) -> str:
    """As in "held by plate; parted from motor; screw: named 'bolt'"."""
    inside: list[tuple[float, PartName]] = []
    across: list[tuple[float, PartName]] = []
    for pair in graph.pairs_of.get(one.part, ()):
        other = pair[0] if pair[1] == one.part else pair[1]
        parted = graph.prices.by_joint[pair]
        hold = min(parted.values(), default=graph.prices.held[pair])
        (inside if placed[other].body == one.body else across).append((-hold, other))
    words = []
    for side, what in ((inside, "held by"), (across, "parted from")):
        names = [name for _, name in sorted(side)]
        rest = len(names) - NAMED_HOLDS
        more = f" and {counted(rest, 'more part')}" if rest > 0 else ""
        if names:
            words.append(f"{what} {quoted(names[:NAMED_HOLDS])}{more}")
    if standard is not None:
        words.append(f"{standard.kind}: {standard.evidence}")
    return "; ".join(words)


def _unparted(
    graph: Graph, joints: Sequence[IntendedJoint], placed: Mapping[PartName, Placed]
) -> dict[str, tuple[PartName, ...]]:
    """Of joints that may not part all that touches between their bodies, the shortest chain of parts that holds the
    two sides together, from one to the other."""
    between: dict[frozenset[int], list[PartPair]] = {}
    for pair in graph.prices.by_joint:
        between.setdefault(frozenset(placed[part].body for part in pair), []).append(pair)
    out = {}
    for number, (joint, ends) in enumerate(zip(joints, graph.sides, strict=True)):
        within = {frozenset(bodies) for bodies in (ends, ends[:1], ends[1:])}
        near: dict[PartName, list[PartName]] = {}
        for pair in sorted(pair for bodies in within for pair in between.get(bodies, ())):
            if number not in graph.prices.by_joint[pair]:
                for one, other in (pair, pair[::-1]):
                    near.setdefault(one, []).append(other)
        chain = shortest_path(near, *graph.named[number])
        if chain:
            out[joint.name] = tuple(chain)
    return out


def _nearest(
    assembly: Assembly, name: PartName, among: Sequence[PartName], models: dict[PartName, fcl.BVHModel]
) -> tuple[float, PartName] | None:
    """Metres to the part whose surface is nearest, of the few whose boxes are; the first by name of several."""
    low, high = _box(assembly, name)
    apart = []
    for other in among:
        if assembly.part(other).mesh is not None:
            low_o, high_o = _box(assembly, other)
            gap = norm(np.maximum(np.maximum(low - high_o, low_o - high), 0.0))
            middle = norm(low + high - low_o - high_o)
            apart.append((gap, middle, other))
    own = _object(assembly, name, models)
    best: tuple[float, PartName] | None = None
    # The nearest surface is looked for on the six parts whose boxes are nearest to one that touches nothing. Chosen,
    # not measured.
    for gap, _, other in sorted(apart)[:6]:
        if best is None or gap <= best[0]:
            with working_on(name, other):
                distance = fcl_distance(own, _object(assembly, other, models))
            best = min(best or (np.inf, other), (distance, other))
    return best


def _box(assembly: Assembly, name: PartName) -> tuple[Array, Array]:
    part = assembly.part(name)
    assert part.mesh is not None
    return part.mesh.placed_box(part.X_WP)


def _object(assembly: Assembly, name: PartName, models: dict[PartName, fcl.BVHModel]) -> fcl.CollisionObject:
    part = assembly.part(name)
    assert part.mesh is not None
    if name not in models:
        models[name] = fcl_model(part.mesh.vertices, part.mesh.faces)
    return fcl.CollisionObject(models[name], fcl_pose(part.X_WP))
