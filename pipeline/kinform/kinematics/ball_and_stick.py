"""The ball-and-stick model: groups and parts as bodies, joints straight from [function], without contact."""

from __future__ import annotations

from dataclasses import replace

from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.stated_joints import intended_joints
from kinform.kinematics.mechanism_results import DecidedMechanism, freedom_basis, kinematics_of
from kinform.kinematics.mobility.named_freedoms import named_freedoms
from kinform.kinematics.mobility.stated_couplings import coupled_mobility, coupling_rows, restrict_closure
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Kinematics, body_of_part


def functional(assembly: Assembly) -> Kinematics:
    """The ball-and-stick model: groups and parts as bodies, joints straight from [function]."""
    merger = Merger(assembly)
    for joint in assembly.function.joints:
        if joint.type == "fixed":
            first, second = (assembly.parts_of(name)[0] for name in joint.between)
            merger.fuse(first, second, f"intended joint {joint.name}")
    bodies = merger.bodies()
    intended = intended_joints(assembly, body_of_part(bodies))
    graph = JointGraph(bodies, tuple(intended[pair] for pair in sorted(intended)))
    mechanism = DecidedMechanism(assembly, graph, Extents(assembly).assembly, clusters=bodies)
    kinematics = kinematics_of(mechanism)
    return _with_couplings(mechanism, kinematics) if assembly.function.couplings else kinematics


def _with_couplings(mechanism: DecidedMechanism, kinematics: Kinematics) -> Kinematics:
    """The ball-and-stick model with the freedoms that the stated couplings leave."""
    assembly, graph = mechanism.assembly, mechanism.graph
    of_part = body_of_part(graph.bodies)
    closure = graph.close(mechanism.size)
    body_of = {name: of_part[assembly.parts_of(name)[0]] for j in assembly.function.joints for name in j.between}
    rows = coupling_rows(assembly.function, graph.joints, body_of, closure.offset)
    coupled = restrict_closure(closure, rows)
    mobility = replace(
        coupled_mobility(kinematics.mobility, closure, coupled, rows),
        freedoms=freedom_basis(coupled, graph),
        named=named_freedoms(graph, coupled, {}, mechanism.places, mechanism.size),
    )
    return replace(kinematics, mobility=mobility)
