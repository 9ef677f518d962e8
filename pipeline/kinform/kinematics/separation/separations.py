"""What can leave the assembly, ground held: one linear program a block of the graph of contacts.

In a block each pair whose own rows hold it is bilateral; each other pair j may open, by JV ≥ 0, and opens by s_j.
Maximising Σ s_j with s_j ≤ 1 over a cone opens every pair that can open at once: what opens is known from a
single solution, for a sum of motions in the cone is in the cone. Where all open along one direction (`lifting`), or
none does for certain (`nothing_opens`), no program is needed. Which bodies leave together, by opening contact and by
sliding along it, is then asked of their translations (`leaving_groups`). Blocks know nothing of each other, as in the
closure of loops.

Contact that fuses bodies is looked at too: a block in a corner has no freedom, and is not held.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinform.foundation.algebra.screws import Frame, twist_at_origin
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.lockstep import run_in_lockstep
from kinform.frozen import dataclass
from kinform.kinematics.separation.cone import nothing_opens_in_each
from kinform.kinematics.separation.constants import HIGHS_FEASIBLE
from kinform.kinematics.separation.contact_rows import ContactRows, is_stated
from kinform.kinematics.separation.leaving_groups import leaving_groups
from kinform.kinematics.separation.lifting import LARGEST_TWIST, lifts_apart
from kinform.kinematics.separation.links import (
    Link,
    common_frame,
    rows_in_frame,
    translations_of_cone,
    translations_of_twists,
)
from kinform.kinematics.separation.releases import certainly_held
from kinform.kinematics.step_cache import StepCache, cached_each
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, Joint, Separation
from kinform.model.names import BodyName, JointName

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

MOST_IN_STEP = 250
"""Programs that are solved together: more gain no speed."""
MOST_CERTIFIED = 120
"""Components of twists up to which it is first asked whether anything opens in a block: dense algebra of a
millisecond, where importing and calling a linear program takes hundreds."""
MOST_OPENING_ROWS = 12_000
"""Rows of one block's program beyond which it would take minutes: 400 bricks in a wall, 5,000 rows, take 3 s."""
MOST_TOGETHER = 8
"""Bodies up to which those are told that leave together. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Leaving:
    """Bodies that leave together, the rest at rest."""

    separations: tuple[Separation, ...]
    """By breaking contact."""
    slides: tuple[Separation, ...]
    """Along contact that stays."""
    reason: str
    """Why it is not known of the rest; "" where it is."""
    opened: frozenset[JointName]
    """Contacts that the assembly lets open."""


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
    carried = {joint.bodies: set(joint.touching) for joint in joints}
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
            twists, opening = twist_at_origin(cone.preserved, cone.frame).T, None
        else:
            twists, opening = np.zeros((0, 6)), cone
        out.append(Link(name, (a, b), opening, twists, slides.get(name), translations_of_cone(cone)))
    for joint in joints:
        if is_stated(joint):
            ends = [min(cluster[p] for p in rows.parts_of(name)) for name in joint.bodies]
            straight = translations_of_twists(joint.twists, rows.frame)
            out.append(Link(joint.name, (ends[0], ends[1]), None, joint.twists, (), straight))
    return out


def separations(
    names: Sequence[BodyName], ground: int, links: Sequence[Link], cache: StepCache | None = None
) -> Leaving:
    """What can leave."""
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
    found = leaving_groups(names, ground, links, opened)
    if found.missing:
        more = (
            f"{found.missing} more can move out of contact, but only together with many others, or while these move too"
        )
        reason = f"{reason}; {more}" if reason else more
    return Leaving(found.separations, found.slides, reason, frozenset(links[k].name for k in opened))


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
    frame = common_frame([link.cone.frame for link in links if link.cone is not None])
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


def _in_frame(link: Link, frame: Frame) -> Array:
    """Unit rows (n, 6) of a link against twists scaled in `frame`: what opens, or what is held."""
    if link.cone is None:
        return link.held_in(frame)
    return rows_in_frame(link.cone.rows, link.cone.frame, frame)
