"""What one joint carries in a run, as far as nothing but its bodies' motion and weight loads it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kinform.consistency.context import Context
from kinform.foundation.algebra.displacements import poses
from kinform.foundation.graphs.graph import UnionFind
from kinform.function import resolve_joint
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.function import PASSIVE, SimulationRequest
from kinform.model.kinematics import Joint
from kinform.requirements.runs import window


def carried(context: Context, joint: Joint, output: int) -> Mapping[str, Array] | None:
    """The bodies that hang on a joint which closes no loop, about an output time; None where loads or springs act,
    passive drives share the joint, gears mesh, or a mass is not known."""
    run, function, kinematics = context.simulation, context.function, context.kinematics
    if function.loads or function.springs or function.couplings or kinematics.couplings or context.lacks("mass"):
        return None
    shared = [drive for drive in function.drives
              if resolve_joint(context.assembly, kinematics, drive.joint).joint is joint]  # fmt: skip
    if joint.axis is None or any(drive.kind in PASSIVE for drive in shared) or len(shared) > 1:
        return None
    graph = JointGraph(kinematics.bodies, kinematics.joints)
    sets = UnionFind(len(graph.bodies))
    own = kinematics.joints.index(joint)
    for n, (a, b) in enumerate(graph.edges):
        if n != own:
            sets.union(a, b)
    first, second = (sets.find(node) for node in graph.edges[own])
    ground = sets.find(graph.ground)
    if first == second or ground not in (first, second):
        return None
    hanging = [
        body.name for k, body in enumerate(graph.bodies) if sets.find(k) == (second if ground == first else first)
    ]
    holder = joint.bodies[0 if ground == first else 1]
    properties = {weight.name: weight for weight in context.mass.bodies}
    if not all(name in run.body_names and properties[name].mass is not None for name in hanging):
        return None
    near = window(run, output)
    index = [run.body_names.index(name) for name in hanging]
    centres = np.array([properties[name].centre_of_mass for name in hanging])
    moved = np.array([poses(run.p_WB[near, b], run.q_WB[near, b]) for b in index])
    still = np.eye(4)
    if holder in run.body_names:
        b = run.body_names.index(holder)
        still = poses(run.p_WB[output : output + 1, b], run.q_WB[output : output + 1, b])[0]
    point = np.zeros(3) if joint.point is None else joint.point
    request = context.assembly.simulation or SimulationRequest()
    return {
        "times": run.time[near],
        "at": run.time[output],
        "masses": np.array([properties[name].mass for name in hanging]),
        "inertias": np.array([properties[name].inertia for name in hanging]),
        "places": np.einsum("ntij,nj->nti", moved[..., :3, :3], centres) + moved[..., :3, 3],
        "turns": moved[..., :3, :3],
        "gravity": np.asarray(request.gravity, dtype=np.float64),
        "axis": still[:3, :3] @ joint.axis,
        "point": still[:3, :3] @ point + still[:3, 3],
        "slides": np.array(float(joint.type == "prismatic")),
        "lead": np.array(joint.pitch or 0.0 if joint.type == "screw" else 0.0),
    }
