"""What second moments say of motions that patches preserve is what the sums over their samples say."""

from __future__ import annotations

import numpy as np
import pytest
from support.patches import Z, cone, cylinder, plane, ring, sphere

from kinform.kinematics.joints.pair import preserved
from kinform.kinematics.joints.pair.evidence import gather
from kinform.kinematics.joints.pair.hypotheses import candidate_motions
from kinform.model.tolerances import Tolerances

X = np.eye(3)[0]
PAIRS = (
    [cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)],
    [cylinder(gap=1e-4), ring((0, 0, 0.01))],
    [sphere(cap=0.3), cylinder(0.005, 0.02)],
    [plane(), plane((0.01, 0, 0.005), X), plane((-0.01, 0, 0.005), -X)],
    [plane(one_sided=True), cone()],
    [cylinder(misalignment=0.05, offset=1e-4), plane((0.004, 0, 0), X, (0.002, 0.01))],
)


def evidences():
    made = (gather([(k, p, False) for k, p in enumerate(of)], Tolerances(), 5e-4) for of in PAIRS)
    return [evidence for evidence in made if evidence is not None]


def near_the_limits(evidence, rng, count):
    """Unit twists that differ from candidate motions by about what the patches tolerate."""
    candidates = candidate_motions(evidence, Tolerances().alignment)
    twists = np.array([candidates[int(k)].twist for k in rng.integers(len(candidates), size=count)]).T
    twists = twists + rng.normal(size=twists.shape) * 10.0 ** rng.uniform(-5.0, -1.0, count)
    return twists / np.linalg.norm(twists, axis=0)


@pytest.mark.parametrize("seed", range(5))
def test_moments_say_what_sums_over_samples_say(seed):
    rng = np.random.default_rng(seed)
    asked = [(evidence, near_the_limits(evidence, rng, 40)) for evidence in evidences()]
    for (evidence, twists), flags in zip(asked, preserved.preserved_by_each(asked), strict=True):
        exact = preserved.preserved_motions(evidence, twists)
        assert (flags == exact).all()
        assert exact.any()
        assert not exact.all()


def test_sums_over_samples_are_asked_for_only_where_moments_leave_it_open(monkeypatch):
    asked = [(e, np.array([m.twist for m in candidate_motions(e, 0.01)]).T) for e in evidences()[:4]]
    monkeypatch.setattr(preserved, "preserved_motions", lambda *_: pytest.fail("asked"))
    assert all(flags.any() for flags in preserved.preserved_by_each(asked))
