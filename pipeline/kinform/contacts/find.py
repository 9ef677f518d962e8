"""The stage: broad phase, then every pair on its own, in the order of names."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from dataclasses import replace

from kinform.contacts.fastening import suggest
from kinform.contacts.overlap.boundaries import boundaries_cross
from kinform.contacts.overlap.explained import explained
from kinform.contacts.overlap.solids import SolidStore
from kinform.contacts.pair import PairContacts, mated_pairs, pair_contacts, touching
from kinform.contacts.search.along_own_axes import along_own_axes
from kinform.contacts.search.candidates import Pair, candidate_pairs
from kinform.contacts.search.pair_view import PairView
from kinform.foundation.constants import LITTLE_FACETS
from kinform.foundation.current_work import working_on
from kinform.foundation.meshes.mesh_index import LARGE_MESH, MeshStore
from kinform.foundation.processes import Crash, map_in_processes
from kinform.foundation.progress import Progress
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch, Suggestion
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

TOGETHER_PAIRS = 64
"""Pairs whose decisions are taken together: numpy takes as long to begin as to go through hundreds of numbers, ..."""
TOGETHER_FACETS = 50_000
"""... as long as no more facets come to those of the first pair: what is known of one takes about half a kilobyte."""
LITTLE_PAIRS = 64
"""Pairs up to which one process looks at all, where their facets are few too. Chosen, not measured."""


class _Work:
    """What a worker needs for any pair; meshes are indexed when first met, and forgotten after the last pair that
    needs them."""

    def __init__(
        self, assembly: Assembly, surfaces: dict[str, MeshSurfaces], tolerance: dict[Pair, float], wanted: list[Pair]
    ):
        self.assembly, self.tolerance = assembly, tolerance
        self.parts, self.surfaces = along_own_axes({name for pair in wanted for name in pair}, assembly, surfaces)
        self.store, self.solids = MeshStore(), SolidStore()
        self.order = _by_neighbours(wanted)
        self.number = {pair: number for number, pair in enumerate(self.order)}
        self.last: dict[str, int] = {}
        """Digest of a mesh → number of the last pair that needs it."""
        for number, pair in enumerate(self.order):
            self.last.update((mesh.digest, number) for name in pair if (mesh := self.parts[name].mesh) is not None)

    def contacts(self, pairs: tuple[Pair, ...]) -> list[PairContacts]:
        """Of some pairs that follow each other; those before them, in `order`, are done or have what they need."""
        number = self.number[pairs[0]]
        for digest in [known for known in list(self.store.indices) if self.last[known] < number]:
            self.store.forget(digest)
            self.solids.forget(digest)
        asked = [((self.parts[a], self.parts[b]), self.tolerance[a, b]) for a, b in pairs]
        mated = mated_pairs(asked, self.surfaces, self.store, self.assembly.tolerances)
        out, begun = [PairContacts((), None, None)] * len(pairs), []
        for k, (pair, mates) in enumerate(zip(pairs, mated, strict=True)):
            if mates is not None:
                with working_on(_name_of((pair,))):
                    begun.append((k, mates, touching(mates)))
        told = _crossing([(mates.pair, patches) for _, mates, patches in begun])
        for (k, mates, patches), crosses in zip(begun, told, strict=True):
            with working_on(_name_of((pairs[k],))):
                out[k] = pair_contacts(mates, patches, crosses, self.solids)
        return out

    def chunks(self, most: int) -> list[tuple[Pair, ...]]:
        """All pairs in their order, `most` at a time, and fewer of those that bring large meshes with them, which are
        all known at once."""
        out: list[tuple[Pair, ...]] = []
        chunk: list[Pair] = []
        known: set[str] = set()
        more = 0
        for pair in self.order:
            meshes = {mesh.digest: len(mesh.faces) for name in pair if (mesh := self.parts[name].mesh) is not None}
            more += sum(count for digest, count in meshes.items() if digest not in known)
            alone = self._is_alone(pair)
            if chunk and (alone or len(chunk) >= most or more > TOGETHER_FACETS):
                out.append(tuple(chunk))
                chunk, known = [], set()
            if not chunk:
                more = TOGETHER_FACETS + 1 if alone else 0
            chunk.append(pair)
            known |= meshes.keys()
        return [*out, tuple(chunk)] if chunk else out

    def _is_alone(self, pair: Pair) -> bool:
        """Whether one has a large mesh of which all may be near the other, so that what is expected of it is expected
        of that pair."""
        parts = [self.parts[name] for name in pair]
        large = [part.mesh is not None and len(part.mesh.faces) > LARGE_MESH for part in parts]
        if not any(large):
            return False
        (low, high), (low_other, high_other) = (
            part.mesh.placed_box(part.X_WP) for part in (parts if large[0] else parts[::-1]) if part.mesh is not None
        )
        margin = self.tolerance[pair]
        return all(large) or bool((low_other - margin <= low).all() and (high_other + margin >= high).all())

    def is_little(self, pairs: list[Pair]) -> bool:
        """Whether it takes no longer than other processes take to start."""
        meshes = [mesh for name in {name for pair in pairs for name in pair} if (mesh := self.parts[name].mesh)]
        return len(pairs) <= LITTLE_PAIRS and sum(len(m.faces) for m in meshes) <= LITTLE_FACETS


def find(
    assembly: Assembly,
    surfaces: dict[str, MeshSurfaces],
    *,
    jobs: int = 1,
    reuse: Contacts | None = None,
    reuse_pairs: frozenset[tuple[str, str]] = frozenset(),
    progress: Progress | None = None,
    meanwhile: Callable[[], None] | None = None,
) -> Contacts:
    """All contacts of the assembly at its pose, in the world (SI).

    `surfaces` by mesh digest. Pairs of parts without mesh, pairs inside one group, and pairs that an
    assumption declares not to touch are not looked at. Pairs named in `reuse_pairs` (sorted names) are
    taken from `reuse` where it has them. `progress(done, total)` counts pairs. The result does not
    depend on `jobs`. `meanwhile` is called while other processes are at work.
    """
    tolerance = candidate_pairs(assembly)
    reused = {p for p in reuse.candidates if p in reuse_pairs and p in tolerance} if reuse is not None else set()
    wanted = [pair for pair in tolerance if pair not in reused]
    work = _Work(assembly, surfaces, tolerance, wanted)
    done = _computed(work, jobs, progress, meanwhile, work.is_little(wanted))
    if reuse is not None:
        done |= _earlier_contacts(reuse, reused)
    contacts = Contacts(
        patches=tuple(patch for pair in tolerance for patch in done[pair].patches),
        interferences=tuple(overlap for pair in tolerance if (overlap := done[pair].interference) is not None),
        candidates=tuple(tolerance),
        tolerance=tolerance,
        possible_overlaps=tuple(some for pair in tolerance if (some := done[pair].possible_overlap) is not None),
    )
    earlier = {} if reuse is None else _earlier_suggestions(reuse, contacts, reused)
    return replace(contacts, suggestions=suggest(assembly, surfaces, contacts, earlier))


def _crossing(asked: list[tuple[PairView, list[Patch]]]) -> list[bool | None]:
    """Whether the boundaries of pairs cross, as `boundaries_cross` says; None of those, too, that share no more than is
    `explained`."""
    clear = explained(asked)
    rest = iter(boundaries_cross([one for one, known in zip(asked, clear, strict=True) if not known]))
    return [None if known else next(rest) for known in clear]


def _name_of(pairs: tuple[Pair, ...]) -> str:
    """What is at work: of some pairs by the first."""
    first = f"contacts of {pairs[0][0]} and {pairs[0][1]}"
    return first if len(pairs) == 1 else f"{first}, or of one of the {len(pairs) - 1} pairs after them"


def _computed(
    work: _Work, jobs: int, progress: Progress | None, meanwhile: Callable[[], None] | None, little: bool
) -> dict[Pair, PairContacts]:
    """The contacts of all pairs of the work: of many small ones at once; where a process ends over that, one by one, so
    that it is told which pair it was."""
    # each process gets a few shares of the pairs: some take much longer than others
    share = len(work.order) if jobs <= 1 else len(work.order) // (4 * jobs)
    for most in (max(1, min(TOGETHER_PAIRS, share)), 1):
        chunks, done = work.chunks(most), dict[Pair, PairContacts]()
        computed = map_in_processes(work.contacts, chunks, jobs, None, _name_of, little=little, meanwhile=meanwhile)
        try:
            for chunk, found in zip(chunks, computed, strict=True):
                for pair, of_pair in zip(chunk, found, strict=True):
                    done[pair] = of_pair
                    if progress is not None:
                        progress(len(done), len(work.order))
        except Crash:
            if most == 1 or len(chunks) == len(work.order):
                raise
        else:
            break
    return done


def _by_neighbours(pairs: list[Pair]) -> list[Pair]:
    """The pairs in an order in which those of a part follow each other closely, so that few meshes are needed at a
    time: parts are numbered in breadth, from neighbour to neighbour, and pairs come by the later of theirs."""
    neighbours = _neighbours(pairs)
    rank: dict[PartName, int] = {}
    for start in neighbours:
        queue = deque([] if start in rank else [start])
        rank.setdefault(start, len(rank))
        while queue:
            for first, second in sorted(neighbours[name := queue.popleft()]):
                other = second if first == name else first
                if other not in rank:
                    rank[other] = len(rank)
                    queue.append(other)
    return sorted(pairs, key=lambda pair: sorted((rank[name] for name in pair), reverse=True))


def _earlier_suggestions(reuse: Contacts, contacts: Contacts, reused: set[Pair]) -> dict[Pair, list[Suggestion]]:
    """What earlier contacts suggest of pairs that are taken over with all pairs near them: of parts that have the
    neighbours that they had, all as they were."""
    before, after = _neighbours(reuse.candidates), _neighbours(contacts.candidates)
    same = {name for name, pairs in after.items() if pairs == before.get(name) and pairs <= reused}
    out: dict[Pair, list[Suggestion]] = {pair: [] for pair in reused if same.issuperset(pair)}
    for hint in reuse.suggestions:
        if hint.parts in out:
            out[hint.parts].append(hint)
    return out


def _neighbours(pairs: Iterable[Pair]) -> dict[PartName, set[Pair]]:
    """The pairs of each part."""
    out: dict[PartName, set[Pair]] = defaultdict(set)
    for pair in pairs:
        for name in pair:
            out[name].add(pair)
    return out


def _earlier_contacts(reuse: Contacts, pairs: set[Pair]) -> dict[Pair, PairContacts]:
    """What earlier contacts say of these pairs."""
    overlaps = {overlap.parts: overlap for overlap in reuse.interferences}
    possible = {overlap.parts: overlap for overlap in reuse.possible_overlaps}
    patches: dict[Pair, list[Patch]] = {pair: [] for pair in pairs}
    for patch in reuse.patches:
        if patch.parts in patches:
            patches[patch.parts].append(patch)
    return {
        pair: PairContacts(tuple(of_pair), overlaps.get(pair), possible.get(pair)) for pair, of_pair in patches.items()
    }
