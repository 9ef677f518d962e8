"""Between outputs every joint moves on evenly along its screw, wherever in the world the assembly is."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import diagonal
from support.slots import derived
from support.solids import box, rod

from kinform import collisions
from kinform.collisions.between_outputs import nodes_of
from kinform.foundation.algebra.displacements import displacement
from kinform.model.simulation import Simulation


def run(time, poses, names, turn=None, acceleration=None):
    """A run of bodies at poses (T, B, 4, 4), with the turn of its one joint (T,)."""
    q = Rotation.from_matrix(poses[..., :3, :3].reshape(-1, 3, 3)).as_quat(scalar_first=True)
    values = {"time": time, "body_names": names, "p_WB": poses[..., :3, 3], "q_WB": q.reshape(*poses.shape[:2], 4)}
    if turn is not None:
        values |= {"joint_types": ("revolute",), "joint_offset": np.array([0, 1])}
        values |= {"joint_position": turn[:, None], "joint_velocity": np.gradient(turn, time)[:, None]}
        values |= {"joint_acceleration": acceleration[:, None]}
    made = object.__new__(Simulation)
    for name, value in values.items():
        object.__setattr__(made, name, value)
    return made


def chain(rng, above, away):
    """Unit twists of the joints that carry each of the bodies but the first, and what to call them."""
    twists, joints = [], []
    for k, other in enumerate(above, 1):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        point = away + rng.uniform(-0.3, 0.3, 3)
        twists.append(np.concatenate([axis, np.cross(point, axis)]))
        bodies = tuple(sorted((f"b{other}", f"b{k}")))
        joints.append(SimpleNamespace(name="~".join(bodies), bodies=bodies, freedoms=1))
    return np.array(twists), joints


def carried(above, twists, q):
    """(B, 4, 4) displacements of the bodies at joint values q."""
    out = [np.eye(4)]
    for k, other in enumerate(above):
        out.append(out[other] @ displacement(q[k] * twists[k]))
    return np.array(out)


@pytest.mark.parametrize(
    ("above", "away"),
    [((0,), 0.0), ((0, 1), 7.0), ((0, 1, 2, 3, 4, 5, 6), 3.0), ((0, 0, 1, 2, 2, 5), -2.0), ((0, 1, 0, 3), 40.0)],
)
def test_joints_move_evenly_between_outputs(above, away):
    rng = np.random.default_rng(len(above))
    twists, joints = chain(rng, above, away)
    time = np.array([0.0, 0.1, 0.25, 0.3])
    q = np.cumsum(rng.uniform(-0.2, 0.2, (4, len(above))), axis=0)
    names = tuple(f"b{k}" for k in range(len(above) + 1))
    nodes = nodes_of(run(time, np.array([carried(above, twists, row) for row in q]), names), joints)
    for n, (begin, end) in enumerate(pairwise(time)):
        for share in (0.0, 0.2, 0.5, 0.9, 1.0):
            expected = carried(above, twists, q[n] + share * (q[n + 1] - q[n]))
            assert np.abs(nodes.between(begin + share * (end - begin)) - expected).max() < 1e-12 * (1.0 + abs(away))


def test_what_no_joint_carries_turns_along_its_own_screw():
    rng = np.random.default_rng(2)
    twist, start = 0.3 * rng.normal(size=6), displacement(rng.normal(size=6))
    poses = np.array([[start @ displacement(s * twist)] for s in (0.0, 1.0)])
    nodes = nodes_of(run(np.array([0.0, 2.0]), poses, ("loose",)), [])
    assert np.abs(nodes.between(0.5)[0] - start @ displacement(0.25 * twist)).max() < 1e-12


def test_a_loop_is_closed_by_the_joint_of_most_freedoms():
    rng = np.random.default_rng(3)
    twists, joints = chain(rng, (0, 1), 2.0)
    closing = SimpleNamespace(name="a", bodies=("b0", "b2"), freedoms=3)
    time, q = np.array([0.0, 1.0]), np.array([[0.0, 0.0], [0.2, -0.1]])
    poses = np.array([carried((0, 1), twists, row) for row in q])
    nodes = nodes_of(run(time, poses, ("b0", "b1", "b2")), [closing, *joints])
    assert np.abs(nodes.between(0.5) - carried((0, 1), twists, q.mean(axis=0))).max() < 1e-12


def on_a_pin(*posts):
    """An arm on an upright pin, and posts about it."""
    base = box(-65, 65, -65, 65, -5, 0) + rod(3, -1, 8) + rod(6, 8, 10)
    return {"base": sum(posts, base), "arm": box(-5, 45, -5, 5, 0, 7.9) - rod(3.02, -1, 10)}


def fenced(gap):
    """Posts all round its tip, at this gap (mm)."""
    out = float(np.hypot(45, 5)) + gap
    return on_a_pin(*(box(out, out + 5, -4, 4, -1, 8).rotate((0, 0, turn)) for turn in range(20, 380, 40)))


def stopped(turn):
    """A post that it has come to when it has turned by so many degrees."""
    return on_a_pin(box(30, 34, 5, 9, -1, 8).rotate((0, 0, turn)))


def swung(kin, time, turn, X):
    """The arm turned by `turn` (T,) rad at `time` (T,), of which the accelerations are known."""
    names = tuple(sorted(str(body.name) for body in kin.bodies))
    twist = np.concatenate([X[:3, 2], np.cross(X[:3, 3], X[:3, 2])])
    poses = np.tile(np.eye(4), (len(time), 2, 1, 1))
    poses[:, names.index("arm")] = [displacement(angle * twist) for angle in turn]
    return run(time, poses, names, turn, np.gradient(np.gradient(turn, time), time))


@diagonal(away=[0.0, 1.0, 10.0], gap=[0.5, -0.3])
def test_an_arm_passes_posts_wherever_it_is(away, gap):
    meets = gap < 0.0
    X = np.eye(4)
    X[:3, 3] = away
    made, known, touching, kin = derived(fenced(gap), X, ground="base")
    time = np.linspace(0.0, 2.0, 21)
    met, untested = collisions.along(made, known, touching, kin, swung(kin, time, np.radians(55) * time, X))
    assert bool(met) == meets
    assert not untested


@pytest.mark.parametrize(("turn", "meets"), [(11.7, True), (12.3, False)])
def test_a_joint_that_turns_back_between_outputs_is_followed_to_where_it_does(turn, meets):
    made, known, touching, kin = derived(stopped(turn), ground="base")

    def swing(times):
        time = np.linspace(0.0, 2.0, 8 * times + 1)
        return swung(kin, time, np.radians(12) * np.sin(np.pi * time / 1.25), np.eye(4))

    assert np.degrees(swing(1).joint_position.max()) < 11.5
    met, untested = collisions.along(made, known, touching, kin, swing(1), finer=swing)
    assert bool(met) == meets
    assert not untested
