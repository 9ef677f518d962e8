"""The two ends of the mobility: of contact that only pushes nobody knows from one pose whether it holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.solids import box, part, random_pose, rod

from kinform import contacts, kinematics, surfaces


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
