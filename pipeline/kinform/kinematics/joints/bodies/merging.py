"""Which parts move as one: groups, assumptions, and contact that leaves nothing free."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.tied_sizes import largest
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Body
from kinform.model.names import BodyName, PartName


class Merger:
    """Parts of an assembly, merged step by step; remembers why."""

    def __init__(self, assembly: Assembly):
        self._assembly = assembly
        self._names = [part.name for part in assembly.parts]
        self._parts = {part.name: part for part in assembly.parts}
        self._index = {name: k for k, name in enumerate(self._names)}
        self._sets = UnionFind(len(self._names))
        self._reasons: list[tuple[int, str]] = []
        self._turning: list[tuple[int, str]] = []
        for group in assembly.groups:
            self._join(group.parts, f"group {group.name}")
        covered = set(assembly.function.complete)
        for joint in assembly.function.joints:
            if joint.type == "fixed" and joint.name[: joint.name.rfind("/") + 1] in covered:
                ends = [assembly.parts_of(name)[0] for name in joint.between]
                self._join(ends, f"intended fixed joint {joint.name} of a complete function")
        for assumption in assembly.assumptions:
            if assumption.type == "fixed":
                firsts = [assembly.parts_of(name)[0] for name in assumption.between]
                self._join(firsts, f"assumed fixed: {assumption.reason}")

    def _join(self, parts: tuple[PartName, ...] | list[PartName], reason: str) -> None:
        for other in parts[1:]:
            self._sets.union(self._index[parts[0]], self._index[other])
        self._reasons.append((self._index[parts[0]], reason))

    def fuse(self, first: PartName, second: PartName, reason: str, *, turning: bool = False) -> None:
        """Make the bodies that contain the two parts one; `turning`: contact lets them turn apart."""
        self._join([first, second], reason)
        if turning:
            self._turning.append((self._index[first], f"{first}~{second}"))

    def copy(self) -> Merger:
        """The same parts, to be merged further on their own."""
        out = Merger(self._assembly)
        out._sets.parent = list(self._sets.parent)
        out._reasons, out._turning = list(self._reasons), list(self._turning)
        return out

    def root(self, part: PartName) -> int:
        """A number that two parts share exactly when they are one body."""
        return self._sets.find(self._index[part])

    def bodies(self) -> tuple[Body, ...]:
        """The bodies, sorted by name, with ground marked."""
        members: dict[int, list[PartName]] = defaultdict(list)
        for name in self._names:
            members[self.root(name)].append(name)
        reasons, turning = self._by_body(self._reasons), self._by_body(self._turning)
        ground = self._ground(members)
        bodies = [
            Body(self._body_name(parts), tuple(sorted(parts)), root == ground, reasons[root], turning[root])
            for root, parts in members.items()
        ]
        return tuple(sorted(bodies, key=lambda body: body.name))

    def _by_body(self, texts: Iterable[tuple[int, str]]) -> defaultdict[int, tuple[str, ...]]:
        """Sorted texts about parts, each once, by the numbers of their bodies."""
        found: dict[int, set[str]] = defaultdict(set)
        for index, text in texts:
            found[self._sets.find(index)].add(text)
        return defaultdict(tuple, {root: tuple(sorted(every)) for root, every in found.items()})

    def _body_name(self, parts: list[PartName]) -> BodyName:
        inside = set(parts)
        groups = sorted(g.name for g in self._assembly.groups if inside.issuperset(g.parts))
        return BodyName(groups[0] if groups else min(parts))

    def _ground(self, members: dict[int, list[PartName]]) -> int:
        """The stated ground, else the heaviest body, or the largest where a density is missing; of those as heavy as
        it but for the rounding of files the first by name."""
        if self._assembly.ground is not None:
            return self.root(self._assembly.parts_of(self._assembly.ground)[0])
        grouped = self._assembly.weighed
        weighed = all(
            p.density is not None or p.override is not None or p.name in grouped for p in self._assembly.parts
        )
        stated = {group.parts[0]: group.override.mass for group in self._assembly.groups if group.override is not None}

        def size(root: int) -> float:
            total = 0.0
            for name in members[root]:
                part = self._parts[name]
                volume = abs(part.mesh.health.volume) if part.mesh is not None else 0.0
                if not weighed:
                    total += volume
                elif name in grouped:
                    total += stated.get(name, 0.0)
                elif part.override is not None:
                    total += part.override.mass
                else:
                    total += volume * float(part.density or 0.0)
            return total

        roots = {min(names): root for root, names in members.items()}
        return roots[largest({name: size(root) for name, root in roots.items()})]
