"""The kinematics stage: contacts → bodies, joints, constraint matrix, mobility. `derive` reads as its method."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from kinform.foundation.memory import uncollected
from kinform.frozen import dataclass
from kinform.kinematics.answers import Answers
from kinform.kinematics.joints.axes.bounds import move_bounds, uncertainties
from kinform.kinematics.joints.axes.equal_lengths import equalise_lengths
from kinform.kinematics.joints.axes.higher_pairs import align_higher_pairs
from kinform.kinematics.joints.axes.misfit import misfit_of, moves_between
from kinform.kinematics.joints.axes.proportions import fit_proportions
from kinform.kinematics.joints.axes.snapping import snap_axes
from kinform.kinematics.joints.bodies.as_stated import as_stated
from kinform.kinematics.joints.bodies.classification import Pairs, decide_all, decide_beside
from kinform.kinematics.joints.bodies.complete import complete_joints, rests
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.joints.bodies.fasteners import (
    fasten,
    fastenings,
    harmless,
    label_inferred,
    turn_about_suggested_axes,
)
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.readings import choose_readings
from kinform.kinematics.joints.bodies.set_aside import asides
from kinform.kinematics.joints.bodies.stated_joints import Pair, intended_joints, stated_joints
from kinform.kinematics.joints.pair.question import Answer, bare_patches
from kinform.kinematics.mobility.couplings import couplings_between
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.kinematics.mobility.idle import idle_turns, touching_balls
from kinform.kinematics.mobility.joint_redundancy import redundancy_within
from kinform.kinematics.mobility.loop_redundancy import redundancies_of_loops
from kinform.kinematics.mobility.named_freedoms import named_freedoms
from kinform.kinematics.mobility.stated_couplings import coupled_mobility, coupling_rows, restrict_closure
from kinform.kinematics.partition import Partition, left_out, partition, with_sides
from kinform.kinematics.separation.constraint_matrix import constraint_matrix
from kinform.kinematics.separation.contact_rows import ContactRows, pair_cones
from kinform.kinematics.separation.releases import with_releases
from kinform.kinematics.separation.separations import links_between, separations
from kinform.mechanism.first_order import Closure, body_twists
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch, Suggestion
from kinform.model.kinematics import (
    Body,
    ConstraintMatrix,
    Coupling,
    Joint,
    Kinematics,
    Membership,
    Misfit,
    Mobility,
    Separation,
    Unparted,
)
from kinform.model.names import BodyName, JointName, PartName
from kinform.model.surfaces import MeshSurfaces

MOST_BASIS_NUMBERS = 1_000_000
"""Largest dense basis of freedoms that is kept; the named freedoms are sparse."""


@dataclass(frozen=True, eq=False)
class _Mechanism:
    """What mobility and separations are derived from: bodies and joints as they stay, and what stands behind them."""

    assembly: Assembly
    graph: JointGraph
    size: float
    """m: diagonal of the assembly."""
    clusters: tuple[Body, ...]
    """The parts that something other than contact makes one: what could come apart, seen from contact alone."""
    patches: tuple[Patch, ...] = ()
    strict: Mapping[JointName, Array] = field(default_factory=dict)
    """(k, 6) freedoms of blocked joints when every patch counts."""
    balls: Mapping[tuple[int, PartName], Array] = field(default_factory=dict)
    """Centres of spheres that touch at points or along lines, by patch and part."""
    extremes: Mapping[int, Ints] = field(default_factory=dict)
    """Samples that bound patches, of those that are known."""
    answers: Answers | None = None

    @property
    def places(self) -> list[Array]:
        """(3,) m: where each body is, by its first part."""
        pose = {part.name: part.X_WP for part in self.assembly.parts}
        return [pose[body.parts[0]][:3, 3] for body in self.graph.bodies]


@uncollected()
def derive(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    answers: Answers | None = None,
) -> Kinematics:
    """Bodies, joints, J and mobility of an assembly whose contacts are known.

    Parts are fused by groups, assumptions and contact of rank six; fusing comes before joints, so
    bodies are classified again until nothing fuses. Stick bodies take their joints from [function]. What is asked of
    single pairs, and of all together, may be known to `answers`. Raises InputError where a joint names one side or none
    and it is not clear which are meant.
    """
    assembly, sides = with_sides(assembly, contacts)
    extents = Extents(assembly)
    patches, size = bare_patches(contacts.patches), extents.assembly
    pairs = Pairs(assembly, contacts, patches, extents, answers)
    found = partition(assembly, contacts, assembly.function.joints, surfaces) if _complete(assembly) else None
    settled = complete_joints(assembly)
    merger, decided, hints = _fuse_and_decide(pairs, contacts, found)
    bodies = merger.bodies()
    decided = choose_readings(assembly, _body_of_part(bodies), decided, patches, size)
    stated = stated_joints(assembly, _body_of_part(bodies))
    answers_of = {joint.name: answer for pair, (answer, joint) in sorted(decided.items()) if pair not in stated}
    every = {pair: joint for pair, (_, joint) in decided.items()} | stated
    joints = turn_about_suggested_axes(assembly, contacts, [every[pair] for pair in sorted(every)], bodies)
    joints = label_inferred(joints, bodies)
    by_contact = JointGraph(bodies, tuple(joints)).close(size).mobility if settled else None
    beside: tuple[Joint, ...] = ()
    if settled:
        taken = as_stated(assembly, merger, joints, decide_beside(pairs, merger), patches, whole=found is not None)
        joints, beside = list(taken.joints), taken.beside
        kept = {joint.name for joint in joints if joint.status != "stated"}
        answers_of = {name: answer for name, answer in answers_of.items() if name in kept}
    bounds = move_bounds(joints, patches, assembly.tolerances.alignment, size)
    snapped = snap_axes(joints, bounds)
    left = bounds.after(moves_between(joints, snapped), joints)
    equal = equalise_lengths(JointGraph(bodies, snapped), left, size)
    left = bounds.after(moves_between(joints, equal), joints)
    fitted = fit_proportions(JointGraph(bodies, equal), left, size)
    moves = moves_between(joints, fitted)
    aligned = align_higher_pairs(JointGraph(bodies, fitted), patches, size, assembly.tolerances.alignment)
    mechanism = _Mechanism(
        assembly=assembly,
        graph=JointGraph(bodies, aligned),
        size=size,
        clusters=bodies if found is not None else _clusters(assembly, hints),
        patches=patches,
        strict={name: answer.strict for name, answer in answers_of.items() if answer.strict is not None},
        balls=touching_balls(assembly, surfaces, contacts.patches),
        extremes=pairs.extremes,
        answers=answers,
    )
    misaligned = ((name, a.angle, a.offset) for name, a in answers_of.items() if a.angle > 0.0 or a.offset > 0.0)
    out = _moves_and_parts(mechanism)
    return replace(
        out,
        mobility=replace(out.mobility, by_contact=by_contact),
        misfit=misfit_of(moves),
        misaligned=tuple(misaligned),
        moves=moves,
        asides=asides(beside, patches, bodies, out.mobility),
        membership=() if found is None else _membership(found, _body_of_part(bodies)),
        unparted=() if found is None else tuple(Unparted(joint, parts) for joint, parts in found.unparted.items()),
        left_out=left_out(assembly, surfaces, contacts, bodies) if found is not None or rests(assembly) else (),
        sides=sides,
    )


def _complete(assembly: Assembly) -> bool:
    """Whether the function of the top states every joint that is meant to move."""
    stated = any(joint.type != "fixed" for joint in assembly.function.joints)
    return stated and "" in assembly.function.complete


def _membership(found: Partition, of_part: Mapping[PartName, BodyName]) -> tuple[Membership, ...]:
    """Of every part, what holds it in its body."""
    names = [of_part[parts[0]] for parts in found.parts]
    return tuple(
        Membership(
            part,
            of_part[part],
            placed.how,
            placed.margin,
            BodyName("") if placed.other is None else names[placed.other],
            placed.unclear,
            placed.evidence,
        )
        for part, placed in sorted(found.placed.items())
    )


def functional(assembly: Assembly) -> Kinematics:
    """The ball-and-stick model: groups and parts as bodies, joints straight from [function]."""
    merger = Merger(assembly)
    for joint in assembly.function.joints:
        if joint.type == "fixed":
            first, second = (assembly.parts_of(name)[0] for name in joint.between)
            merger.fuse(first, second, f"intended joint {joint.name}")
    bodies = merger.bodies()
    intended = intended_joints(assembly, _body_of_part(bodies))
    graph = JointGraph(bodies, tuple(intended[pair] for pair in sorted(intended)))
    mechanism = _Mechanism(assembly, graph, Extents(assembly).assembly, clusters=bodies)
    kinematics = _moves_and_parts(mechanism)
    return _with_couplings(mechanism, kinematics) if assembly.function.couplings else kinematics


def mobility_within(kinematics: Kinematics, part_names: Sequence[str]) -> int | None:
    """Freedoms of some parts among themselves, finite where that is known: the bodies they belong to and
    the joints between those, relative to the first of these bodies (or ground, if it is among them); None where two
    ways to count them disagree."""
    wanted = set(part_names)
    bodies = tuple(b for b in kinematics.bodies if wanted.intersection(b.parts))
    if not bodies:
        return 0
    names = {body.name for body in bodies}
    graph = JointGraph(bodies, tuple(j for j in kinematics.joints if names.issuperset(j.bodies)))
    size = kinematics.matrix.length
    count = graph.close(size).mobility
    finite = finite_mobility(graph.edges, graph.joints, len(bodies), count, size)
    if finite.on_edge:
        return None
    return count if finite.count is None else finite.count


def idle_within(kinematics: Kinematics, part_names: Sequence[str]) -> int:
    """Idle freedoms of bodies all of whose joints are between some parts: `mobility_within` counts them."""
    wanted = set(part_names)
    names = {body.name for body in kinematics.bodies if wanted.intersection(body.parts)}
    outside = {name for joint in kinematics.joints if not names.issuperset(joint.bodies) for name in joint.bodies}
    return sum(freedom.idle and freedom.body in names - outside for freedom in kinematics.mobility.named)


def _body_of_part(bodies: Sequence[Body]) -> dict[PartName, BodyName]:
    return {part: body.name for body in bodies for part in body.parts}


def _fuse_and_decide(
    pairs: Pairs, contacts: Contacts, found: Partition | None
) -> tuple[Merger, dict[Pair, tuple[Answer, Joint]], list[Suggestion]]:
    """Which parts are one body, what each pair of bodies that touch may do, and the suggestions that were believed.
    Where the bodies are `found` by the function, contact and suggestions fuse nothing more.

    Suggestions are applied to what contact alone makes of the parts. Where contact then fuses what the manifest keeps
    apart, it is started again without those that led to it.
    """
    merger = Merger(pairs.assembly)
    if found is not None:
        for parts in found.parts:
            for other in parts[1:]:
                merger.fuse(parts[0], other, "function: contact that no stated joint moves holds")
        return merger, decide_all(pairs, merger, fusing=False), []
    decided = decide_all(pairs, merger)
    hints = fastenings(pairs.assembly, contacts, merger)
    while True:
        joined = merger.copy()
        if not fasten(hints, joined):
            return merger, decided, hints
        anew = decide_all(pairs, joined)
        believed = harmless(hints, pairs.assembly, merger, joined)
        if len(believed) == len(hints):
            return joined, anew, hints
        hints = believed


def _clusters(assembly: Assembly, hints: Sequence[Suggestion]) -> tuple[Body, ...]:
    """Bodies as they would be if contact fused nothing."""
    merger = Merger(assembly)
    fasten(hints, merger)
    return merger.bodies()


def _moves_and_parts(mechanism: _Mechanism) -> Kinematics:
    """The kinematics of a mechanism."""
    matrix, joints, apart, reason = _separations(mechanism)
    mobility, couplings = _mobility(mechanism)
    bodies = mechanism.graph.bodies
    return Kinematics(bodies, joints, matrix, mobility, Misfit(), (), apart, reason, couplings)


def _mobility(mechanism: _Mechanism) -> tuple[Mobility, tuple[Coupling, ...]]:
    """What the joints let move, and the ratios in which they are coupled."""
    assembly, graph, patches, size = mechanism.assembly, mechanism.graph, mechanism.patches, mechanism.size
    joints, nodes, strict = graph.joints, len(graph.bodies), mechanism.strict
    doubts = uncertainties(joints, patches)
    closure = graph.close(size, doubts)
    count = closure.mobility
    hard = [strict.get(joint.name, joint.twists) for joint in joints]
    blocked = graph.close(size, doubts, hard).mobility if strict else count
    turns = idle_turns(assembly, graph, patches, size, mechanism.balls)
    idle = sum(map(len, turns.values()))
    couplings = couplings_between(assembly, graph, patches, closure)
    constant = {coupling.through for coupling in couplings if coupling.meshing is not None}
    finite = finite_mobility(graph.edges, joints, nodes, count, size, couplings)
    within = [redundancy_within(joint, patches, assembly.tolerances) for joint in joints]
    mobility = Mobility(
        instantaneous=count,
        finite=finite.count,
        effective=(count if finite.count is None else finite.count) - idle,
        idle=idle,
        redundant=count - (6 * (nodes - 1) - sum(6 - joint.freedoms for joint in joints)),
        blocked=blocked,
        freedoms=_freedoms(closure, graph),
        idle_bodies=tuple(sorted(name for name, twists in turns.items() if len(twists))),
        uncertain=tuple(joint.name for joint in joints if _uncertain(joint, constant)),
        finite_reason=finite.reason,
        infinitesimal=finite.infinitesimal,
        singular=finite.singular,
        on_edge=finite.on_edge,
        certificates=finite.certificates,
        named=named_freedoms(graph, closure, turns, mechanism.places, mechanism.size),
        redundancies=(*filter(None, within), *redundancies_of_loops(joints, closure, size)),
    )
    return mobility, couplings


def _separations(
    mechanism: _Mechanism,
) -> tuple[ConstraintMatrix, tuple[Joint, ...], tuple[Separation, ...], str]:
    """J, the joints with how they come apart, what can leave, and why it is not known of the rest."""
    bodies, patches, clusters = mechanism.graph.bodies, mechanism.patches, mechanism.clusters
    matrix = constraint_matrix(bodies, mechanism.graph.joints, patches, mechanism.extremes)
    rows = ContactRows(matrix, bodies, patches)
    cones = pair_cones(rows, mechanism.graph.joints)
    joints = with_releases(mechanism.graph.joints, cones)
    links = links_between(clusters, bodies, joints, patches, rows)
    ground = next(k for k, cluster in enumerate(clusters) if cluster.ground)
    apart, reason = separations([cluster.name for cluster in clusters], ground, links, mechanism.answers)
    return matrix, joints, apart, reason


def _with_couplings(mechanism: _Mechanism, kinematics: Kinematics) -> Kinematics:
    """The ball-and-stick model with the freedoms that the stated couplings leave."""
    assembly, graph = mechanism.assembly, mechanism.graph
    of_part = _body_of_part(graph.bodies)
    closure = graph.close(mechanism.size)
    body_of = {name: of_part[assembly.parts_of(name)[0]] for j in assembly.function.joints for name in j.between}
    rows = coupling_rows(assembly.function, graph.joints, body_of, closure.offset)
    coupled = restrict_closure(closure, rows)
    mobility = replace(
        coupled_mobility(kinematics.mobility, closure, coupled, rows),
        freedoms=_freedoms(coupled, graph),
        named=named_freedoms(graph, coupled, {}, mechanism.places, mechanism.size),
    )
    return replace(kinematics, mobility=mobility)


def _uncertain(joint: Joint, constant: Collection[str]) -> bool:
    """Whether counts depend on a joint that is not certain; teeth of a constant ratio are."""
    return joint.status in ("ambiguous", "blocked") or (joint.type == "general" and joint.name not in constant)


def _freedoms(closure: Closure, graph: JointGraph) -> Array:
    """Orthonormal basis (k, bodies, 6) of the twists of all bodies; none where it would be very large."""
    count, nodes = closure.mobility, len(graph.bodies)
    if count == 0 or 6 * count * nodes > MOST_BASIS_NUMBERS:
        return np.zeros((0, nodes, 6))
    twists = body_twists(closure, graph.edges, graph.spaces)
    basis, _ = np.linalg.qr(twists.reshape(count, -1).T)
    return basis.T.reshape(count, nodes, 6)
