"""The tree that links and joints make: one root, no circle, nothing unknown. Poses of links follow from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from kinform.form.problems import Problems
from kinform.formats.description.robot import At, Ratio
from kinform.foundation.name_hints import LISTED_NAMES, did_you_mean, first_names, in_quotes
from kinform.frozen import dataclass
from kinform.model.arrays import Array

Edge = tuple[str, str, str, Array, At]
"""Name of the joint, parent, child, pose (4, 4) of the child in the parent, place."""


@dataclass(frozen=True)
class Tree:
    """The root, and the pose (4, 4) of each link in its frame."""

    root: str
    poses: Mapping[str, Array]


def tree_of(links: Mapping[str, At], edges: Sequence[Edge], at: At, problems: Problems) -> Tree | None:
    """The tree of a description that must be one; None after noting why it is none."""
    before = len(problems)
    parent: dict[str, Edge] = {}
    for edge in edges:
        name, above, below, _, where = edge
        for what, link in (("parent", above), ("child", below)):
            if link not in links:
                message = f"joint {in_quotes(name)}: its {what} {in_quotes(link)} is no link"
                problems.add(message, where.file, where.line, did_you_mean(link, links, "the links"))
        if below in parent:
            problems.add(
                f"link {in_quotes(below)} has two parents: joints {in_quotes(parent[below][0])} (line "
                f"{parent[below][4].line}) and {in_quotes(name)}", where.file, where.line,
                "remove one of the joints: a loop cannot be stated so",
            )  # fmt: skip
        parent.setdefault(below, edge)
    if len(problems) > before:
        return None
    roots = [link for link in links if link not in parent]
    if len(roots) > 1:
        where = links[roots[1]]
        listed = first_names(map(in_quotes, roots))
        problems.add(f"has {len(roots)} roots: no joint has {listed} as its child", where.file, where.line,
                     "join them by a joint, or remove what is not connected")  # fmt: skip
        return None
    circle = _circle({link: parent[link][1] for link in links if link in parent})
    if circle is not None:
        where = parent[circle[0]][4]
        problems.add(f"the joints form a cycle: {_told(circle)}",
                     where.file, where.line, "remove one of these joints")  # fmt: skip
        return None
    if not roots:
        problems.add("has no link", at.file, at.line, "add a link")
        return None
    return Tree(roots[0], _poses(roots[0], edges))


def _circle(above: Mapping[str, str]) -> list[str] | None:
    """Names that are above each other in a circle; None where there is none."""
    done: set[str] = set()
    for start in above:
        way: dict[str, None] = {}
        here: str | None = start
        while here is not None and here not in done and here not in way:
            way[here] = None
            here = above.get(here)
        if here is not None and here in way:
            names = list(way)
            return names[names.index(here) :][::-1]
        done.update(way)
    return None


def _told(circle: Sequence[str]) -> str:
    """The names of a circle, from the first round to it; of a long one its first."""
    shown = [in_quotes(name) for name in circle[:LISTED_NAMES]]
    left_out = ["…"] if len(circle) > LISTED_NAMES else []
    return " → ".join([*shown, *left_out, in_quotes(circle[0])])


def refuse_circle(mimics: Sequence[Ratio], problems: Problems) -> None:
    """Note joints that mimic each other in a circle: none of them leads."""
    circle = _circle({mimic.joints[0]: mimic.joints[1] for mimic in mimics})
    if circle is not None:
        at = next(mimic.at for mimic in mimics if mimic.joints[0] == circle[0])
        problems.add(
            f"joints mimic each other in a circle: {_told(circle)}", at.file, at.line, "remove one <mimic> of these"
        )


def _poses(root: str, edges: Sequence[Edge]) -> dict[str, Array]:
    below: dict[str, list[Edge]] = {}
    for edge in edges:
        below.setdefault(edge[1], []).append(edge)
    poses = {root: np.eye(4)}
    stack = [root]
    while stack:
        here = stack.pop()
        for _, _, child, X, _ in below.get(here, ()):
            poses[child] = poses[here] @ X
            stack.append(child)
    return poses


class Count:
    """Counts what cannot be carried, so that it is said once, by name."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self.notes: list[str] = []

    def add(self, what: str) -> None:
        """Note one more of these."""
        self._counts[what] = self._counts.get(what, 0) + 1

    def sentences(self, file: str) -> tuple[str, ...]:
        """The notes, and one sentence of all that is not carried."""
        if not self._counts:
            return tuple(self.notes)
        words = ", ".join(f"{what} ({n})" if n > 1 else what for what, n in sorted(self._counts.items()))
        return (*self.notes, f"{file}: not carried: {words}")


def distinct(taken: set[str]) -> Callable[[str], str]:
    """Gives names that are not taken yet: repeated ones get #2, #3."""
    last: dict[str, int] = {}

    def free(name: str) -> str:
        out, number = name, last.get(name, 1)
        while out in taken:
            number += 1
            out = f"{name}#{number}"
        taken.add(out)
        last[name] = number
        return out

    return free
