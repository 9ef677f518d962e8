"""The kinematics stage: contacts → bodies, joints, constraint matrix, mobility."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.bodies.classification import Pairs, decide_all
from kinform.kinematics.bodies.extents import Extents
from kinform.kinematics.bodies.fasteners import about_axes, fasten, labelled
from kinform.kinematics.bodies.higher_pairs import agree
from kinform.kinematics.bodies.matrix import assemble
from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.bodies.proportions import proportioned
from kinform.kinematics.bodies.snapping import snap, uncertainties
from kinform.kinematics.bodies.stated_joints import intended_joint, pair_between, stated_joints
from kinform.kinematics.mobility.closure import Closure, body_twists, close
from kinform.kinematics.mobility.couplings import couplings
from kinform.kinematics.mobility.finite import finite_mobility
from kinform.kinematics.mobility.named_freedoms import named_freedoms
from kinform.kinematics.mobility.redundancy import redundancies_of_loops
from kinform.kinematics.mobility.sites import redundancy_within
from kinform.kinematics.mobility.spinning import idle_turns, touching_balls
from kinform.kinematics.mobility.stated_couplings import coupled_mobility, coupling_rows, restricted
from kinform.kinematics.pair.answer import Answers, bare_patches
from kinform.kinematics.separation.contact_rows import ContactRows, pair_cones
from kinform.kinematics.separation.releases import with_releases
from kinform.kinematics.separation.separations import links_between, separations
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Coupling, Joint, Kinematics, Misfit, Mobility, Separation
from kinform.model.names import BodyName, JointName, PartName
from kinform.model.surfaces import MeshSurfaces

__all__ = ["derive", "functional", "mobility_within"]


Beside = Callable[[Callable[[], Any], Callable[[], Any]], tuple[Any, Any]]
"""Gives what two computations give."""

SEVERAL = 48
"""Joints from which it pays to begin another process."""
MOST_NUMBERS = 1_000_000
"""Largest dense basis of freedoms that is kept; the named freedoms are sparse."""


def derive(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    answers: Answers | None = None,
    beside: Beside | None = None,
) -> Kinematics:
    """Bodies, joints, J and mobility of an assembly whose contacts are known.

    Parts are fused by groups, assumptions and contact of rank six; fusing comes before joints, so
    bodies are classified again until nothing fuses. Stick bodies take their joints from [function]. What is asked of
    single pairs, and of all together, may be known to `answers`. What needs nothing of each other may be computed
    `beside` each other.
    """
    merger, extents = Merger(assembly), Extents(assembly)
    patches = bare_patches(contacts.patches)
    pairs = Pairs(assembly, contacts, patches, extents, answers)
    decided = decide_all(pairs, merger)
    if fasten(assembly, contacts, merger):
        decided = decide_all(pairs, merger)
    bodies = merger.bodies()
    of_part = {part: body.name for body in bodies for part in body.parts}
    stated = stated_joints(assembly, of_part)
    joints: list[Joint] = []
    strict: dict[JointName, Array] = {}
    misaligned: list[tuple[str, float, float]] = []
    for pair in sorted(set(decided) | set(stated)):
        if pair in stated:
            joints.append(stated[pair])
            continue
        answer, joint = decided[pair]
        joints.append(joint)
        if answer.strict is not None:
            strict[joint.name] = answer.strict
        if answer.angle > 0.0 or answer.offset > 0.0:
            misaligned.append((joint.name, answer.angle, answer.offset))
    joints = labelled(about_axes(assembly, contacts, joints, bodies), bodies)
    snapped, misfit = snap(joints, patches, extents.assembly)
    snapped, misfit = proportioned(bodies, snapped, uncertainties(snapped, patches), extents.assembly, misfit)
    closed = agree(bodies, snapped, patches, extents.assembly, assembly.tolerances.alignment)
    return _finish(
        assembly, bodies, closed, patches, misfit, strict, tuple(misaligned), extents.assembly,
        _clusters(assembly, contacts), touching_balls(assembly, surfaces, contacts.patches), pairs.extremes, answers,
        beside,
    )  # fmt: skip


def functional(assembly: Assembly) -> Kinematics:
    """The ball-and-stick model: groups and parts as bodies, joints straight from [function]."""
    merger = Merger(assembly)
    for joint in assembly.function.joints:
        if joint.type == "fixed":
            first, second = (assembly.parts_of(name)[0] for name in joint.between)
            merger.fuse(first, second, f"intended joint {joint.name}")
    bodies = merger.bodies()
    of_part = {part: body.name for body in bodies for part in body.parts}
    stated = {}
    for joint in assembly.function.joints:
        pair = pair_between(assembly, of_part, joint.between)
        if pair is not None:
            stated[pair] = intended_joint(pair, joint, of_part[assembly.parts_of(joint.between[0])[0]])
    joints = tuple(stated[pair] for pair in sorted(stated))
    size = Extents(assembly).assembly
    found = _finish(assembly, bodies, joints, (), Misfit(), {}, (), size, bodies)
    return _with_couplings(assembly, found, of_part, size) if assembly.function.couplings else found


def _with_couplings(
    assembly: Assembly, kinematics: Kinematics, of_part: Mapping[PartName, BodyName], size: float
) -> Kinematics:
    """The ball-and-stick model with the freedoms that the stated couplings leave."""
    bodies, joints = kinematics.bodies, kinematics.joints
    index = {body.name: k for k, body in enumerate(bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    spaces = [joint.twists for joint in joints]
    ground = next(k for k, body in enumerate(bodies) if body.ground)
    closure = close(len(bodies), edges, spaces, ground, size)
    rows = coupling_rows(
        assembly.function, joints, lambda name: of_part[assembly.parts_of(name)[0]], closure.offset
    )  # fmt: skip
    tied = restricted(closure, rows)
    counted = coupled_mobility(kinematics.mobility, closure, tied, rows)
    poses = {part.name: part.X_WP for part in assembly.parts}
    places = [poses[body.parts[0]][:3, 3] for body in bodies]
    mobility = replace(
        counted, freedoms=_freedoms(tied, edges, spaces), named=named_freedoms(bodies, joints, tied, {}, places)
    )
    return replace(kinematics, mobility=mobility)


def mobility_within(kinematics: Kinematics, part_names: Sequence[str]) -> int:
    """Freedoms of some parts among themselves, finite where that is known: the bodies they belong to and
    the joints between those, relative to the first of these bodies (or ground, if it is among them)."""
    wanted = set(part_names)
    bodies = [b for b in kinematics.bodies if wanted.intersection(b.parts)]
    if not bodies:
        return 0
    index = {b.name: k for k, b in enumerate(bodies)}
    joints = [j for j in kinematics.joints if j.bodies[0] in index and j.bodies[1] in index]
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    ground = next((k for k, b in enumerate(bodies) if b.ground), 0)
    size = kinematics.matrix.length
    count = close(len(bodies), edges, [j.twists for j in joints], ground, size).mobility
    finite = finite_mobility(edges, joints, len(bodies), count, size).count
    return count if finite is None else finite


def _clusters(assembly: Assembly, contacts: Contacts) -> tuple[Body, ...]:
    """The parts that something other than contact makes one: what could come apart, seen from contact alone."""
    merger = Merger(assembly)
    fasten(assembly, contacts, merger)
    return merger.bodies()


def _finish(
    assembly: Assembly,
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    patches: tuple[Patch, ...],
    misfit: Misfit,
    strict: Mapping[JointName, Array],
    misaligned: tuple[tuple[str, float, float], ...],
    size: float,
    clusters: tuple[Body, ...],
    balls: Mapping[tuple[int, PartName], Array] | None = None,
    extremes: Mapping[int, NDArray[np.int64]] | None = None,
    answers: Answers | None = None,
    beside: Beside | None = None,
) -> Kinematics:
    def moving() -> tuple[Mobility, tuple[Coupling, ...]]:
        return _mobility(assembly, bodies, joints, patches, strict, size, balls or {}, answers)

    def parting() -> tuple[ConstraintMatrix, tuple[Joint, ...], tuple[Separation, ...], str]:
        return _parting(bodies, joints, patches, clusters, extremes, answers)

    if beside is None or len(joints) < SEVERAL:
        beside = _in_turn
    (matrix, told, apart, reason), (mobility, tied) = beside(parting, moving)
    return Kinematics(bodies, told, matrix, mobility, misfit, misaligned, apart, reason, tied)


def _in_turn(first: Callable[[], Any], second: Callable[[], Any]) -> tuple[Any, Any]:
    return first(), second()


def _mobility(
    assembly: Assembly,
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    patches: tuple[Patch, ...],
    strict: Mapping[JointName, Array],
    size: float,
    balls: Mapping[tuple[int, PartName], Array],
    answers: Answers | None,
) -> tuple[Mobility, tuple[Coupling, ...]]:
    """What the joints let move, and the ratios in which they are coupled."""
    index = {body.name: k for k, body in enumerate(bodies)}
    edges = [(index[j.bodies[0]], index[j.bodies[1]]) for j in joints]
    ground = next(k for k, body in enumerate(bodies) if body.ground)
    spaces = [joint.twists for joint in joints]
    doubts = uncertainties(joints, patches)
    closure = close(len(bodies), edges, spaces, ground, size, doubts)
    hard = [strict.get(joint.name, joint.twists) for joint in joints]
    blocked = close(len(bodies), edges, hard, ground, size, doubts).mobility if strict else closure.mobility
    turns = idle_turns(assembly, bodies, joints, patches, size, balls, answers)
    idle = {name: len(own) for name, own in turns.items()}
    count = closure.mobility
    tied = couplings(assembly, bodies, joints, patches, closure)
    constant = {coupling.through for coupling in tied if coupling.meshing is not None}
    finite = finite_mobility(edges, joints, len(bodies), count, size, tied, answers)
    poses = {part.name: part.X_WP for part in assembly.parts}
    places = [poses[body.parts[0]][:3, 3] for body in bodies]
    within = [redundancy_within(joint, patches, assembly.tolerances) for joint in joints]
    mobility = Mobility(
        instantaneous=count,
        finite=finite.count,
        effective=(count if finite.count is None else finite.count) - sum(idle.values()),
        idle=sum(idle.values()),
        redundant=count - (6 * (len(bodies) - 1) - sum(6 - joint.freedoms for joint in joints)),
        blocked=blocked,
        freedoms=_freedoms(closure, edges, spaces),
        idle_bodies=tuple(sorted(name for name, n in idle.items() if n)),
        uncertain=tuple(j.name for j in joints if _uncertain(j, constant)),
        finite_reason=finite.reason,
        infinitesimal=finite.infinitesimal,
        singular=finite.singular,
        certificates=finite.certificates,
        named=named_freedoms(bodies, joints, closure, turns, places),
        redundancies=(*filter(None, within), *redundancies_of_loops(joints, edges, closure, size)),
    )
    return mobility, tied


def _parting(
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    patches: tuple[Patch, ...],
    clusters: tuple[Body, ...],
    extremes: Mapping[int, NDArray[np.int64]] | None,
    answers: Answers | None,
) -> tuple[ConstraintMatrix, tuple[Joint, ...], tuple[Separation, ...], str]:
    """J, the joints with how they come apart, what can leave, and why it is not known of the rest."""
    matrix = assemble(bodies, joints, patches, extremes)
    rows = ContactRows(matrix, bodies, patches)
    joints = with_releases(joints, pair_cones(rows, joints, patches), answers)
    links = links_between(clusters, bodies, joints, patches, rows)
    first = next(k for k, item in enumerate(clusters) if item.ground)
    apart, reason = separations([item.name for item in clusters], first, links, answers)
    return matrix, joints, apart, reason


def _uncertain(joint: Joint, constant: Collection[str]) -> bool:
    """Whether counts depend on a joint that is not certain; teeth of a constant ratio are."""
    return joint.status in ("ambiguous", "blocked") or (joint.type == "general" and joint.name not in constant)


def _freedoms(closure: Closure, edges: Sequence[tuple[int, int]], spaces: Sequence[Array]) -> Array:
    """Orthonormal basis (k, bodies, 6) of the twists of all bodies; none where it would be very large."""
    count, nodes = closure.mobility, len(closure.tree.parent)
    if count == 0 or 6 * count * nodes > MOST_NUMBERS:
        return np.zeros((0, nodes, 6))
    twists = body_twists(closure, edges, spaces)
    basis, _ = np.linalg.qr(twists.reshape(count, -1).T)
    return basis.T.reshape(count, nodes, 6)
