"""The range of every joint of one freedom until something stops it, from the pose of the meshes.

A joint outside of loops is driven alone, everything else at rest. The joints of a block of loops that has one freedom
are driven together, and so are joints whose values the function couples (mimic joints, gears), with the loops they are
in. Of other joints the range is not known, and it is said why.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from kinform.collisions.driving.alone import drive_alone
from kinform.collisions.driving.loop_motion import Tie
from kinform.collisions.driving.loops import drive_loops, is_followed
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.processes import map_in_processes
from kinform.foundation.progress import Progress
from kinform.foundation.words import counted
from kinform.kinematics.mobility.guides import joint_twist
from kinform.kinematics.mobility.stated_couplings import coupling_rows
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.assembly import Assembly
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Joint, Kinematics, body_of_part
from kinform.model.surfaces import MeshSurfaces

SHARED_FACETS = 200_000
"""Joints times facets from which on processes share them: 300,000, of an arm, take 2 s, starting them 0.1 s."""
UNASKED_PAIRS = 10_000
"""Joints times parts up to which ranges are looked for where nobody asks: 100 links took 2.5 s of processor, ..."""
UNASKED_LOOPS = 8
"""... joints of loops, whose motions are followed step by step, counting so many times: 30 bars of four-bars took 4 s,
90 over a minute; ..."""
UNASKED_FACETS = 30_000_000
"""... and joints times facets: 27 million, of a humanoid of 1.3 million facets, took 9 s, as long as all before."""


ONE_FREEDOM = ("revolute", "prismatic", "screw")


def ranges(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts | None,
    kinematics: Kinematics,
    progress: Progress | None = None,
    jobs: int = 1,
    meanwhile: Callable[[], None] | None = None,
) -> tuple[JointRange, ...]:
    """The range of each joint that is not fixed, in the order of the joints; `jobs` processes share those of many
    facets, and `meanwhile` is called while they do."""
    shapes = shapes_of(assembly, surfaces, contacts, kinematics)
    joints, graph = kinematics.joints, JointGraph(kinematics.bodies, kinematics.joints)
    ties = _ties(assembly, kinematics)
    looped = {k: block for block in _together(graph, ties) for k in block}
    driven = [k for k, joint in enumerate(joints) if joint.type != "fixed"]
    out = {k: unknown(joints[k], reason) for k in driven if (reason := _refused(joints[k], kinematics, shapes))}

    def of_some(some: Sequence[int]) -> dict[int, JointRange]:
        if some[0] not in looped:
            still, moving, grounded = _sides(kinematics, graph.edges, some[0], shapes)
            found = drive_alone(shapes, joints[some[0]], still, moving)
            return {some[0]: _second_at_rest(found, joints[some[0]]) if grounded else found}
        block = looped[some[0]]
        of_block = drive_loops(shapes, kinematics, graph, block, [tie for tie in ties if tie[0] in block])
        return {n: unknown(joints[n], of_block) if isinstance(of_block, str) else of_block[n] for n in some}

    # those of a block of loops together, where its first is
    together: dict[int, list[int]] = {}
    for k in driven:
        if k not in out:
            together.setdefault(looped[k][0] if k in looped else k, []).append(k)
    facets = sum(len(part.mesh.faces) for part in assembly.parts if part.mesh is not None)
    shared = jobs if len(together) * facets > SHARED_FACETS else 1
    name = lambda some: f"the range of {joints[some[0]].name}"
    asked = list(together.values())
    # from both ends of a chain: two processes then have few parts in common, each of which they make ready
    weights = [float(max(n, len(asked) - 1 - n)) for n in range(len(asked))]
    for found in map_in_processes(of_some, asked, shared, progress, name, weights=weights, meanwhile=meanwhile):
        out.update(found)
    return tuple(replace(out[k], slides=joints[k].type == "prismatic") for k in driven)


def too_large(assembly: Assembly, kinematics: Kinematics) -> str:
    """Why ranges are looked for only where they are asked for: what is too large; empty where nothing is. It hangs on
    numbers of joints, parts and facets alone, and on which loops move in one way."""
    parts = [part for part in assembly.parts if part.mesh is not None]
    facets = sum(len(part.mesh.faces) for part in parts if part.mesh is not None)
    graph, ties = JointGraph(kinematics.bodies, kinematics.joints), _ties(assembly, kinematics)
    together = _together(graph, ties)
    driven = {k for k, joint in enumerate(kinematics.joints) if joint.type in ONE_FREEDOM}
    if UNASKED_LOOPS * len(driven) * len(parts) > UNASKED_PAIRS:
        # joints of loops that have more than one freedom are not followed, and take no time
        for block in together:
            if not is_followed(kinematics, graph, block, [tie for tie in ties if tie[0] in block]):
                driven -= set(block)
    looped = {k for block in together for k in block}
    weight = sum(UNASKED_LOOPS if k in looped else 1 for k in driven)
    if weight * len(parts) <= UNASKED_PAIRS and len(driven) * facets <= UNASKED_FACETS:
        return ""
    return f"{counted(len(driven), 'joint')}, {counted(len(parts), 'part')} and {facets:,} facets take long"


def _ties(assembly: Assembly, kinematics: Kinematics) -> list[Tie]:
    """Pairs of joints whose values the function couples."""
    of_part = body_of_part(kinematics.bodies)
    sides = {name for joint in assembly.function.joints for name in joint.between}
    body_of = {name: of_part[assembly.parts_of(name)[0]] for name in sides}
    offset = [0, *accumulate(joint.freedoms for joint in kinematics.joints)]
    out: list[Tie] = []
    if not offset[-1]:
        return out
    for row in coupling_rows(assembly.function, kinematics.joints, body_of, offset):
        ends = np.flatnonzero(row)
        if len(ends) == 2:  # more are more freedoms, and followed nowhere
            a, b = (bisect_right(offset, end) - 1 for end in ends.tolist())
            out.append((a, b, -float(row[ends[1]] / row[ends[0]])))
    return out


def _together(graph: JointGraph, ties: Sequence[Tie]) -> list[list[int]]:
    """Joints that move together: those of blocks of loops, and of all that ties connect."""
    sets = UnionFind(len(graph.joints))
    for some in (*graph.loops, *((a, b) for a, b, _ in ties)):
        for k in some[1:]:
            sets.union(some[0], k)
    out: dict[int, list[int]] = {}
    for k in sorted({k for some in (*graph.loops, *((a, b) for a, b, _ in ties)) for k in some}):
        out.setdefault(sets.find(k), []).append(k)
    return list(out.values())


def shapes_of(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts | None, kinematics: Kinematics
) -> Shapes:
    """The meshes of an assembly, for questions about motions."""
    meshed = {p.name for p in assembly.parts if p.mesh is not None and p.mesh.digest in surfaces and len(p.mesh.faces)}
    parts = {str(body.name): frozenset(str(p) for p in body.parts if p in meshed) for body in kinematics.bodies}
    return Shapes(assembly, dict(surfaces), contacts, parts)


def unknown(joint: Joint, reason: str) -> JointRange:
    """The range of a joint of which nothing is known."""
    return JointRange(joint.name, RangeEnd("unknown", reason=reason), RangeEnd("unknown", reason=reason))


def _refused(joint: Joint, kinematics: Kinematics, shapes: Shapes) -> str:
    if joint.type not in ONE_FREEDOM:
        return f"a {joint.type} joint has no single range"
    if joint.status == "ambiguous":
        return "the joint is ambiguous"
    if joint.axis is None or (joint.type != "prismatic" and joint.point is None):
        return "the joint has no axis"
    bare = [body.name for body in kinematics.bodies if not shapes.body_parts[body.name]]
    without = [name for name in joint.bodies if name in bare]
    if without:
        return (
            f"{' and '.join(without)} has no mesh" if len(without) == 1 else f"{' and '.join(without)} have no meshes"
        )
    return ""


def _sides(
    kinematics: Kinematics, edges: Sequence[tuple[int, int]], k: int, shapes: Shapes
) -> tuple[list[str], list[str], bool]:
    """Parts that rest and parts that move when joint k is driven alone: those that hang on its second body; and whether
    the ground is one of these."""
    sets = UnionFind(len(kinematics.bodies))
    for n, (a, b) in enumerate(edges):
        if n != k:
            sets.union(a, b)
    far = sets.find(edges[k][1])
    still: list[str] = []
    moving: list[str] = []
    for n, body in enumerate(kinematics.bodies):
        (moving if sets.find(n) == far else still).extend(sorted(shapes.body_parts[body.name]))
    grounded = any(body.ground and sets.find(n) == far for n, body in enumerate(kinematics.bodies))
    return sorted(still), sorted(moving), grounded


def _second_at_rest(item: JointRange, joint: Joint) -> JointRange:
    """The range with places as they are where the second body rests, and the first moves."""

    def moved(end: RangeEnd) -> RangeEnd:
        if end.value is None or end.place is None:
            return end
        place = displacement(-end.value * joint_twist(joint)) @ np.append(end.place, 1.0)
        return replace(end, place=place[:3])

    return replace(item, lower=moved(item.lower), upper=moved(item.upper))
