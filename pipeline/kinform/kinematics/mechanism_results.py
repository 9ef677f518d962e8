"""What follows from bodies and joints that are decided: mobility, couplings, J, and what comes apart."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import field

import numpy as np

from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.bounds import uncertainties
from kinform.kinematics.mobility.couplings import couplings_between
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.kinematics.mobility.idle import idle_turns
from kinform.kinematics.mobility.joint_redundancy import redundancy_within
from kinform.kinematics.mobility.loop_redundancy import redundancies_of_loops
from kinform.kinematics.mobility.named_freedoms import named_freedoms
from kinform.kinematics.mobility.two_ends import certified_at_ends, joint_ends, mobility_ends
from kinform.kinematics.separation.constraint_matrix import constraint_matrix
from kinform.kinematics.separation.contact_rows import ContactRows, pair_cones
from kinform.kinematics.separation.releases import with_releases
from kinform.kinematics.separation.separations import Leaving, links_between, separations
from kinform.kinematics.step_cache import StepCache
from kinform.mechanism.first_order import Closure, body_twists
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Assembly
from kinform.model.contacts import Patch
from kinform.model.kinematics import (
    Body,
    ConstraintMatrix,
    Coupling,
    Joint,
    Kinematics,
    Misfit,
    Mobility,
)
from kinform.model.names import JointName
from kinform.model.surfaces import MeshSurfaces

MOST_BASIS_NUMBERS = 1_000_000
"""Numbers, of 8 MB, up to which the dense basis of freedoms is kept: the named freedoms, which are sparse, say the
same. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class DecidedMechanism:
    """Bodies and joints as they stay, and what stands behind them."""

    assembly: Assembly
    graph: JointGraph
    size: float
    """m: diagonal of the assembly."""
    clusters: tuple[Body, ...]
    """The parts that something other than contact makes one: what could come apart, seen from contact alone."""
    patches: tuple[Patch, ...] = ()
    strict: Mapping[JointName, Array] = field(default_factory=dict)
    """(k, 6) freedoms of blocked joints when every patch counts."""
    surfaces: Mapping[str, MeshSurfaces] = field(default_factory=dict)
    """Of each mesh, by its digest."""
    extremes: Mapping[int, Ints] = field(default_factory=dict)
    """Samples that bound patches, of those that are known."""
    cache: StepCache | None = None

    @property
    def places(self) -> list[Array]:
        """(3,) m: where each body is, by its first part."""
        pose = {part.name: part.X_WP for part in self.assembly.parts}
        return [pose[body.parts[0]][:3, 3] for body in self.graph.bodies]


def kinematics_of(mechanism: DecidedMechanism) -> Kinematics:
    """The kinematics of a mechanism."""
    matrix, joints, leaving = _separations(mechanism)
    mobility, couplings = _mobility(mechanism, leaving.opened)
    bodies = mechanism.graph.bodies
    return Kinematics(
        bodies, joints, matrix, mobility, Misfit(),
        separations=leaving.separations, separations_reason=leaving.reason, slides=leaving.slides, couplings=couplings,
    )  # fmt: skip


def _mobility(mechanism: DecidedMechanism, opened: frozenset[JointName]) -> tuple[Mobility, tuple[Coupling, ...]]:
    """What the joints let move, and the ratios in which they are coupled."""
    assembly, graph, patches, size = mechanism.assembly, mechanism.graph, mechanism.patches, mechanism.size
    joints, nodes, strict = graph.joints, len(graph.bodies), mechanism.strict
    doubts = uncertainties(joints, patches)
    closure = graph.close(size, doubts)
    count = closure.mobility
    hard = [strict.get(joint.name, joint.twists) for joint in joints]
    blocked = graph.close(size, doubts, hard).mobility if strict else count
    turns = idle_turns(assembly, graph, patches, size, mechanism.surfaces)
    named = named_freedoms(graph, closure, turns, mechanism.places, mechanism.size)
    idle = [freedom.body for freedom in named if freedom.idle]
    couplings = couplings_between(assembly, graph, patches, closure)
    constant = {coupling.through for coupling in couplings if coupling.meshing is not None}
    finite = finite_mobility(graph.edges, joints, nodes, count, size, couplings)
    effective = (count if finite.count is None else finite.count) - len(idle)
    ends = joint_ends(assembly, graph, opened)
    low, high = mobility_ends(graph, ends, effective, count, size, doubts)
    within = [redundancy_within(joint, patches, assembly.tolerances) for joint in joints]
    mobility = Mobility(
        instantaneous=count,
        finite=finite.count,
        effective=effective,
        idle=len(idle),
        redundant=count - (6 * (nodes - 1) - sum(6 - joint.freedoms for joint in joints)),
        blocked=blocked,
        freedoms=freedom_basis(closure, graph),
        idle_bodies=tuple(sorted(set(idle))),
        uncertain=tuple(joint.name for joint in joints if _uncertain(joint, constant)),
        finite_reason=finite.reason,
        infinitesimal=finite.infinitesimal,
        singular=finite.singular,
        on_edge=finite.on_edge,
        certificates=certified_at_ends(graph, ends, finite.certificates, size, couplings),
        named=named,
        redundancies=(*filter(None, within), *redundancies_of_loops(joints, closure, size)),
        low=low,
        high=high,
    )
    return mobility, couplings


def _separations(mechanism: DecidedMechanism) -> tuple[ConstraintMatrix, tuple[Joint, ...], Leaving]:
    """J, the joints with how they come apart, and what can leave."""
    bodies, patches, clusters = mechanism.graph.bodies, mechanism.patches, mechanism.clusters
    matrix = constraint_matrix(bodies, mechanism.graph.joints, patches, mechanism.extremes)
    rows = ContactRows(matrix, bodies, patches)
    cones = pair_cones(rows, mechanism.graph.joints)
    joints = with_releases(mechanism.graph.joints, cones)
    links = links_between(clusters, bodies, joints, patches, rows)
    ground = next(k for k, cluster in enumerate(clusters) if cluster.ground)
    return matrix, joints, separations([cluster.name for cluster in clusters], ground, links, mechanism.cache)


def _uncertain(joint: Joint, constant: Collection[str]) -> bool:
    """Whether counts depend on a joint that is not certain; teeth of a constant ratio are."""
    return joint.status in ("ambiguous", "blocked") or (joint.type == "general" and joint.name not in constant)


def freedom_basis(closure: Closure, graph: JointGraph) -> Array:
    """Orthonormal basis (k, bodies, 6) of the twists of all bodies; none where it would be very large."""
    count, nodes = closure.mobility, len(graph.bodies)
    if count == 0 or 6 * count * nodes > MOST_BASIS_NUMBERS:
        return np.zeros((0, nodes, 6))
    twists = body_twists(closure, graph.edges, graph.spaces)
    basis, _ = np.linalg.qr(twists.reshape(count, -1).T)
    return basis.T.reshape(count, nodes, 6)
