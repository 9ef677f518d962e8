"""A disc on a plate that lies against a post: whether it rolls there, or only ends its way, contact does not tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, intended
from support.diagonal import diagonal
from support.solids import box, extrusion, part, random_pose, rod

from kinform import contacts, kinematics, surfaces
from kinform.consistency.comparisons.answers import answers
from kinform.design import Design

PLATE = box(-50, 50, -50, 50, -5, 0)
BASES = {
    "post": (PLATE + rod(5, -1, 6, 64), 13.0),
    "pocket": (box(-50, 50, -50, 50, -5, 8) - rod(20, 0, 9, 96), 12.0),
}


def answered(kind, base, away, *, complete, names=("base", "disc"), scale=1e-3):
    X = random_pose(np.random.default_rng(1), 100 * scale)
    disc = rod(8, 0, 5, 64).translate((away, 0, 0))
    parts = [part(name, solid, X, scale) for name, solid in zip(names, (base, disc), strict=True)]
    joint = replace(intended("slide", *names, kind, X[:3, 2]), point=None if kind == "planar" else X[:3, 3])
    made = assembly(*parts, ground=names[0], joints=(joint,))
    if complete:
        made = replace(made, function=replace(made.function, complete=("",)))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    (answer,) = answers(Design(made, found, touching, kinematics.derive(made, found, touching)))
    return answer.answer


@diagonal(2, kind=list(BASES), scale=[1e-4, 1e-3, 1.0], complete=[False, True])
def test_a_disc_that_slides_on_a_plate_up_to_a_round_wall_is_not_denied(kind, scale, complete):
    for names in (("base", "disc"), ("z", "disc")):
        assert answered("planar", *BASES[kind], complete=complete, names=names, scale=scale) == "undecided"


@pytest.mark.parametrize("kind", BASES)
def test_away_from_it_it_slides_and_what_it_does_in_one_sense_alone_is_not_held(kind):
    base, away = BASES[kind]
    beside = away + (2.0 if kind == "post" else -2.0)
    assert answered("planar", base, beside, complete=False) == "agrees"
    assert answered("cylindrical", base, away, complete=False) == "not held"


@pytest.mark.parametrize(
    ("kind", "answer"), [("revolute", "agrees"), ("fixed", "agrees"), ("prismatic", "contradicts")]
)
@pytest.mark.parametrize("names", [("frame", "door"), ("z", "door")])
def test_a_door_on_its_jamb_is_what_is_stated_at_rest_and_away_from_it(kind, answer, names):
    X = random_pose(np.random.default_rng(2), 0.1)
    lugs = box(-8, 8, -8, 8, -16, -6) + box(-8, 8, -8, 8, 6, 16) + box(-8, 8, 8, 14, -16, 16)
    frame = lugs + box(-2, 4, -40, -8, 6, 16) - rod(4.05, -17, 17, 48) + box(-2, 4, -40, -30, -8, 16)
    door = rod(7, -5.95, 5.95, 48) + rod(4, -15, 15, 48) + box(-6, -2, -60, -5, -4, 4)
    parts = [part(name, solid, X, 1e-3) for name, solid in zip(names, (frame, door), strict=True)]
    joint = replace(intended("swing", *names, kind, X[:3, 2]), point=X[:3, 3])
    made = assembly(*parts, ground=names[0], joints=(joint,))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    (given,) = answers(Design(made, found, touching, kinematics.derive(made, found, touching)))
    assert given.answer == answer


@pytest.mark.parametrize(
    ("along", "answer"),
    [((0, 0, 1), "agrees"), ((0, 1, 0), "not held"), ((1, 0, 0), "contradicts"), ((0, 0.1, 1), "contradicts")],
)
def test_a_bar_in_a_v_that_is_stated_to_lift_is_not_held(along, answer):
    X = random_pose(np.random.default_rng(3), 0.1)
    base = extrusion([(-30, -20), (30, -20), (30, 20), (20, 20), (0, 0), (-20, 20), (-30, 20)], -40, 40)
    bar = extrusion([(0, 0), (18, 18), (18, 30), (-18, 30), (-18, 18)], -30, 30)
    parts = [part(name, solid, X, 1e-3) for name, solid in (("base", base), ("bar", bar))]
    direction = np.array(along) / np.linalg.norm(along)
    joint = intended("slide", "base", "bar", "prismatic", X[:3, :3] @ direction)
    made = assembly(*parts, ground="base", joints=(joint,))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    (given,) = answers(Design(made, found, touching, kinematics.derive(made, found, touching)))
    assert given.answer == answer
