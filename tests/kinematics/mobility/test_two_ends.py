"""The two ends of the mobility: of contact that only pushes nobody knows from one pose whether it holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.devices import body, joint
from support.devices import kinematics as kinematics_of
from support.linkages import KNOWN
from support.solids import box, part, random_pose, rod

from kinform import contacts, kinematics, surfaces
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.kinematics.mobility.two_ends import certified_at_ends, joint_ends
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.kinematics import EndStop


def latch():
    """Two arms on captive journals of a frame, the end of the one on the end of the other."""
    frame, arms = box(-60, 60, -20, 20, -30, -20), {}
    for name, x, height in (("lower", -30.0, 0.0), ("upper", 30.0, 4.0)):
        pin = rod(3, -20, 20, 64).rotate((90, 0, 0)).translate((x, 0, 0))
        bore = rod(3.02, -25, 25, 64).rotate((90, 0, 0)).translate((x, 0, 0))
        frame = frame + (box(x - 5, x + 5, -20, -10, -20, 8) + box(x - 5, x + 5, 10, 20, -20, 8) - bore)
        reach = box(min(x, np.sign(x) * -10), max(x, np.sign(x) * -10), -9.98, 9.98, height - 2, height + 2)
        arms[name] = pin + reach + box(x - 5, x + 5, -9.98, 9.98, -5, height + 2)
    return {"frame": frame, **arms}


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("named", [False, True])
def test_contact_that_only_pushes_counts_at_one_end_alone(seed, named):
    X = random_pose(np.random.default_rng(seed), 0.05)
    joints = [replace(intended("push", "lower", "upper", "planar"), axis=X[:3, 2])] if named else []
    parts = [part(name, solid, X, 1e-3) for name, solid in latch().items()]
    made = assembly(*parts, ground="frame", joints=joints)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    mobility = kinematics.derive(made, known, contacts.find(made, known)).mobility
    low, high = mobility.ends
    assert (low, high) == ((0, 0) if named else (0, 2))
    assert mobility.admits(high) is True
    assert mobility.admits(high + 1) is False


def special(name, *, at, closed=None, at_rest=None, opened=(), scale=1.0, seed=None):
    """`at_ends` of the certificate of a mechanism of linkages whose joint `at` may do other motions at one end."""
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed), 3.0)
    joints = []
    for a, b, kind, axis, point, _ in KNOWN[name][0]:
        joints.append(joint(a, b, kind, X[:3, :3] @ axis, scale * (X[:3, :3] @ np.asarray(point, float) + X[:3, 3])))
    one = joints[at]
    other = [twists_of(kind, one.axis, one.point) for kind in (at_rest, closed) if kind is not None]
    rest = other[0] if at_rest is not None else one.twists
    wide = other[-1] if closed is not None else one.twists
    stop = EndStop(("a", "b"), 0, 1.0, np.zeros(3), 1, "")
    joints[at] = replace(one, at_rest=rest, closed=wide, at_stop=(stop,))
    names = sorted({name for each in joints for name in each.bodies})
    graph = JointGraph(kinematics_of([body(n) for n in names], joints).bodies, tuple(joints))
    size = 5.0 * scale
    count = graph.close(size).mobility
    found = finite_mobility(graph.edges, joints, len(names), count, size)
    made = assembly(part("base", box(0, 1, 0, 1, 0, 1), np.eye(4)), ground="base")
    ends = joint_ends(made, graph, [joints[k].name for k in opened])
    (certificate,) = certified_at_ends(graph, ends, found.certificates, size)
    return certificate.at_ends


@pytest.mark.parametrize(("scale", "seed"), [(1.0, None), (1e-3, 3)])
@pytest.mark.parametrize("name", ["shaky truss", "flat parallelogram"])
def test_loops_are_special_at_both_ends_or_by_contact_that_only_pushes(name, scale, seed):
    pose = {"scale": scale, "seed": seed}
    assert special(name, at=0, **pose)
    # a slide out of the plane that the other hinges forbid changes nothing
    assert special(name, at=0, closed="cylindrical", **pose)
    # a hinge that its stop holds leaves nothing that could be shaky or singular
    assert not special(name, at=0, at_rest="fixed", **pose)
    # nor does one that is a plane without what only pushes: the loops move
    assert not special(name, at=0, closed="planar", **pose)
    assert not special(name, at=0, opened=[0], **pose)
