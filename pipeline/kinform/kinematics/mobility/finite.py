"""Finite mobility of the assembly: which first-order freedoms are motions over a distance.

Each block of the graph of bodies and joints is tried by itself (`flexes`); a bridge closes no loop, so its
freedoms are motions. A `general` joint is known by its velocities alone, which say nothing of where they
lead: its block counts only where its other joints, with the general ones held, move as freely.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.graphs.graph import UnionFind, blocks
from kinform.kinematics.mobility.flexes import Flex, flex
from kinform.kinematics.mobility.loop_system import LoopSystem, loop_system
from kinform.kinematics.mobility.poses import first_order
from kinform.kinematics.pair.answer import Answers, ask
from kinform.model.kinematics import Coupling, FiniteCertificate, Joint
from kinform.model.names import JointName

__all__ = ["Finite", "finite_mobility"]


PLACED = ("revolute", "screw", "cylindrical", "spherical", "universal")
"""Joints whose point says where the mechanism is."""
WORK = 5e8
"""Multiplications of one singular value decomposition of a block; above it the block is not tried. A mesh of
300 hinges has 5e7, one of 250 ball joints about 5e8."""


@dataclass(frozen=True)
class Finite:
    """The count, what is special about the pose, and why one may believe it."""

    count: int | None
    reason: str
    """Freedoms that are no motions, bifurcations, and what could not be decided; empty where all move."""
    infinitesimal: int
    singular: bool
    certificates: tuple[FiniteCertificate, ...]


def finite_mobility(
    edges: Sequence[tuple[int, int]],
    joints: Sequence[Joint],
    nodes: int,
    instantaneous: int,
    size: float,
    ties: Sequence[Coupling] = (),
    answers: Answers | None = None,
) -> Finite:
    """Finite mobility of joints between bodies 0 … nodes−1 (`edges`, in the order of `joints`) that have
    `instantaneous` freedoms of first order; `size` of the assembly (m); `ties`: couplings of constant ratio, which
    stand for the contacts that they go through."""
    certificates = []
    trees = UnionFind(nodes)
    for a, b in edges:
        trees.union(a, b)
    # bridges, and trees that are loose
    open_ended = 6 * (len({trees.find(n) for n in range(nodes)}) - 1)
    for block in blocks(nodes, edges):
        if len(block) == 1:
            open_ended += joints[block[0]].freedoms
            continue
        own = tuple(tie for tie in ties if any(joints[k].name == tie.through for k in block))
        given = ([edges[k] for k in block], [joints[k] for k in block], size, own)
        found = ask(answers, "finite", given, partial(_block, *given))
        if found is not None:
            certificates.append(found)
    first = [c.instantaneous for c in certificates if c.instantaneous is not None]
    last = [c.finite for c in certificates if c.finite is not None]
    statements = [c.statement for c in sorted(certificates, key=lambda c: c.finite is not None) if c.statement]
    if len(first) == len(certificates) and open_ended + sum(first) != instantaneous:
        why = "two ways to count the freedoms of first order disagree: a rank is on the edge"
        return Finite(None, why, 0, False, tuple(certificates))
    if len(statements) > 4:
        statements = [*statements[:3], f"and {len(statements) - 3} more blocks of joints"]
    decided = len(last) == len(certificates)
    return Finite(
        count=open_ended + sum(last) if decided else None,
        reason="; ".join(statements),
        infinitesimal=sum(c.infinitesimal for c in certificates),
        singular=any(c.singular for c in certificates),
        certificates=tuple(certificates),
    )


def _block(
    edges: Sequence[tuple[int, int]], joints: Sequence[Joint], size: float, ties: Sequence[Coupling] = ()
) -> FiniteCertificate | None:
    """The certificate of one block with loops; None where nothing in it moves, even at first order."""
    geared = _geared(edges, joints, ties)
    if geared is not None:
        return _tied(joints, size, *geared)
    names = tuple(joint.name for joint in joints)
    frame = _frame(joints, size)
    system = loop_system(edges, [joint.twists for joint in joints], frame)
    rows, columns = 6 * len(system.loops), system.coordinates
    if rows * columns * min(rows, columns) > WORK:
        why = f"{len(joints)} joints in one block, from {names[0]} to {names[-1]}, are too many to be tried"
        return FiniteCertificate(names, None, None, statement=why)
    doubtful = [joint.name for joint in joints if joint.status == "ambiguous"]
    general = [joint.name for joint in joints if joint.type == "general"]
    if not doubtful and not general:
        found = flex(system)
        return _certificate(names, system, found) if found.freedoms else None
    count = first_order(system)
    if count == 0:
        return None
    if not doubtful:
        held = [joint.twists[:0] if joint.type == "general" else joint.twists for joint in joints]
        locked = loop_system(edges, held, frame)
        found = flex(locked)
        if found.dimension == count:
            return _certificate(names, locked, found)
    why = f"{_few(doubtful)} is ambiguous" if doubtful else f"{_few(general)} is known by its velocities only"
    if len(doubtful or general) > 1:
        why = why.replace(" is ", " are ").replace("its", "their")
    return FiniteCertificate(names, count, None, statement=f"not known how the loops move over a distance: {why}")


def _geared(
    edges: Sequence[tuple[int, int]], joints: Sequence[Joint], ties: Sequence[Coupling]
) -> tuple[list[tuple[int, int]], list[Joint], list[tuple[int, int, float]]] | None:
    """The block without the contacts of gears, and their ratios between the joints that are left; None where there
    are none, or something else is not certain."""
    known = {coupling.through: coupling for coupling in ties if coupling.meshing is not None}
    general = [joint.name for joint in joints if joint.type == "general"]
    if not general or not set(general) <= set(known) or any(joint.status == "ambiguous" for joint in joints):
        return None
    kept = [k for k, joint in enumerate(joints) if joint.type != "general"]
    place = {joints[k].name: n for n, k in enumerate(kept)}
    pairs = [known[name] for name in general]
    if not all(name in place for coupling in pairs for name in coupling.joints):
        return None
    ratios = []
    for coupling in pairs:
        assert coupling.meshing is not None
        a, b = coupling.joints
        ratios.append((place[a], place[b], coupling.meshing.ratio))
    return [edges[k] for k in kept], [joints[k] for k in kept], ratios


def _tied(
    every: Sequence[Joint],
    size: float,
    edges: Sequence[tuple[int, int]],
    joints: Sequence[Joint],
    ratios: Sequence[tuple[int, int, float]],
) -> FiniteCertificate | None:
    """The certificate of a block in which gears keep ratios."""
    system = loop_system(edges, [joint.twists for joint in joints], _frame(joints, size), ratios)
    found = flex(system)
    certificate = _certificate([joint.name for joint in joints], system, found) if found.freedoms else None
    return certificate and replace(certificate, joints=tuple(joint.name for joint in every))


def _frame(joints: Sequence[Joint], size: float) -> Frame:
    """Centre and size of a block. Points of joints that meet have no size of their own: then a share of
    the assembly's counts, as for the first-order count."""
    placed = [j.point for j in joints if j.point is not None and j.type in PLACED]
    placed = placed or [j.point for j in joints if j.point is not None]
    if not placed:
        return Frame(np.zeros(3), size)
    low, high = np.min(placed, axis=0), np.max(placed, axis=0)
    return Frame(0.5 * (low + high), max(0.5 * float(np.linalg.norm(high - low)), 0.05 * size))


