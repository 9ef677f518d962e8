"""A fixed part of the generated pairs that only push: the true motions lie between at rest and closed."""

from __future__ import annotations

import numpy as np
import pytest
from random_assemblies.one_sided import KINDS, one_sided
from random_assemblies.one_sided_verdict import joint_of, judge

from kinform import contacts, form, surfaces


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [1, 3, *(pytest.param(seed, marks=pytest.mark.sweep) for seed in (4, 15, 16))])
def test_true_motions_lie_between_at_rest_and_closed(kind, seed, tmp_path):
    made = one_sided(seed, kind)
    assembly = form.load(made.case.write(tmp_path))
    found = {part.mesh.digest: surfaces.recover(part.mesh, assembly.tolerances) for part in assembly.parts}
    touching = contacts.find(assembly, found)
    verdict = judge(made, joint_of(assembly, found, touching), touching)
    assert verdict.outcome == "in order", verdict.why


def test_a_pair_is_the_same_each_time(tmp_path):
    first, second = (one_sided(5, "hook/wall").case.write(tmp_path / name) for name in ("first", "second"))
    for path in sorted(first.parent.iterdir()):
        assert (second.parent / path.name).read_bytes() == path.read_bytes()


def test_motions_move_with_the_pair():
    """The axis of a lever goes through the middle of the bore, wherever the pair lies."""
    made = one_sided(2, "stop/lever")
    joint = made.case.joints[1]  # about the z of the scene, through its origin
    turn = made.motions[0].twist
    assert np.allclose(np.cross(turn[:3], joint.axis), 0.0, atol=1e-12 * np.linalg.norm(turn[:3]))
    assert np.allclose(turn[3:], np.cross(joint.point, turn[:3]))
