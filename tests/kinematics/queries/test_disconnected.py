"""Bodies that interpenetrate the rest and have no joint to ground: they count as free, with a doubt."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import assembly
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency import check
from kinform.design import Design
from kinform.kinematics import disconnected_bodies, disconnected_in_words, query

BASE, ARM = rod(10, 0, 10), box(-3, 30, -4, 4, 3, 7)
"""The arm is drawn into the base."""
TABLE, CUP = box(-40, 40, -40, 40, -5, 0), box(20, 30, -4, 4, 7, 12)


def design_of(mobility=None, X=None, scale=1e-3, **solids):
    X = np.eye(4) if X is None else X
    parts = (part(name, solid, X, scale) for name, solid in solids.items())
    made = assembly(*parts, ground="base", mobility=mobility)
    found, touching = touching_of(made)
    return Design(made, found, touching, kinematics.derive(made, found, touching))


def outcome(design):
    (rule,) = (rule for rule in check(design).rules if rule.code == "KF301")
    return rule


@diagonal(scale=[1e-5, 1e-3, 1.0], seed=[None, 3])
def test_bodies_that_only_overlap_with_the_rest_are_disconnected(seed, scale):
    X = None if seed is None else random_pose(np.random.default_rng(seed), scale)
    design = design_of(X=X, scale=scale, base=BASE, arm=ARM, cup=CUP)
    (one,) = disconnected_bodies(design.kinematics, design.contacts)
    assert one.bodies == ("arm", "cup")
    assert one.overlap.parts == ("arm", "base")


@pytest.mark.parametrize("mobility", [9, 3])
def test_the_mobility_rule_is_inconclusive_about_them(mobility):
    rule = outcome(design_of(mobility, base=BASE, arm=ARM, cup=CUP))
    assert rule.outcome == "inconclusive"


def test_a_query_across_the_gap_repeats_the_doubt():
    design = design_of(base=BASE, arm=ARM, cup=CUP)
    slide = np.array([1.0, 0, 0])
    (one,) = disconnected_bodies(design.kinematics, design.contacts)
    said = disconnected_in_words([one])
    assert one.overlap.depth == pytest.approx(4.8e-3, rel=0.02)
    assert said in query(design, "base", "arm", slide=slide).text
    assert said in query(design, "base", "cup", slide=slide).text
    assert said not in query(design, "arm", "cup", slide=slide).text


def test_bodies_that_are_apart_or_joined_are_not_disconnected():
    apart = design_of(6, base=BASE, arm=ARM.translate((40, 0, 0)))
    assert disconnected_bodies(apart.kinematics, apart.contacts) == ()
    assert outcome(apart).outcome == "passed"
    both = {"arm": box(0, 20, -4, 4, 0, 6), "cup": box(15, 30, -3, 5, 0, 9)}
    joined = design_of(6, base=TABLE, **both)
    assert joined.contacts.interferences
    assert disconnected_bodies(joined.kinematics, joined.contacts) == ()
    assert outcome(joined).outcome == "passed"
