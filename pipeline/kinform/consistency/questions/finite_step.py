"""Whether a finite step of a motion drives two bodies into each other, in either sense: the proof that it is blocked.

A step is proven to be blocked where the contacts stage, asked at the stepped pose, finds that two parts interpenetrate
by more than the contact tolerance and the form error of their surfaces, beyond what they interpenetrate as modelled.
The contact itself sizes the steps. At each sample of a patch the motion closes the contact at a speed: the normal
component of the relative velocity. The first step closes the fastest sample of a pair by a little more than the depth
that counts; steps grow until they have also closed the clearance that surfaces in contact can have. So end play does
not pass for freedom, and a stop beyond the contact does not pass for a blocked motion.

Other parts may lie between the bodies: a key, a cross pin, screws. Each of them moves along with one of the two sides,
whichever leaves the motion free. The motion is blocked where no choice does: where a chain of parts leads from the
first body to the second, each of which collides with the next if it rests and the next one moves. A cut of a directed
graph separates the two sides exactly where there is no such chain. A pair that collides at a step also stops every
longer step, so that each pair of the chain may have a step of its own; the longest is that of the chain.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from kinform.contacts.overlap.boundaries import boundaries_cross
from kinform.contacts.overlap.explained import explained
from kinform.contacts.overlap.solids import SolidStore
from kinform.contacts.pair import mated_pairs, pair_contacts, touching
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.algebra.vectors import cross, dot, norm
from kinform.foundation.meshes.mesh_index import MeshStore
from kinform.foundation.words import angle, length, place, quoted
from kinform.frozen import dataclass
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Interference, Patch
from kinform.model.findings import Witness
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

CLOSED_FIRST = 1.25
"""Depths that count by which the first step of a pair closes its fastest sample: some more than one, as the deepest
point of an overlap is a little less deep than that sample is closed."""
CLOSED_MOST = 5.0
"""The same of the last step: one depth that counts, one of clearance on either side of the contact, and the rest for
contacts that close at an angle, as the corners of a flat do once it has turned."""
STEP_GROWS = 1.5
"""Factor from step to step: at most five steps from the first to the last."""
TURN_MOST = math.radians(20.0)
"""Greatest turn of a step: beyond, normals of contacts have turned too far to say what closes."""
TURN_MOST_THREADS = math.pi
"""The same of threads, whose flanks have the same normals however far they turn: half a pitch of advance."""
THREAD_SHARE = 0.1
"""Depth that counts between threads, in pitches, where that is less than the contact tolerance: flanks are never
deeper in each other than about half a pitch."""
SLIDE_MOST = 0.15
"""Greatest slide of a step, in diagonals of the smaller body: beyond, parts meet other features than those in
contact."""

Pair = tuple[str, str]
"""Two parts, sorted by name."""


@dataclass(frozen=True, eq=False)
class Step:
    """A step in one sense, and where it drives parts into each other."""

    size: float
    """rad of a turn, else m; with the sign of the sense."""
    pair: tuple[str, str]
    """The part that rests, and the one that moves: those of the chain that need the longest step."""
    place: Array
    """(3,) m, world, at the stepped pose."""
    depth: float
    """m."""
    drawn: float
    """m: how deep the same parts interpenetrate as modelled; 0 where they do not."""
    chain: tuple[str, ...]
    """Parts from the first body to the second, each of which collides with the next."""

    @property
    def parts(self) -> Pair:
        """The same parts, sorted."""
        return _sorted(self.pair)


@dataclass(frozen=True, eq=False)
class StepWitness:
    """What steps of one motion meet in both senses."""

    twist: Array
    """(6,) of the second body relative to the first (ω; v at the world's origin), |ω| or |v| 1."""
    ahead: Step | None
    """None: no step in this sense is proven to be blocked."""
    back: Step | None
    tried: tuple[float, float]
    """Greatest step tried ahead and back (rad or m); 0 where the contact does not close at all."""

    @property
    def blocked(self) -> bool:
        """Whether the motion is proven to be blocked in both senses."""
        return self.ahead is not None and self.back is not None

    @property
    def turns(self) -> bool:
        """Whether steps are angles."""
        return bool(np.any(self.twist[:3]))

    @property
    def record(self) -> Witness | None:
        """The witness of a finding; None unless both senses are blocked."""
        if self.ahead is None or self.back is None:
            return None
        one, other = self.back, self.ahead
        return Witness(
            kind="geometric",
            twist=_six(self.twist),
            step=(one.size, other.size),
            depth=(one.depth, other.depth),
            place_back=_three(one.place),
            place_ahead=_three(other.place),
            parts_back=one.parts,
            parts_ahead=other.parts,
        )

    def words(self, units: str) -> str:
        """What the steps meet: "a step of +5° drives …, a step of -5° …", lengths in units of the assembly."""
        return ", ".join(self._of(step, units) for step in (self.ahead, self.back) if step is not None)

    def doubt(self, units: str) -> str:
        """Why the motion is not proven to be blocked; "" where it is."""
        steps = (("+", self.ahead, self.tried[0]), ("-", self.back, -self.tried[1]))
        return ", ".join(
            f"no overlap beyond tolerance at steps up to {self._size(size, units)}"
            if size
            else f"the contact does not close in the {sense} sense"
            for sense, step, size in steps
            if step is None
        )

    def _of(self, step: Step, units: str) -> str:
        drawn = f" ({length(step.drawn, units, 2)} as modelled)" if step.drawn > 0.0 else ""
        return (
            f"a step of {self._size(step.size, units)} drives {quoted(step.parts)} {length(step.depth, units, 2)} into "
            f"each other{drawn} at {place(step.place, units)}"
        )

    def _size(self, size: float, units: str) -> str:
        words = angle(abs(size), 2) if self.turns else length(abs(size), units, 2)
        return f"{'-' if size < 0.0 else '+'}{words}"


@dataclass(frozen=True, eq=False)
class _Collision:
    """A pair of which one part rests and the other has moved."""

    size: float
    """rad or m of the step, positive."""
    overlap: Interference


@dataclass
class FiniteSteps:
    """Steps of motions of one assembly; what is asked of a pair of parts is worked out once."""

    assembly: Assembly
    surfaces: dict[str, MeshSurfaces]
    """By mesh digest."""
    contacts: Contacts
    """As modelled."""
    _store: MeshStore = field(default_factory=MeshStore)
    _solids: SolidStore = field(default_factory=SolidStore)
    _known: dict[tuple[str, str, bytes], Interference | None] = field(default_factory=dict)

    def witness(
        self,
        first: Collection[str],
        second: Collection[str],
        twist: Array,
        between: Collection[str] = (),
        without: Collection[Pair] = (),
    ) -> StepWitness:
        """What steps along a unit twist (6,) of the `second` body relative to the `first` meet in both senses; bodies
        are given by their parts, those `between` go with either. Pairs `without` (sorted) do not count."""
        sides = frozenset(first), frozenset(second), frozenset(between) - {*first, *second}
        asked = _Asked(self, *sides, np.asarray(twist, float), frozenset(without))
        (ahead, far), (back, near) = asked.step(1), asked.step(-1)
        return StepWitness(asked.twist, ahead, back, (far, near))

    def counts(self, pair: Pair) -> float:
        """m: deeper than this two parts in contact are in each other for sure, beyond their tolerance, the form error
        of their surfaces and what they interpenetrate as modelled."""
        patches = self.patches.get(pair, ())
        form = max((patch.chord + patch.uncertainty[1] for patch in patches), default=0.0)
        threads = [THREAD_SHARE * abs(patch.pitch) for patch in patches if patch.kind == "helicoid"]
        return min([self.tolerance(pair), *threads]) + form + self.drawn.get(pair, 0.0)

    def threaded(self, pair: Pair) -> bool:
        """Whether two parts touch along a thread."""
        return any(patch.kind == "helicoid" for patch in self.patches.get(pair, ()))

    def tolerance(self, pair: Pair) -> float:
        """m: contact tolerance of two parts in contact."""
        return self.contacts.tolerance[PartName(pair[0]), PartName(pair[1])]

    @cached_property
    def patches(self) -> Mapping[Pair, list[Patch]]:
        """Of each pair in contact."""
        out: dict[Pair, list[Patch]] = {}
        for patch in self.contacts.patches:
            out.setdefault((str(patch.parts[0]), str(patch.parts[1])), []).append(patch)
        return out

    @cached_property
    def drawn(self) -> Mapping[Pair, float]:
        """m: how deep pairs interpenetrate as modelled, or may."""
        out: dict[Pair, float] = {}
        for one in (*self.contacts.interferences, *self.contacts.possible_overlaps):
            pair = str(one.parts[0]), str(one.parts[1])
            out[pair] = max(out.get(pair, 0.0), one.depth)
        return out

    @cached_property
    def neighbours(self) -> Mapping[str, list[str]]:
        """Parts that touch or interpenetrate as modelled, sorted."""
        pairs = {pair for pair in (*self.patches, *self.drawn) if all(self._meshed(name) for name in pair)}
        out: dict[str, list[str]] = {}
        for one, other in sorted(pairs | {(b, a) for a, b in pairs}):
            out.setdefault(one, []).append(other)
        return out

    def _meshed(self, name: str) -> bool:
        mesh = self.assembly.part(name).mesh
        return mesh is not None and mesh.digest in self.surfaces

    def diagonal(self, names: Collection[str]) -> float:
        """m: of the box of some parts; 0 without meshes."""
        placed = [self.assembly.part(name) for name in sorted(names)]
        boxes = [part.mesh.placed_box(part.X_WP) for part in placed if part.mesh is not None]
        if not boxes:
            return 0.0
        low, high = np.min([box[0] for box in boxes], axis=0), np.max([box[1] for box in boxes], axis=0)
        return float(np.linalg.norm(high - low))

    def overlap(self, still: str, moved: str, D: Array) -> Interference | None:
        """The overlap of two parts that is sure, the second displaced by D (4, 4) in the world."""
        key = still, moved, D.tobytes()
        if key not in self._known:
            self._known[key] = self._overlap(still, moved, D)
        return self._known[key]

    def _overlap(self, still: str, moved: str, D: Array) -> Interference | None:
        other = self.assembly.part(moved)
        placed = replace(other, X_WP=np.asarray(freeze(D @ other.X_WP)))
        one, two = sorted((self.assembly.part(still), placed), key=lambda part: part.name)
        tolerance = self.tolerance((str(one.name), str(two.name)))
        (mates,) = mated_pairs([((one, two), tolerance)], self.surfaces, self._store, self.assembly.tolerances)
        if mates is None:
            return None
        patches = touching(mates)
        if explained([(mates.pair, patches)])[0]:
            return None
        (crosses,) = boundaries_cross([(mates.pair, patches)])
        return pair_contacts(mates, patches, crosses, self._solids).interference

    def closing(self, still: str, moved: str, twist: Array) -> float:
        """m per unit of a twist (6,) of the second part relative to the first by which the contact of two parts closes
        at its fastest sample. Of parts that only interpenetrate: the speed of the middle of what they share."""
        pair, sense = ((still, moved), 1.0) if still < moved else ((moved, still), -1.0)
        speeds = [float(closing_speeds(patch, sense * twist).max()) for patch in self.patches.get(pair, ())]
        if pair in self.drawn:
            every = (*self.contacts.interferences, *self.contacts.possible_overlaps)
            places = [one.place for one in every if one.parts == pair]
            speeds += [float(norm(twist[3:] + cross(twist[:3], place))) for place in places]
        return max(speeds, default=0.0)


def closing_speeds(patch: Patch, twist: Array) -> Array:
    """(n,) m per unit of a twist (6,) of the patch's second part relative to its first by which the contact closes at
    each sample."""
    return -dot(patch.normals, twist[3:] + cross(twist[:3], patch.points))


@dataclass(frozen=True, eq=False)
class _Asked:
    """One motion between two bodies."""

    steps: FiniteSteps
    first: frozenset[str]
    second: frozenset[str]
    between: frozenset[str]
    twist: Array
    without: frozenset[Pair]

    @cached_property
    def group_of(self) -> Mapping[str, frozenset[str]]:
        """The parts that a part between the bodies moves with, by its groups."""
        out: dict[str, frozenset[str]] = {}
        for group in self.steps.assembly.groups:
            parts = frozenset(map(str, group.parts))
            for name in parts & self.between:
                out[name] = out.get(name, frozenset()) | parts
        return out

    def _most(self, pair: Pair) -> float:
        """Greatest step of two parts, rad or m."""
        if np.any(self.twist[:3]):
            return TURN_MOST_THREADS if self.steps.threaded(pair) else TURN_MOST
        return SLIDE_MOST * min(self.steps.diagonal(side) for side in (self.first, self.second))

    def step(self, sense: int) -> tuple[Step | None, float]:
        """The step to one side that is proven to be blocked, if any, and the greatest that was tried."""
        tried = 0.0
        before: dict[str, tuple[str, _Collision]] = {}
        waiting = sorted(self.first)
        reached = set(waiting)
        while waiting:
            still = waiting.pop(0)
            for moved in self._beside(still):
                if moved in reached:
                    continue
                collision, far = self._collision(still, moved, sense)
                tried = max(tried, far)
                if collision is None:
                    continue
                fresh = sorted({moved, *self.group_of.get(moved, ())} - reached)
                before |= dict.fromkeys(fresh, (still, collision))
                reached |= set(fresh)
                waiting += fresh
                end = next((name for name in fresh if name in self.second), None)
                if end is not None:
                    return self._proof(sense, end, before), tried
        return None, tried

    def _beside(self, still: str) -> list[str]:
        """Parts in contact with a part that may move while it rests."""
        asked = (self.second | self.between) - self.first
        beside = self.steps.neighbours.get(still, [])
        return [name for name in beside if name in asked and _sorted((still, name)) not in self.without]

    def _collision(self, still: str, moved: str, sense: int) -> tuple[_Collision | None, float]:
        """The first step at which two parts are deeper in each other than counts; and the greatest that was tried."""
        closing = self.steps.closing(still, moved, sense * self.twist)
        if closing <= 0.0:
            return None, 0.0
        pair = _sorted((still, moved))
        counts = self.steps.counts(pair)
        end = min(self._most(pair), CLOSED_MOST * counts / closing)
        size = min(CLOSED_FIRST * counts / closing, end) if closing * end > counts else math.inf
        while size <= end:
            overlap = self.steps.overlap(still, moved, displacement(sense * size * self.twist))
            if overlap is not None and overlap.depth > counts:
                return _Collision(size, overlap), size
            size = min(STEP_GROWS * size, end) if size < end else math.inf
        return None, end

    def _proof(self, sense: int, end: str, before: Mapping[str, tuple[str, _Collision]]) -> Step:
        chain, links = [end], []
        while chain[-1] in before:
            links.append(before[chain[-1]])
            chain.append(links[-1][0])
        still, longest = max(links, key=lambda link: link[1].size)
        overlap = longest.overlap
        (moved,) = (str(name) for name in overlap.parts if name != still)
        drawn = self.steps.drawn.get(_sorted((still, moved)), 0.0)
        return Step(sense * longest.size, (still, moved), overlap.place, overlap.depth, drawn, tuple(chain[::-1]))


def _sorted(pair: Pair) -> Pair:
    one, other = sorted(pair)
    return one, other


def _three(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _six(values: Array) -> tuple[float, float, float, float, float, float]:
    a, b, c, d, e, f = (float(value) + 0.0 for value in values)
    return a, b, c, d, e, f
