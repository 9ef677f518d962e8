"""Certified distances and chains of joints, against brute force and closed formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.assemblies import assembly
from support.assemblies import contacts as no_contacts
from support.devices import intended, joint, kinematics
from support.solids import box, part, random_pose

from kinform.function.clearances import apart
from kinform.function.configurations import chain_between
from kinform.function.sweeps import along, over

Z = (0.0, 0.0, 1.0)


def crane(rng, low=(-1.0, -0.01, -1.5), high=(1.2, 0.02, 0.7)):
    """A jib that turns, slides out along x and tilts its last part about y; a post of the base beside it. Under a
    random pose. The joints are listed in either order."""
    X = random_pose(rng)
    turn = lambda v: X[:3, :3] @ np.asarray(v, float)
    place = lambda p: X[:3, :3] @ np.asarray(p, float) + X[:3, 3]
    solids = {
        "base": box(50, 60, -30, 30, -5, 5), "mast": box(-1, 1, -1, 1, 0, 1), "jib": box(0, 20, -1, 1, -1, 1),
        "tool": box(20, 35, -2, 2, -2, 2),
    }  # fmt: skip
    made = assembly(*(part(name, solid, X) for name, solid in solids.items()), ground="base")
    joints = [
        joint("base", "mast", "revolute", turn(Z), place((0, 0, 0))),
        joint("jib", "mast", "prismatic", turn((-1.0, 0, 0)), place((0, 0, 0))),
        joint("jib", "tool", "revolute", turn((0, 1.0, 0)), place((0.02, 0, 0))),
    ]
    wanted = [
        intended("yaw", "base", "mast", "revolute", turn(Z), place((0, 0, 0)), range=(low[0], high[0])),
        intended("out", "mast", "jib", "prismatic", turn((1.0, 0, 0)), range=(low[1], high[1])),
        intended("tilt", "jib", "tool", "revolute", turn((0, 1.0, 0)), place((0.02, 0, 0)), range=(low[2], high[2])),
    ]
    made = assembly(*made.parts, ground="base", joints=wanted)
    moved = kinematics(made.parts, joints)
    chain = chain_between(made, moved, "base", "tool")
    groups = apart(made, no_contacts(), {}, ["base"], ["tool"])
    return X, chain, groups


def displaced(X, yaw, out, tilt):
    """The tool by closed formulas, in the world."""
    turned, tilted, slid = np.eye(4), np.eye(4), np.eye(4)
    turned[:3, :3] = Rotation.from_rotvec([0, 0, yaw]).as_matrix()
    slid[0, 3] = out
    tilted[:3, :3] = Rotation.from_rotvec([0, tilt, 0]).as_matrix()
    tilted[:3, 3] = np.array([0.02, 0, 0]) - tilted[:3, :3] @ [0.02, 0, 0]
    return X @ turned @ slid @ tilted @ np.linalg.inv(X)


def coordinates(chain, yaw, out, tilt):
    values = {"base~mast": yaw, "jib~mast": out, "jib~tool": tilt}
    # jib~mast is of the mast relative to the jib, along −x: both turn the sign
    return np.array([c.unit * values[c.joint] for c in chain.coordinates])


@pytest.mark.parametrize("seed", range(3))
def test_a_chain_puts_its_bodies_where_closed_formulas_do(seed):
    rng = np.random.default_rng(seed)
    X, chain, _ = crane(rng)
    for _ in range(5):
        yaw, out, tilt = rng.uniform([-1, -0.01, -1], [1, 0.02, 1])
        poses = chain.linkage.world(chain.system.bodies(coordinates(chain, yaw, out, tilt)[None])[0])
        assert poses[chain.index("tool")] == pytest.approx(displaced(X, yaw, out, tilt), abs=1e-12)


def test_ranges_come_in_the_sign_of_the_chain():
    _, chain, _ = crane(np.random.default_rng(3))
    ends = {coordinate.joint: (coordinate.lower, coordinate.upper) for coordinate in chain.coordinates}
    assert ends == {"base~mast": (-1.0, 1.2), "jib~mast": (-0.01, 0.02), "jib~tool": (-1.5, 0.7)}
    assert chain.unknown == ()


@pytest.mark.parametrize("seed", [0])
def test_what_is_certified_over_ranges_no_sample_contradicts(seed):
    rng = np.random.default_rng(seed)
    X, chain, groups = crane(rng, low=(-0.4, -0.01, -0.3), high=(0.5, 0.002, 0.2))
    samples = rng.uniform(chain.lower, chain.upper, (250, 3))
    # corners of the box of ranges too
    for k in range(8):
        samples[k] = [(chain.lower, chain.upper)[(k >> d) & 1][d] for d in range(3)]
    poses = [chain.linkage.world(chain.system.bodies(q[None])[0])[chain.index("tool")] for q in samples]
    least = min(groups.at(pose).distance for pose in poses)
    assert least > 0.005
    sure = over(groups, chain, "base", "tool", chain.lower, chain.upper, 0.8 * least)
    assert sure.complete
    assert sure.worst.distance >= 0.8 * least
    short = over(groups, chain, "base", "tool", chain.lower, chain.upper, 1.02 * least)
    assert short.worst.distance < 1.02 * least
    # the configuration that is told falls short by another way to compute it
    told = dict(zip((c.joint for c in chain.coordinates), short.values, strict=True))
    pose = displaced(X, told["base~mast"], told["jib~mast"], told["jib~tool"])
    assert groups.at(pose).distance == pytest.approx(short.worst.distance, abs=1e-9)


def test_a_tool_that_passes_a_post_between_two_samples_is_caught():
    X, chain, groups = crane(np.random.default_rng(5))
    still = np.tile(np.eye(4), (2, 1, 1))
    ends = np.array([displaced(X, -1.4, 0.02, 0.0), displaced(X, 1.4, 0.02, 0.0)])
    assert min(groups.at(pose).distance for pose in ends) > 0.01
    swept = along(groups, still, ends, 0.0)
    assert swept.worst.distance == 0.0
    assert 0.0 < swept.where < 1.0
    del chain


def test_a_motion_of_both_groups_together_keeps_their_distance():
    rng = np.random.default_rng(6)
    _, _, groups = crane(rng)
    path = np.array([random_pose(rng) for _ in range(4)])
    here = groups.at(np.eye(4)).distance
    swept = along(groups, path, path, 0.99 * here)
    assert swept.complete
    assert swept.worst.distance == pytest.approx(here, rel=1e-9)
    assert math.isclose(along(groups, path, path, 1.01 * here).worst.distance, here, rel_tol=1e-9)