def _certificate(names: Sequence[JointName], system: LoopSystem, found: Flex) -> FiniteCertificate:
    """What was found, with names and in words."""
    decided = found.dimension is not None
    singular = decided and any(count < found.freedoms for count in found.branches) and not _always(found)
    moving = np.abs(found.lost).max(axis=0, initial=0.0)
    moves = tuple(names[k] for k in np.unique(system.joint[moving > 1e-3 * moving.max(initial=0.0)]))
    return FiniteCertificate(
        joints=tuple(names),
        instantaneous=found.freedoms,
        finite=found.dimension,
        infinitesimal=len(found.lost),
        singular=singular,
        branches=found.branches,
        step=found.step,
        kept=round(found.kept, 6),
        residual=_bound(found.residual),
        stepped=found.stepped,
        second_order=found.order,
        moves=moves,
        statement=_statement(names, moves, found, singular),
    )


def _bound(residual: float) -> float:
    """The next power of ten: what is below rounding is not worth a digit."""
    return float(10.0 ** math.ceil(math.log10(max(residual, 1e-15))))


def _always(found: Flex) -> bool:
    """Is the one branch as short of freedoms at the stepped poses: a shaky part that rides along?"""
    return len(found.branches) == 1 and found.stepped == found.freedoms


def _statement(names: Sequence[str], moves: Sequence[str], found: Flex, singular: bool) -> str:
    if found.dimension is None:
        return f"not known how the loops of {_few(names)} move over a distance: {found.reason}"
    said = []
    if len(found.lost):
        verb = "is" if len(found.lost) == 1 else "are"
        said.append(
            f"{len(found.lost)} of {_freedoms(found.freedoms)} {verb} only infinitesimal: "
            f"{_few(moves)} give at first order and then lock (shaky)"
        )
    if singular:
        ways = " and ".join(str(count) for count in found.branches)
        said.append(
            f"the pose is a bifurcation: {_few(names)} have {_freedoms(found.freedoms)} here, and "
            f"{len(found.branches)} branches ({ways} freedoms) were found that lead out of it"
            if len(found.branches) > 1
            else f"the pose is singular: {_few(names)} have {_freedoms(found.freedoms)} here and "
            f"{found.branches[0]} beside it"
        )
    return "; ".join(said)


def _freedoms(count: int) -> str:
    return f"{count} freedom" if count == 1 else f"{count} freedoms"


def _few(names: Sequence[str], limit: int = 4) -> str:
    """ "a, b and c"; beyond the limit "a, b, c, d and 3 more"."""
    shown = list(names) if len(names) <= limit + 1 else [*names[:limit], f"{len(names) - limit} more"]
    return " and ".join(filter(None, [", ".join(shown[:-1]), shown[-1] if shown else ""]))
