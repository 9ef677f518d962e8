"""What can leave the assembly, ground held: one linear program a block of the graph of contacts.

In a block each pair that contact holds is bilateral; each other pair j may open, by JV ≥ 0, and opens by s_j.
Maximising Σ s_j with s_j ≤ 1 over a cone opens every pair that can open at once: what opens is known from a
single solution, for a sum of motions in the cone is in the cone. Where all open along one direction (`lifting`), or
none does for certain (`nothing_opens`), no program is needed. Bodies that stay together after all that
opens are gone make a set; it leaves alone where its own contacts with the rest have a cone, else together with
its neighbours. Blocks know nothing of each other, as in the closure of loops.

Contact that fuses bodies is looked at too: a block in a corner has no freedom, and is not held.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled, twist_at_origin
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.graphs.graph import UnionFind, blocks
from kinform.foundation.lockstep import run_in_lockstep
from kinform.frozen import dataclass
from kinform.kinematics.constants import MOST_IN_STEP
from kinform.kinematics.separation.cone import nothing_opens_in_each, rows_beside, split_directions, unit_rows
from kinform.kinematics.separation.constants import CONE_HELD, HIGHS_FEASIBLE
from kinform.kinematics.separation.contact_rows import Cone, ContactRows, is_stated
from kinform.kinematics.separation.lifting import LARGEST_TWIST, lifts_apart
from kinform.kinematics.separation.releases import certainly_held, leaving_of_each, release_of
from kinform.kinematics.step_cache import StepCache, cached_each
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Joint, Release, Separation
from kinform.model.names import BodyName, JointName

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

MOST_CERTIFIED = 120
"""Components of twists up to which it is first asked whether anything opens in a block: dense algebra of a
millisecond, where importing and calling a linear program takes hundreds."""
MOST_OPENING_ROWS = 12_000
"""Rows of one block's program beyond which it would take minutes: 400 bricks in a wall, 5,000 rows, take 3 s."""
MOST_TOGETHER = 8
"""Bodies up to which those are told that leave together. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Link:
    """Two bodies in contact. `cone` is None where nothing opens."""

    name: JointName
    ends: tuple[int, int]
    cone: Cone | None
    twists: Array
    """(f, 6) its freedoms where nothing opens, (0, 6) elsewhere."""
    slides: tuple[Release, ...] | None = None
    """In which the second leaves the first; None where not known yet."""


Opened = tuple[int, ...] | None
"""Links of one block that can open together, by their places in it; None where that is not known."""


def links_between(
    clusters: Sequence[Body],
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    patches: Sequence[Patch],
    rows: ContactRows,
) -> list[Link]:
    """Links of contact between clusters (bodies, or parts that contact alone fuses), and of stated joints."""
    cluster = {part: k for k, item in enumerate(clusters) for part in item.parts}
    body = {part: item.name for item in bodies for part in item.parts}
    owner = {joint.bodies: joint for joint in joints}
    carried = {joint.bodies: {*joint.patches, *(b.patch for b in joint.blockers)} for joint in joints}
    members: dict[tuple[int, int], list[tuple[int, bool]]] = defaultdict(list)
    for k, patch in enumerate(patches):
        a, b = (cluster[part] for part in patch.parts)
        pair = tuple(sorted(body[part] for part in patch.parts))
        used = pair[0] == pair[1] or (pair in carried and not is_stated(owner[pair]) and k in carried[pair])
        if a != b and used and len(patch.points):
            members[(a, b) if a < b else (b, a)].append((k, a > b))
    pairs = sorted(members)
    cones = rows.cones([members[pair] for pair in pairs])
    certain = iter(certainly_held([cone for cone in cones if cone is not None]))
    slides = {joint.name: tuple(way for way in joint.releases if way.kind == "slide") for joint in joints}
    out = []
    for (a, b), cone in zip(pairs, cones, strict=True):
        if cone is None:
            continue
        name = JointName(f"{clusters[a].name}~{clusters[b].name}")
        if next(certain):
            out.append(Link(name, (a, b), None, twist_at_origin(cone.preserved, cone.frame).T, slides.get(name)))
        else:
            out.append(Link(name, (a, b), cone, np.zeros((0, 6)), slides.get(name)))
    for joint in joints:
        if is_stated(joint):
            ends = [min(cluster[p] for p in rows.parts_of(name)) for name in joint.bodies]
            out.append(Link(joint.name, (ends[0], ends[1]), None, joint.twists))
    return out


def separations(
    names: Sequence[BodyName], ground: int, links: Sequence[Link], cache: StepCache | None = None
) -> tuple[tuple[Separation, ...], str, frozenset[JointName]]:
    """What can leave, why it is not known of the rest ("" where it is), and which links open."""
    opened: set[int] = set()
    reason = ""
    joined: list[Sequence[int]] = []
    for block in blocks(len(names), [link.ends for link in links]):
        loose = [k for k in block if links[k].cone is not None]
        if loose and len(block) == 1:
            opened.update(loose)
        elif loose:
            joined.append(block)
    of_each = _opened([[links[k] for k in block] for block in joined], cache)
    for members, solved in zip(joined, of_each, strict=True):
        if solved is None:
            reason = "whether parts can leave is not known of all: some loops of contacts are too large to decide"
        else:
            opened.update(members[k] for k in solved)
    sets, missing = _sets(names, ground, links, opened)
    if missing:
        more = f"{missing} more can move out of contact, but only together with many others, or while these move too"
        reason = f"{reason}; {more}" if reason else more
    return sets, reason, frozenset(links[k].name for k in opened)


def _opened(of_each: Sequence[Sequence[Link]], cache: StepCache | None) -> Sequence[Opened]:
    """Which links of each block can open together: of the block, so far as it is not known."""
    questions = [[(link.ends, link.cone, link.twists) for link in of_block] for of_block in of_each]
    links = {id(question): of_block for question, of_block in zip(questions, of_each, strict=True)}

    def solved(asked: Sequence[object]) -> list[Opened]:
        out: list[Opened] = []
        for first in range(0, len(asked), MOST_IN_STEP):
            ways = [_links_that_open(links[id(question)]) for question in asked[first : first + MOST_IN_STEP]]
            out += run_in_lockstep(ways, nothing_opens_in_each)
        return out

    return cached_each(cache, "opened", questions, solved)


def _links_that_open(links: Sequence[Link]) -> Generator[tuple[Array, Array], bool, Opened]:
    """Indices of the links of one block that can open together; None where the program is too large or fails. It is
    asked on the way whether nothing opens for certain."""
    nodes = {n: k for k, n in enumerate(sorted({n for link in links for n in link.ends}))}
    loose = [k for k, link in enumerate(links) if link.cone is not None]
    frame = _common([link.cone.frame for link in links if link.cone is not None])
    if sum(6 - len(link.twists) if link.cone is None else len(link.cone.rows) for link in links) > MOST_OPENING_ROWS:
        return None
    width = 6 * (len(nodes) - 1)
    if width > MOST_CERTIFIED and _lift_apart(links, nodes):
        return tuple(loose)
    turned = [_in_frame(link, frame) for link in links]
    less: list[tuple[Array, int, int, int]] = []
    equal: list[tuple[Array, int, int, int]] = []
    for k, link in enumerate(links):
        a, b = (6 * (nodes[n] - 1) for n in link.ends)
        if link.cone is None:
            equal.append((turned[k], a, b, -1))
        else:
            equal.append((rows_in_frame(link.cone.fixed, link.cone.frame, frame), a, b, -1))
            less.append((-turned[k], a, b, -1))
            less.append((-turned[k].mean(axis=0, keepdims=True), a, b, width + loose.index(k)))
    if width <= MOST_CERTIFIED:
        if (yield -_dense([item for item in less if item[3] < 0], width), _dense(equal, width)):
            return ()
        if _lift_apart(links, nodes):
            return tuple(loose)
    from scipy.optimize import linprog

    columns = width + len(loose)
    upper, fixed = _stack(less, columns), _stack(equal, columns)
    bound = np.concatenate([np.full(width, LARGEST_TWIST), np.ones(len(loose))])
    lowest = np.concatenate([np.full(width, -LARGEST_TWIST), np.zeros(len(loose))])
    aim = np.concatenate([np.zeros(width), -np.ones(len(loose))])
    solved = linprog(
        aim, A_ub=upper, b_ub=np.zeros(0 if upper is None else upper.shape[0]), A_eq=fixed,
        b_eq=None if fixed is None else np.zeros(fixed.shape[0]), bounds=np.stack([lowest, bound], axis=1),
        method="highs",
    )  # fmt: skip
    if solved.status != 0:
        return None
    return tuple(loose[k] for k in np.flatnonzero(solved.x[width:] > 0.5))


def _lift_apart(links: Sequence[Link], nodes: Mapping[int, int]) -> bool:
    """Whether all links open along a direction in which the one with the fewest directions opens."""
    ends = [(nodes[a], nodes[b]) for a, b in (link.ends for link in links)]
    held = [of for of, link in zip(ends, links, strict=True) if link.cone is None]
    loose = [(of, link.cone) for of, link in zip(ends, links, strict=True) if link.cone is not None]
    ways = [link.slides or () for link in links if link.cone is not None]
    return lifts_apart(len(nodes), held, loose, [way.direction for way in min(ways, key=len)])


def _dense(items: list[tuple[Array, int, int, int]], columns: int) -> Array:
    """The rows of items as `_stack` has them, without the columns of speeds."""
    out = np.zeros((sum(len(rows) for rows, *_ in items), columns))
    count = 0
    for rows, a, b, _ in items:
        for sign, column in ((-1.0, a), (1.0, b)):
            if column >= 0:
                out[count : count + len(rows), column : column + 6] = sign * rows
        count += len(rows)
    return out


def _stack(items: list[tuple[Array, int, int, int]], columns: int) -> csr_matrix | None:
    """One matrix of items (rows (n, 6), first column of the first and of the second body's twist, column of the speed
    s, −1 for none): the rows count the second body's twist less the first's, plus s. None without rows."""
    from scipy.sparse import coo_matrix

    data, i, j, count = [], [], [], 0
    for rows, a, b, slack in items:
        numbers = np.arange(count, count + len(rows))
        for sign, column in ((-1.0, a), (1.0, b)):
            if column >= 0:
                data.append(np.where(np.abs(rows) > HIGHS_FEASIBLE, sign * rows, 0.0).ravel())
                i.append(np.repeat(numbers, 6))
                j.append(np.tile(np.arange(column, column + 6), len(rows)))
        if slack >= 0:
            data.append(np.ones(len(rows)))
            i.append(numbers)
            j.append(np.full(len(rows), slack))
        count += len(rows)
    if not count:
        return None
    stacked = coo_matrix((np.concatenate(data), (np.concatenate(i), np.concatenate(j))), (count, columns)).tocsr()
    stacked.eliminate_zeros()
    return stacked


def _common(frames: Sequence[Frame]) -> Frame:
    """One frame for contacts that have their own."""
    centres = np.array([frame.centre for frame in frames])
    whole = Frame.of(centres)
    length = whole.length if len(frames) > 1 and np.ptp(centres, axis=0).any() else 0.0
    return Frame(whole.centre, max(length, *(frame.length for frame in frames)))


def _in_frame(link: Link, frame: Frame) -> Array:
    """Unit rows (n, 6) of a link against twists scaled in `frame`: what opens, or what is held."""
    if link.cone is None:
        free = scaled(link.twists.T, frame)
        held, _ = np.linalg.qr(free, mode="complete") if free.shape[1] else (np.eye(6), None)
        rows: Array = held[:, free.shape[1] :].T
        return rows
    return rows_in_frame(link.cone.rows, link.cone.frame, frame)


def rows_in_frame(rows: Array, source: Frame, frame: Frame) -> Array:
    """Rows (n, 6) against twists scaled in `source` as rows against twists scaled in `frame`."""
    normals = rows[:, 3:]
    moments = rows[:, :3] * source.length + cross(source.centre - frame.centre, normals)
    return np.concatenate([moments / frame.length, normals], axis=1)


def _sets(
    names: Sequence[BodyName], ground: int, links: Sequence[Link], opened: set[int]
) -> tuple[tuple[Separation, ...], int]:
    """The sets of bodies between opened links, how each leaves the rest, and how many need too many others."""
    together = UnionFind(len(names))
    for k, link in enumerate(links):
        if k not in opened:
            together.union(*link.ends)
    members: dict[int, list[int]] = defaultdict(list)
    for n in range(len(names)):
        members[together.find(n)].append(n)
    sides = _sides(links, sorted(opened), together)
    out: dict[tuple[BodyName, ...], Separation] = {}
    missing = 0
    rest = together.find(ground)
    groups = [_smallest(start, rest, sides) for start in sorted(sides) if start != rest]
    for group, ways in zip(groups, _ways(groups, sides), strict=True):
        if not ways:
            missing += 1
            continue
        bodies = tuple(sorted(names[n] for g in group for n in members[g]))
        border = {side.name for g in group for side in sides[g] if side.other not in group}
        out[bodies] = Separation(bodies, tuple(sorted(border)), ways)
    return tuple(out[key] for key in sorted(out)), missing


@dataclass(frozen=True, eq=False)
class _Side:
    """An opened link as one of its ends sees it."""

    name: JointName
    other: int
    cone: Cone
    sign: float
    """1 where this end is the second body of the link."""
    slides: Array
    """(k, 3) unit directions in which this end leaves the other."""
    extreme: bool
    """Whether these are all extreme ones."""


def _sides(links: Sequence[Link], opened: Sequence[int], together: UnionFind) -> dict[int, list[_Side]]:
    out: dict[int, list[_Side]] = defaultdict(list)
    for k in opened:
        link = links[k]
        assert link.cone is not None
        first, second = (together.find(end) for end in link.ends)
        ways = link.slides
        if ways is None:
            (leaving,) = leaving_of_each([link.cone], turns=False)
            ways = tuple(way for way in leaving.releases if way.kind == "slide")
        slides = np.array([way.direction for way in ways]).reshape(-1, 3)
        extreme = all(way.extreme for way in ways)
        out[first].append(_Side(link.name, second, link.cone, -1.0, -slides, extreme))
        out[second].append(_Side(link.name, first, link.cone, 1.0, slides, extreme))
    return out


def _smallest(start: int, rest: int, sides: dict[int, list[_Side]]) -> set[int]:
    """The smallest set with `start` that slides off along a direction in which one of its contacts opens."""
    best: set[int] | None = None
    tried: list[Array] = []
    for side in sides[start]:
        for direction in side.slides:
            if any(norm(direction - other) < 1e-3 for other in tried):
                continue
            tried.append(direction)
            group = _push(start, rest, sides, direction)
            if group is not None and (best is None or len(group) < len(best)):
                best = group
    return best or {start}


def _push(start: int, rest: int, sides: dict[int, list[_Side]], direction: Array) -> set[int] | None:
    """All that moves when `start` slides along the direction; None where the rest is in the way, or too many move."""
    group, queue = {start}, [start]
    while queue:
        for side in sides[queue.pop()]:
            if side.other in group or not _in_the_way(side, direction):
                continue
            if side.other == rest or len(group) == MOST_TOGETHER:
                return None
            group.add(side.other)
            queue.append(side.other)
    return group


def _in_the_way(side: _Side, direction: Array) -> bool:
    held = side.cone.fixed[:, 3:] @ direction
    if any(abs(speed) > CONE_HELD for speed in held.tolist()):
        return True
    speeds = side.cone.rows[:, 3:] @ direction
    return bool(speeds.min() < -CONE_HELD if side.sign > 0.0 else speeds.max() > CONE_HELD)


def _ways(groups: Sequence[set[int]], sides: dict[int, list[_Side]]) -> list[tuple[Release, ...]]:
    """How each of the groups, as one body, leaves what it touches."""
    borders = [[side for g in sorted(group) for side in sides[g] if side.other not in group] for group in groups]
    alone = [len(border) == 1 and len(border[0].slides) > 0 for border in borders]
    cones = [_cone_beside(border) for border, known in zip(borders, alone, strict=True) if border and not known]
    held = certainly_held(cones)
    certain = iter(held)
    leaving = iter(leaving_of_each([cone for cone, sure in zip(cones, held, strict=True) if not sure], turns=False))
    out: list[tuple[Release, ...]] = []
    for border, known in zip(borders, alone, strict=True):
        if known:
            out.append(_ways_of(border[0]))
        else:
            out.append(() if not border or next(certain) else next(leaving).releases)
    return out


def _ways_of(side: _Side) -> tuple[Release, ...]:
    """How a body leaves by the one contact that it has: that is known."""
    slides = side.slides + 0.0
    order = np.lexsort(np.round(slides, 6).T)[::-1]
    return tuple(
        release_of(np.concatenate([np.zeros(3), slide]), side.cone.frame, extreme=side.extreme)
        for slide in slides[order]
    )


def _cone_beside(border: Sequence[_Side]) -> Cone:
    """The cone that all contacts of a group leave it."""
    frame = border[0].cone.frame if len(border) == 1 else _common([side.cone.frame for side in border])
    fixed = [rows_in_frame(side.cone.fixed, side.cone.frame, frame) for side in border]
    rows = [side.sign * rows_in_frame(side.cone.rows, side.cone.frame, frame) for side in border]
    held = split_directions(unit_rows(np.concatenate(fixed)))[0].T
    return Cone(held, rows_beside(unit_rows(np.concatenate(rows)), held), frame)
