"""Finite mobility of the assembly: which first-order freedoms are motions over a distance.

Each block of the graph of bodies and joints is tried by itself (`local_dimension`), though in step with others, which
takes less time; a bridge closes no loop, so its freedoms are motions. A `general` joint is known by its velocities
alone, which say nothing of where they lead: its block counts only where its other joints, with the general ones held,
move as freely.
"""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.graphs.graph import UnionFind, blocks
from kinform.foundation.lockstep import run_in_lockstep
from kinform.foundation.words import counted, listed
from kinform.frozen import dataclass
from kinform.kinematics.mobility.local_dimension import LocalMotions, local_motions_of_each
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.loop_system import LoopSystem, loop_system
from kinform.mechanism.pose import Pose
from kinform.model.kinematics import Coupling, FiniteCertificate, Joint
from kinform.model.names import JointName

MOST_BLOCK_WORK = 5e8
"""Multiplications of one singular value decomposition of a block; above it the block is not tried. A mesh of
300 hinges has 5e7, one of 250 ball joints about 5e8."""
MOST_BATCH_NUMBERS = 200_000
"""Squares of freedoms of blocks that are tried in step: 10,000 four-bars, but no two blocks of 500 hinges, whose
matrices would take the memory of both."""
MOVING_JOINT = 1e-3
"""Share of the fastest rate from which on a joint is named as moving. Chosen, not measured."""
MOST_STATEMENTS = 4
"""Blocks whose statements are told one by one. Chosen, not measured."""


Certified = Generator[LoopSystem, LocalMotions, FiniteCertificate | None]
"""A way to a certificate, on which it is asked how loops move."""


@dataclass(frozen=True)
class Finite:
    """The count, what is special about the pose, and why one may believe it."""

    count: int | None
    reason: str
    """Freedoms that are no motions, bifurcations, and what could not be decided; empty where all move."""
    infinitesimal: int
    singular: bool
    certificates: tuple[FiniteCertificate, ...]
    on_edge: bool = False


def finite_mobility(
    edges: Sequence[tuple[int, int]],
    joints: Sequence[Joint],
    nodes: int,
    instantaneous: int,
    size: float,
    ties: Sequence[Coupling] = (),
) -> Finite:
    """Finite mobility of joints between bodies 0 … nodes−1 (`edges`, in the order of `joints`) that have
    `instantaneous` freedoms of first order; `size` of the assembly (m); `ties`: couplings of constant ratio, which
    stand for the contacts that they go through."""
    trees = UnionFind(nodes)
    for a, b in edges:
        trees.union(a, b)
    of_graph = blocks(nodes, edges)
    # bridges, and trees that are loose
    open_ended = 6 * (len({trees.find(n) for n in range(nodes)}) - 1)
    open_ended += sum(joints[block[0]].freedoms for block in of_graph if len(block) == 1)
    looped = [block for block in of_graph if len(block) > 1]
    certificates = []
    for batch in _batches(looped, [sum(joints[k].freedoms for k in block) for block in looped]):
        found = run_in_lockstep([_block(edges, joints, block, size, ties) for block in batch], local_motions_of_each)
        certificates += [certificate for certificate in found if certificate is not None]
    first = [c.instantaneous for c in certificates if c.instantaneous is not None]
    last = [c.finite for c in certificates if c.finite is not None]
    statements = [c.statement for c in sorted(certificates, key=lambda c: c.finite is not None) if c.statement]
    if len(first) == len(certificates) and open_ended + sum(first) != instantaneous:
        why = "two ways to count the freedoms of first order disagree: a rank is on the edge"
        return Finite(None, why, 0, False, tuple(certificates), on_edge=True)
    if len(statements) > MOST_STATEMENTS:
        shown = MOST_STATEMENTS - 1
        statements = [*statements[:shown], f"and {len(statements) - shown} more blocks of joints"]
    return Finite(
        count=open_ended + sum(last) if len(last) == len(certificates) else None,
        reason="; ".join(statements),
        infinitesimal=sum(c.infinitesimal for c in certificates),
        singular=any(c.singular for c in certificates),
        certificates=tuple(certificates),
    )


def _batches(of_graph: Sequence[Sequence[int]], freedoms: Sequence[int]) -> Iterator[Sequence[Sequence[int]]]:
    """Blocks, of so many `freedoms` each, in lots that are small enough to be held at once."""
    batch: list[Sequence[int]] = []
    numbers = 0
    for block, count in zip(of_graph, freedoms, strict=True):
        if batch and numbers + count**2 > MOST_BATCH_NUMBERS:
            yield batch
            batch, numbers = [], 0
        batch.append(block)
        numbers += count**2
    if batch:
        yield batch


