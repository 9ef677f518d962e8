"""Blocks that come apart along one direction: what is said of them without a linear program, it says too."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import perpendicular
from kinform.kinematics.separation import separations
from kinform.kinematics.separation.constants import CONE_HELD
from kinform.kinematics.separation.contact_rows import Cone
from kinform.kinematics.separation.lifting import lifts_apart
from kinform.kinematics.separation.separations import Link
from kinform.model.kinematics import Release

UP = np.array([0.48, 0.6, 0.64])


def pin(first: int, second: int, place: np.ndarray, axis: np.ndarray = UP, slope: float = 1.0) -> Link:
    """A pin that its bore lets turn and leave along its axis; two samples whose normals lean by the slope."""
    u, v = perpendicular(axis)
    fixed = np.array([[*np.zeros(3), *u], [*np.zeros(3), *v], [*u, *np.zeros(3)], [*v, *np.zeros(3)]])
    rows = np.array([[*(lean * axis), *(slope * axis)] for lean in (1.0, -1.0)])
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    way = Release("slide", np.array([0.0, 0.0, 0.0, *axis]), axis, None, True, "")
    return Link(f"{first}~{second}", (first, second), Cone(fixed, rows, Frame(place, 0.01)), np.zeros((0, 6)), (way,))


def weld(first: int, second: int) -> Link:
    return Link(f"{first}={second}", (first, second), None, np.zeros((0, 6)))


def grid(rng: np.random.Generator, side: int, turned: float) -> list[Link]:
    """Plates on parallel pins, few of them welded, at all edges of a grid: at each the lower plate below the other, but
    for a share that is turned."""
    height = rng.permutation(side * side)
    links = []
    for n in range(side * side):
        for other in [n + side] * (n + side < side * side) + [n + 1] * ((n + 1) % side > 0):
            low, high = (n, other) if (height[n] < height[other]) == (rng.random() >= turned) else (other, n)
            place = 0.05 * np.array([n // side + other // side, n % side + other % side, 0.0]) + 0.03 * rng.random(3)
            links.append(pin(low, high, place) if rng.random() < 0.95 else weld(low, high))
    return links


def test_what_is_lifted_apart_opens_in_the_linear_program(monkeypatch):
    rng, asked = np.random.default_rng(0), []
    monkeypatch.setattr(separations, "lifts_apart", lambda *block: asked.append(lifts_apart(*block)))
    for trial in range(12):
        links = grid(rng, 5, turned=0.0 if trial % 2 else 0.3)
        (opened,) = separations._opened([links], None)
        if asked[-1]:
            assert opened == tuple(k for k, link in enumerate(links) if link.cone is not None)
    assert len(asked) == 12
    assert 0 < sum(asked) < 12


def test_a_stack_comes_apart_and_a_circle_does_not():
    rise = [pin(k, k + 1, np.zeros(3)) for k in range(4)]
    block = [(link.ends, link.cone) for link in rise]
    assert lifts_apart(5, [], [*block, ((0, 4), block[0][1])], [UP])
    assert not lifts_apart(5, [], [*block, ((4, 0), block[0][1])], [UP])
    assert not lifts_apart(5, [(0, 4)], block, [UP])
    assert lifts_apart(5, [(2, 3)], [*block[:2], block[3]], [UP])


def test_what_opens_slowly_or_along_another_axis_is_not_lifted_apart():
    along, across = pin(0, 1, np.zeros(3)), pin(1, 2, np.zeros(3), perpendicular(UP)[0])
    assert not lifts_apart(3, [], [(link.ends, link.cone) for link in (along, across)], [UP, perpendicular(UP)[0]])
    slow = pin(0, 1, np.zeros(3), slope=0.5 * CONE_HELD)
    assert not lifts_apart(2, [], [(slow.ends, slow.cone)], [UP])
    # each opens fast enough, but the last of so many would have to go too far
    gentle = pin(0, 1, np.zeros(3), slope=0.02).cone
    assert lifts_apart(10, [], [((k, k + 1), gentle) for k in range(9)], [UP])
    assert not lifts_apart(11, [], [((k, k + 1), gentle) for k in range(10)], [UP])


def test_a_contact_that_opens_the_other_way_is_lifted_the_other_way():
    cone = pin(0, 1, np.zeros(3)).cone
    down = Cone(cone.fixed, -cone.rows, cone.frame)
    assert lifts_apart(3, [], [((0, 1), cone), ((1, 2), cone), ((2, 0), down)], [UP])
    assert lifts_apart(3, [], [((0, 1), cone), ((1, 2), cone), ((2, 0), down)], [-UP])
    assert not lifts_apart(3, [], [((0, 1), cone), ((1, 2), cone), ((0, 2), down)], [UP])
