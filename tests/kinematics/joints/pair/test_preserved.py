"""Which motions slide a patch on itself: those of its surface, within its tolerances."""

from __future__ import annotations

import numpy as np
import pytest
from support.patches import Z, cone, cylinder, plane, sphere

from kinform.foundation.algebra.screws import rotation, translation
from kinform.kinematics.joints.pair.evidence import gather
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.model.tolerances import Tolerances

X, HERE = np.eye(3)[0], np.zeros(3)


def preserved(patch, *motions):
    """Of turns about an axis through a point, and of slides along it."""
    evidence = gather([(0, patch, False)], Tolerances(), 5e-4)
    twists = [translation(axis) if at is None else rotation(axis, at, evidence.frame) for axis, at in motions]
    return preserved_motions(evidence, np.array(twists).T)[0].tolist()


@pytest.mark.parametrize(
    ("patch", "expected"),
    [
        (cylinder(), [True, True, False, False]),
        (cone(), [True, False, False, False]),
        (sphere(cap=0.9), [True, False, True, False]),
        (plane(), [True, False, False, True]),
    ],
)
def test_a_surface_slides_on_itself_as_its_kind_does(patch, expected):
    assert preserved(patch, (Z, HERE), (Z, None), (X, HERE), (X, None)) == expected


@pytest.mark.parametrize(("gap", "beside"), [(0.0, False), (1e-4, True)])
def test_a_clearance_lets_the_axis_of_a_turn_lie_beside_that_of_the_bore(gap, beside):
    assert preserved(cylinder(gap=gap), (Z, 9e-5 * X), (Z, 3e-3 * X)) == [beside, False]
