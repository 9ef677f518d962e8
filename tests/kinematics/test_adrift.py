"""Bodies that overlap with the rest, and that no joint connects with ground, count as free: that they may not be is
said."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import assembly
from support.solids import box, part, random_pose, rod

from kinform import contacts, kinematics, surfaces
from kinform.consistency import check
from kinform.design import Design
from kinform.kinematics import disconnected_bodies, query

BASE, ARM = rod(10, 0, 10), box(-3, 30, -4, 4, 3, 7)
"""The arm is drawn into the base."""
TABLE, CUP = box(-40, 40, -40, 40, -5, 0), box(20, 30, -4, 4, 7, 12)


def design_of(mobility=None, X=None, scale=1e-3, **solids):
    X = np.eye(4) if X is None else X
    parts = (part(name, solid, X, scale) for name, solid in solids.items())
    made = assembly(*parts, ground="base", mobility=mobility)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    return Design(made, found, touching, kinematics.derive(made, found, touching))


def outcome(design):
    (rule,) = (rule for rule in check(design).rules if rule.code == "KF301")
    return rule


@pytest.mark.parametrize("scale", [1e-5, 1e-3, 1.0])
@pytest.mark.parametrize("seed", [None, 3])
def test_what_overlaps_and_is_held_by_nothing_known_is_told(seed, scale):
    X = None if seed is None else random_pose(np.random.default_rng(seed), scale)
    design = design_of(X=X, scale=scale, base=BASE, arm=ARM, cup=CUP)
    (one,) = disconnected_bodies(design.kinematics, design.contacts)
    assert one.bodies == ("arm", "cup")
    assert one.overlap.parts == ("arm", "base")


@pytest.mark.parametrize("mobility", [9, 3])
def test_a_count_that_takes_it_for_free_is_no_pass_and_no_finding(mobility):
    rule = outcome(design_of(mobility, base=BASE, arm=ARM, cup=CUP))
    assert rule.outcome == "inconclusive"
    assert "'arm' and 'base' overlap by 4.8 mm where nothing mates" in rule.reason


def test_whoever_asks_is_told_too():
    design = design_of(base=BASE, arm=ARM, cup=CUP)
    slide = np.array([1.0, 0, 0])
    assert query(design, "base", "arm", slide=slide).text.startswith("base and arm overlap by 4.8 mm where")
    assert "what holds 'arm' and 'cup' is not known" in query(design, "base", "cup", slide=slide).text
    assert "not known" not in query(design, "arm", "cup", slide=slide).text


def test_what_only_lies_apart_or_is_joined_is_not_doubted():
    apart = design_of(6, base=BASE, arm=ARM.translate((40, 0, 0)))
    assert disconnected_bodies(apart.kinematics, apart.contacts) == ()
    assert outcome(apart).outcome == "passed"
    both = {"arm": box(0, 20, -4, 4, 0, 6), "cup": box(15, 30, -3, 5, 0, 9)}
    joined = design_of(6, base=TABLE, **both)
    assert joined.contacts.interferences
    assert disconnected_bodies(joined.kinematics, joined.contacts) == ()
    assert outcome(joined).outcome == "passed"