def _block(
    every_edge: Sequence[tuple[int, int]],
    every_joint: Sequence[Joint],
    block: Sequence[int],
    size: float,
    every_tie: Sequence[Coupling],
) -> Certified:
    """The certificate of one block with loops; None where nothing in it moves, even at first order.

    Gears whose ratios are known are tried as ratios; other general joints are held, and ambiguous ones leave the motion
    unknown.
    """
    edges, joints = [every_edge[k] for k in block], [every_joint[k] for k in block]
    names = tuple(joint.name for joint in joints)
    geared = _without_gears(joints, tuple(tie for tie in every_tie if tie.through in names))
    if geared is not None:
        kept, ratios = geared
        members = [joints[k] for k in kept]
        system = loop_system([edges[k] for k in kept], [j.twists for j in members], joint_frame(members, size), ratios)
        certificate = _certificate([joint.name for joint in members], system, (yield system))
        return certificate and replace(certificate, joints=names)
    frame = joint_frame(joints, size)
    system = loop_system(edges, [joint.twists for joint in joints], frame)
    rows, columns = 6 * len(system.loops), system.coordinates
    if rows * columns * min(rows, columns) > MOST_BLOCK_WORK:
        why = f"{len(joints)} joints in one block, from {names[0]} to {names[-1]}, are too many to be tried"
        return FiniteCertificate(names, None, None, statement=why)
    doubtful = [joint.name for joint in joints if joint.status == "ambiguous"]
    general = [joint.name for joint in joints if joint.type == "general"]
    if not doubtful and not general:
        return _certificate(names, system, (yield system))
    count = Pose.at(system, system.start[0]).freedoms
    if count == 0:
        return None
    if not doubtful:
        held = [joint.twists[:0] if joint.type == "general" else joint.twists for joint in joints]
        system = loop_system(edges, held, frame)
        certificate = _certificate(names, system, (yield system))
        if certificate is not None and certificate.finite == count:
            return certificate
    why = f"{_few(doubtful)} is ambiguous" if doubtful else f"{_few(general)} is known by its velocities only"
    if len(doubtful or general) > 1:
        why = why.replace(" is ", " are ").replace("its", "their")
    return FiniteCertificate(names, count, None, statement=f"not known how the loops move over a distance: {why}")


def _without_gears(
    joints: Sequence[Joint], ties: Sequence[Coupling]
) -> tuple[list[int], list[tuple[int, int, float]]] | None:
    """Joints that are left when the contacts of gears are taken out, and the ratios between these (by their places
    among them); None where there are no gears, or something else is not certain."""
    meshing = {tie.through: (tie.joints, tie.meshing.ratio) for tie in ties if tie.meshing is not None}
    general = [joint.name for joint in joints if joint.type == "general"]
    if not general or not set(general) <= set(meshing) or any(joint.status == "ambiguous" for joint in joints):
        return None
    kept = [k for k, joint in enumerate(joints) if joint.type != "general"]
    place = {joints[k].name: n for n, k in enumerate(kept)}
    gears = [meshing[name] for name in general]
    if not all(name in place for names, _ in gears for name in names):
        return None
    return kept, [(place[a], place[b], ratio) for (a, b), ratio in gears]


def _certificate(names: Sequence[JointName], system: LoopSystem, motions: LocalMotions) -> FiniteCertificate | None:
    """How the loops of these joints move, with names and in words; None where nothing moves."""
    if not motions.freedoms:
        return None
    # a shaky part that rides along is as short of freedoms on the one branch
    always = len(motions.branches) == 1 and motions.stepped == motions.freedoms
    decided = motions.dimension is not None
    singular = decided and any(count < motions.freedoms for count in motions.branches) and not always
    rates = np.abs(motions.lost).max(axis=0, initial=0.0)
    moves = tuple(names[k] for k in np.unique(system.joint[rates > MOVING_JOINT * rates.max(initial=0.0)]))
    return FiniteCertificate(
        joints=tuple(names),
        instantaneous=motions.freedoms,
        finite=motions.dimension,
        infinitesimal=len(motions.lost),
        singular=singular,
        branches=motions.branches,
        step=motions.step,
        kept=round(motions.kept, 6),
        residual=_bound(motions.residual),
        stepped=motions.stepped,
        second_order=motions.order,
        moves=moves,
        statement=_statement(names, moves, motions, singular),
    )


def _bound(residual: float) -> float:
    """The next power of ten: what is below rounding is not worth a digit."""
    return float(10.0 ** math.ceil(math.log10(max(residual, 1e-15))))


def _statement(names: Sequence[str], moves: Sequence[str], motions: LocalMotions, singular: bool) -> str:
    """What is special about the motions; "" where all freedoms of first order are motions at a regular pose."""
    if motions.dimension is None:
        return f"not known how the loops of {_few(names)} move over a distance: {motions.reason}"
    freedoms, lost, branches = counted(motions.freedoms, "freedom"), len(motions.lost), motions.branches
    sentences = []
    if lost:
        verb = "is" if lost == 1 else "are"
        sentences.append(
            f"{lost} of {freedoms} {verb} only infinitesimal: {_few(moves)} give at first order and then lock (shaky)"
        )
    if singular and len(branches) > 1:
        sentences.append(
            f"the pose is a bifurcation: {_few(names)} have {freedoms} here, and {len(branches)} branches "
            f"({' and '.join(map(str, branches))} freedoms) were found that lead out of it"
        )
    elif singular:
        sentences.append(f"the pose is singular: {_few(names)} have {freedoms} here and {branches[0]} beside it")
    return "; ".join(sentences)


def _few(names: Sequence[str], limit: int = 4) -> str:
    """ "a, b and c"; beyond the limit "a, b, c, d and 3 more"."""
    return listed(list(names) if len(names) <= limit + 1 else [*names[:limit], f"{len(names) - limit} more"])
