"""Page, ranges, reach and simulation place the bodies of one mechanism in the same poses.

Each of the four moves a mechanism in its own way: the page along the freedoms that drivers lead, the ranges along the
arc of the one motion of a block, reach to stated values of joints, and the kinematic simulation along a path, with
quaternions for balls. All close loops by `mechanism.closing`; here they are asked for the poses of all bodies at the
same values of the drivers.
"""

from __future__ import annotations

import numpy as np
import pytest
from support.places import manifests

from kinform.behaviour.from_design import build
from kinform.collisions.driving import loop_motion
from kinform.function.configurations import mechanism_of
from kinform.function.holding import configuration_at
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.mobility.freedom_motions import driven_freedoms
from kinform.mechanism.closing import ACCEPTED
from kinform.mechanism.joint_graph import JointGraph
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.settings import SolverSettings
from kinform.simulation.solver.continuation import Follower, Led

AGREED = 2 * ACCEPTED
"""rad, and shares of the assembly's size: twice what loops may be open by."""
NODES = 4
"""Steps of the ranges along a motion."""
LOOPED = [
    "four_bar", "slider_crank", "watt_six_bar", "stephenson_six_bar", "bennett", "bricard_rectangular", "cardan_shaft",
    "parallelogram", "parallelogram_single", "parallelogram_unequal", "roberval_balance", "sarrus", "scotch_yoke",
    "stick_four_bar", "five_bar", "four_bar_missing_pin",
]  # fmt: skip
"""Fixtures with loops that move, one way or several."""
SEVERAL_WAYS = ("five_bar", "four_bar_missing_pin")
"""Those of them whose loops move several ways: the ranges follow no such motion."""


def simulated(design, values):
    """(B, 4, 4) poses in the kinematic simulation, led to these values of joints."""
    kinematics = design.kinematics
    model = build(design.assembly, kinematics, design.mass)
    assert not model.failures
    mechanism, _ = assemble(model.system)
    slots = {slot.name: slot for slot in mechanism.slots}
    q, v = (np.array([getattr(slots[name], of).start for name in values]) for of in ("q", "v"))
    target = np.array(list(values.values()))
    follower = Follower(mechanism, Led(q, v, lambda s: s * target, lambda s: target), mechanism.start, SolverSettings())
    assert follower.go(0.0, 1.0) is None
    to, back = np.eye(4), np.eye(4)
    to[:3, 3], back[:3, 3] = mechanism.centre, -mechanism.centre
    links = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    poses = mechanism.poses(follower.q)
    return np.array([to @ poses[links[str(body.name)]] @ back for body in kinematics.bodies])


def reached(design, values):
    """(B, 4, 4) poses at which reach has the mechanism at these values of joints."""
    chain = mechanism_of(design.assembly, design.kinematics)
    q = configuration_at(chain, values)
    assert not isinstance(q, str), q
    return chain.linkage.poses(q[None])[0]


def ranged(design, freedom, size, monkeypatch):
    """Value of the driver of a freedom, and poses (B, 4, 4), some steps along the one motion of its block; None where
    it has more than one."""
    monkeypatch.setattr(loop_motion, "PATH_STEPS", NODES)
    graph = JointGraph(design.kinematics.bodies, design.kinematics.joints)
    joint = freedom.coordinate.joint
    (block,) = [b for b in graph.loops if any(graph.joints[k].name == joint for k in b)]
    idle = [one for one in design.kinematics.mobility.named if one.idle]
    driven = loop_motion.driven_block(graph, block, idle, size)
    system = driven.linkage.system
    tangent = driven.tangent(system.equations(system.start).jacobian[0])
    if tangent is None or not tangent[1]:
        return None
    q = loop_motion.follow(driven, 1.0).q[-1]
    (column,) = driven.linkage.columns(joint)
    return q[column] / driven.linkage.coordinates[column].unit, driven.linkage.poses(q[None])[0]


@pytest.mark.parametrize("name", LOOPED)
def test_all_place_the_bodies_in_the_same_poses_at_the_same_drive_values(name, derive_design, monkeypatch):
    (manifest,) = [path for path in manifests() if path.stem == name]
    design = derive_design(manifest)
    kinematics, size = design.kinematics, Extents(design.assembly).assembly
    spinning = {one.body for one in kinematics.mobility.named if one.idle}
    compared = [k for k, body in enumerate(kinematics.bodies) if body.name not in spinning]
    unit = np.ones((4, 4))
    unit[:3, 3] = size
    freedoms, _ = driven_freedoms(kinematics, size, 60)
    single = {joint.name for joint in kinematics.joints if joint.freedoms == 1}
    idle = {one.driver for one in kinematics.mobility.named if one.idle}
    drivers = {one.coordinate.joint for one in freedoms} & single - idle
    looped = [one for one in freedoms if one.linkage.looped and one.coordinate.joint in drivers]
    assert looped
    for freedom in looped:
        driver = freedom.coordinate.joint
        found = ranged(design, freedom, size, monkeypatch)
        value = 0.1 if found is None else found[0]
        values = dict.fromkeys(drivers, 0.0) | {driver: value}
        page = freedom.linkage.poses(freedom.followed(np.linspace(0.0, value, 5)))
        assert len(page) == 5
        others = {"reach": reached(design, values), "simulation": simulated(design, values)}
        others |= {} if found is None else {"ranges": found[1]}
        assert np.abs((page[-1] - np.eye(4)) / unit)[compared].max() > 1e-3  # something has moved
        assert ("ranges" in others) == (name not in SEVERAL_WAYS)
        for who, poses in others.items():
            assert np.abs((poses - page[-1]) / unit)[compared].max() < AGREED, (who, driver)
