"""What the manifest keeps apart, and the suggestions that would join it nevertheless.

Parts of two groups, and parts between which a joint is stated that moves, are two bodies unless contact itself holds
them together. Suggestions join bodies in chains: where a to b and b to c are suggested and a is kept apart from c, one
of the two is wrong, and nothing tells which. So none of the suggestions is believed that lies on any way from one to
the other of two bodies that are kept apart. With an edge more between these two that is a question of blocks: the ways
between two nodes of a graph run through the block of an edge between them, and all of that block is on one.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from itertools import combinations

from kinform.foundation.graphs.graph import UnionFind, blocks
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly
from kinform.model.contacts import Suggestion
from kinform.model.names import PartName


@dataclass(frozen=True)
class Apart:
    """Two parts that are of different bodies, and what says so."""

    parts: tuple[PartName, PartName]
    words: str
    """"'left' and 'right' are two groups", "a joint is stated between 'lever' and 'frame'"."""


def kept_apart(assembly: Assembly) -> list[Apart]:
    """All that the manifest keeps apart; of a group, its first part stands for all."""
    stated = [(a.between, a.type) for a in assembly.assumptions] + [
        (j.between, j.type) for j in assembly.function.joints
    ]
    moving = [
        Apart(_ends(assembly, between), "a joint is stated between '{}' and '{}'".format(*between))
        for between, kind in stated
        if kind not in (None, "fixed")
    ]
    groups = [
        Apart((a.parts[0], b.parts[0]), f"'{a.name}' and '{b.name}' are two groups")
        for a, b in combinations(assembly.groups, 2)
    ]
    return moving + groups


def _ends(assembly: Assembly, between: tuple[str, str]) -> tuple[PartName, PartName]:
    first, second = (assembly.parts_of(name)[0] for name in between)
    return first, second


def contradicted(
    hints: Sequence[Suggestion], apart: Sequence[Apart], body: Callable[[PartName], Hashable]
) -> dict[int, Apart]:
    """Which of these suggestions would help to join what is kept apart, by their index, and the first of what they
    would join. `body` tells of each part which body it is in; what is one body already is nobody's doubt.
    """
    numbers: dict[Hashable, int] = {}
    joining: list[int] = []
    edges: list[tuple[int, int]] = []
    for index, hint in enumerate(hints):
        first, second = (numbers.setdefault(body(part), len(numbers)) for part in hint.parts)
        if first != second:
            joining.append(index)
            edges.append((first, second))
    reach = UnionFind(len(numbers))
    for first, second in edges:
        reach.union(first, second)
    out: dict[int, Apart] = {}
    done: set[tuple[int, ...]] = set()
    for item in apart:
        pair = tuple(sorted(numbers.get(body(part), -1) for part in item.parts))
        if pair[0] < 0 or pair[0] == pair[1] or pair in done or reach.find(pair[0]) != reach.find(pair[1]):
            continue
        done.add(pair)
        way = next(block for block in blocks(len(numbers), [*edges, (pair[0], pair[1])]) if len(edges) in block)
        for k in way[:-1]:
            out.setdefault(joining[k], item)
    return out
