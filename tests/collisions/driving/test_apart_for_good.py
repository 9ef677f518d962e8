"""Parts in loops that only turn or slide on each other are told from those that do something else."""

from __future__ import annotations

import numpy as np
import pytest
from support.solids import assembly, block, part, random_pose, rod

from kinform import contacts, surfaces
from kinform.collisions.driving.apart_for_good import one_motion, that_can_meet
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.displacements import displacement
from kinform.foundation.algebra.vectors import cross
from kinform.kinematics.mobility.guides import preserved

MIDDLE = np.array([3.0, -20.0, 100.0])
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
OFF = 1e-8


def motion(twist, way):
    return np.array([displacement(s * twist) for s in way])


@pytest.mark.parametrize("most", [0.01, 1.0, np.pi, 6.0])
def test_a_turn_about_one_axis_is_found_wherever_it_is(most):
    point = MIDDLE + [0.1, 0.2, -0.1]
    twist = np.append(AXIS, cross(point, AXIS))
    found = one_motion(motion(twist, np.linspace(0.0, most, 40)), MIDDLE, 1.0, OFF)
    assert found is not None
    sense = np.sign(found[:3] @ AXIS)
    assert sense * found[:3] == pytest.approx(AXIS, abs=1e-9)
    assert sense * found[3:] == pytest.approx(twist[3:], abs=1e-7)


def test_a_slide_is_found():
    found = one_motion(motion(np.append(np.zeros(3), AXIS), np.linspace(0.0, 0.2, 9)), MIDDLE, 1.0, OFF)
    assert found is not None
    assert not found[:3].any()
    assert abs(found[3:] @ AXIS) == pytest.approx(1.0, abs=1e-12)


def test_screws_turns_about_two_axes_and_rests_are_neither():
    through = np.append(AXIS, cross(MIDDLE, AXIS))
    screw = through + np.append(np.zeros(3), 1e-3 * AXIS)
    beside = np.append(AXIS, cross(MIDDLE + [1e-4, 0.0, 0.0], AXIS))
    way = np.linspace(0.0, 1.0, 9)
    for displacements in (
        motion(screw, way),
        motion(through, way) @ motion(beside, way**2),
        np.concatenate([motion(np.append(np.zeros(3), e), way) for e in np.eye(3)[:2]]),
        np.repeat(np.eye(4)[None], 5, axis=0),
    ):
        assert one_motion(displacements, MIDDLE, 1.0, OFF) is None


def pair(shapes, first, second):
    return PairTest(shapes, first, second, shapes.moved_facets(first, second, np.zeros((0, 6))), [])


@pytest.mark.parametrize(
    ("X", "scale"),
    [(np.eye(4), 1e-3), (random_pose(np.random.default_rng(4)), 1e-3), (random_pose(np.random.default_rng(5)), 1.0)],
)
def test_parts_beside_each_other_on_an_axis_never_meet_and_others_may(X, scale):
    """Of a lever about z: what lies above it, what it sweeps past, what stands in its way, what is deep inside it."""
    solids = {
        "lever": block(40, 6, 4).translate((10, 0, 0)),
        "above": block(40, 6, 4).translate((10, 0, 5)),
        "outside": block(4, 4, 4).translate((40, 0, 0)),
        "inside": block(1, 1, 1).translate((0.2, 0, 0)),
        "peg": block(4, 4, 20).translate((0, 15, 0)),
    }
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground=None)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    shapes = Shapes(made, known, None, {name: frozenset([name]) for name in solids})
    axis, point = X[:3, 2], X[:3, 3]
    turns = motion(np.append(axis, cross(point, axis)), np.linspace(0.0, 2.0, 30))
    slides = motion(np.append(np.zeros(3), axis), scale * np.linspace(0.0, 30.0, 30))

    def met(name, way):
        """Numbers of facets that can meet."""
        some = that_can_meet(shapes, pair(shapes, name, "lever"), way)
        return None if some is None else tuple(map(len, some.facets))

    assert {name: met(name, turns) for name in ("above", "outside", "inside")} == {
        "above": None,
        "outside": None,
        "inside": (12, 12),
    }
    assert met("peg", turns) == (8, 8)  # its ends lie above and below the lever, whose ends lie beyond it
    assert met("above", slides) is not None
    assert met("outside", slides) is None
    assert met("above", turns @ slides) == (12, 12)


@pytest.mark.parametrize("X", [np.eye(4), random_pose(np.random.default_rng(6))])
def test_a_collar_that_only_turns_on_its_deck_never_meets_it_and_its_tooth_may(X):
    """A bush in a bore may turn and slide; where its loop only turns it, its collar slides along itself."""
    bore = block(40, 40, 10) - rod(5, -6, 6)
    bush = rod(5, -5, 5) + rod(8, 5, 8)
    peg = block(2, 2, 4).translate((12, 0, 6.5))
    decks = {"plain": bore, "pegged": bore + peg, "beyond": bore + peg.translate((4, 0, 0))}
    for name, deck in decks.items():
        toothed = bush + block(6, 2, 2).translate((10, 0, 6.5)).rotate((0, 0, 90))
        made = assembly(part("deck", deck, X), part("bush", toothed, X), ground=None)
        known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
        shapes = Shapes(made, known, contacts.find(made, known))
        axis, point = X[:3, 2], X[:3, 3]
        twists = np.array([np.append(axis, cross(point, axis)), np.append(np.zeros(3), axis)])
        mates = [patch for patch in shapes.patches("deck", "bush") if preserved(patch, twists)]
        test = PairTest(shapes, "deck", "bush", shapes.moved_facets("deck", "bush", twists), mates)
        met = that_can_meet(shapes, test, motion(twists[0], np.linspace(0.0, 2.0, 30)))
        assert mates
        assert (met is not None) == (name == "pegged")
