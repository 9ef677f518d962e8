"""Mechanisms whose mobility is in the literature, as lists of joints, and as ball-and-stick manifests.

A joint is (first body, second body, type, axis, point, second axis); `base` is the ground.
"""

from __future__ import annotations

import numpy as np

X, Y, Z = np.eye(3)
ORIGIN = np.zeros(3)


def hinge(a, b, point, axis=Z):
    return (a, b, "revolute", np.asarray(axis, float), np.asarray(point, float), None)


def ball(a, b, point):
    return (a, b, "spherical", None, np.asarray(point, float), None)


def slider(a, b, axis, point=ORIGIN):
    return (a, b, "prismatic", np.asarray(axis, float), np.asarray(point, float), None)


def cardan(a, b, point, axis, axis2):
    return (a, b, "universal", np.asarray(axis, float), np.asarray(point, float), np.asarray(axis2, float))


def ring(points, axes):
    """A closed chain of hinges; the first link is the ground."""
    names = ["base", *(f"link{k}" for k in range(1, len(points)))]
    return [
        hinge(a, b, p, axis)
        for a, b, p, axis in zip(names, [*names[1:], "base"], points, axes, strict=True)
    ]  # fmt: skip


def planar(*points):
    return ring([(*p, 0.0) for p in points], [Z] * len(points))


def slider_crank():
    return [
        hinge("base", "crank", ORIGIN), hinge("crank", "rod", (1, 1, 0)), hinge("rod", "piston", (4, 0, 0)),
        slider("base", "piston", X, (4, 0, 0)),
    ]  # fmt: skip


def watt():
    """Ternary links that meet: the ground and the rocker."""
    return [
        hinge("base", "crank", (0, 0, 0)), hinge("crank", "coupler", (0, 2, 0)),
        hinge("coupler", "rocker", (3, 3, 0)), hinge("base", "rocker", (4, 0, 0)),
        hinge("rocker", "rod", (5, 2.5, 0)), hinge("rod", "follower", (8, 3, 0)),
        hinge("base", "follower", (8, 0.5, 0)),
    ]  # fmt: skip


def stephenson():
    """Ternary links that do not meet: the ground and the coupler."""
    return [
        hinge("base", "crank", (0, 0, 0)), hinge("crank", "coupler", (0, 2, 0)),
        hinge("coupler", "rocker", (3, 3, 0)), hinge("base", "rocker", (4, 0, 0)),
        hinge("coupler", "rod", (2, 4, 0)), hinge("rod", "follower", (6, 5, 0)), hinge("base", "follower", (8, 0.5, 0)),
    ]  # fmt: skip


def bricard():
    corners = ([0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1])
    return ring(corners, [Y, Z, X, Y, Z, X])


def sarrus():
    """A plate on two chains of three parallel hinges, in planes at right angles: it goes straight up."""
    return [
        hinge("base", "a1", (2, 0, 0), Y), hinge("a1", "a2", (3, 0, 1), Y), hinge("a2", "plate", (2, 0, 2), Y),
        hinge("base", "b1", (0, 2, 0), X), hinge("b1", "b2", (0, 3.5, 1), X), hinge("b2", "plate", (0, 2, 2), X),
    ]  # fmt: skip


def stewart():
    joints = []
    for k in range(6):
        low = 2.0 * turned(60.0 * (k // 2) * 2 + (10 if k % 2 else -10))
        high = 1.2 * turned(60.0 * (k // 2) * 2 + (50 if k % 2 else -50)) + np.array([0.1, 0.05, 2.0])
        along = (high - low) / np.linalg.norm(high - low)
        across = np.cross(along, Z)
        across /= np.linalg.norm(across)
        joints += [
            cardan("base", f"low{k}", low, across, np.cross(along, across)),
            slider(f"high{k}", f"low{k}", along, low), ball(f"high{k}", "plate", high),
        ]  # fmt: skip
    return joints


def turned(degrees):
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])


def cardan_shaft(offset=1.0):
    """Two parallel shafts, `offset` apart, joined by a shaft between two universal joints."""
    start, end = ORIGIN, np.array([4.0, offset, 0.0])
    along = (end - start) / np.linalg.norm(end - start)
    across = np.cross(along, Z)
    return [
        hinge("base", "input", start, X), cardan("input", "shaft", start, Z, across),
        cardan("output", "shaft", end, Z, across), hinge("base", "output", end, X),
    ]  # fmt: skip


def roberval():
    """Two beams over each other that carry two upright plates, at equal arms."""
    return [
        hinge("base", "upper", (0, 2, 0)), hinge("base", "lower", (0, 0, 0)),
        hinge("left", "upper", (-3, 2, 0)), hinge("left", "lower", (-3, 0, 0)),
        hinge("right", "upper", (3, 2, 0)), hinge("lower", "right", (3, 0, 0)),
    ]  # fmt: skip


def spherical_four_bar():
    axes = [turned(0), turned(40) + 0.6 * Z, turned(80) + Z, turned(100) + 0.1 * Z]
    return ring([2.0 * a for a in axes], axes)


def generic(count, seed):
    rng = np.random.default_rng(seed)
    return ring(rng.normal(size=(count, 3)), rng.normal(size=(count, 3)))


def door(hinges):
    return [hinge("base", "door", (1, 2, 0.5 * k)) for k in range(hinges)]


def table():
    """A plate on four feet, each of which lies on the floor; floor and table touch four times."""
    return [("base", "plate", "planar", Z, np.array([x, y, 0.0]), None) for x in (0, 1) for y in (0, 2)]


def ball_truss():
    """Two bars in line between two walls, all ends balls: the bars spin, and the middle is shaky two ways."""
    return [ball("base", "left", (0, 0, 0)), ball("left", "right", (1, 0, 0)), ball("base", "right", (2.5, 0, 0))]


def four_bar():
    return planar((0, 0), (0, 2), (3, 3), (4, 0))


def bennett():
    a, alpha, beta, theta = 1.0, np.radians(40), np.radians(70), 1.0
    b = a * np.sin(beta) / np.sin(alpha)
    k = np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2)

    def link(turn, length, twist):
        c, s, ct, st = np.cos(turn), np.sin(turn), np.cos(twist), np.sin(twist)
        return np.array(
            [[c, -s * ct, s * st, length * c], [s, c * ct, -c * st, length * s], [0, st, ct, 0], [0, 0, 0, 1]]
        )

    best = None
    for ratio in (k, 1 / k, -k, -1 / k):
        other = 2 * np.arctan(ratio / np.tan(theta / 2))
        pose, frames = np.eye(4), []
        for turn, length, twist in zip(
            (theta, other, -theta, -other), (a, b, a, b), (alpha, beta, alpha, beta), strict=True
        ):
            frames.append(pose.copy())
            pose = pose @ link(turn, length, twist)
        error = np.abs(pose - np.eye(4)).max()
        if best is None or error < best[0]:
            best = (error, frames)
    assert best[0] < 1e-12
    return [f[:3, 3] for f in best[1]], [f[:3, 2] for f in best[1]]


KNOWN = {
    # joints, first-order freedoms, finite, infinitesimal only, singular
    "four-bar": (four_bar(), 1, 1, 0, False),
    "five-bar": (planar((0, 0), (0, 2), (2, 3.5), (4, 2), (4, 0)), 2, 2, 0, False),
    "parallelogram": (planar((0, 0), (1, 2), (5, 2), (4, 0)), 1, 1, 0, False),
    "flat parallelogram": (planar((0, 0), (1, 0), (4, 0), (3, 0)), 2, 1, 0, True),
    "slider-crank": (slider_crank(), 1, 1, 0, False),
    "Watt six-bar": (watt(), 1, 1, 0, False),
    "Stephenson six-bar": (stephenson(), 1, 1, 0, False),
    "Bennett": (ring(*bennett()), 1, 1, 0, False),
    "rectangular Bricard": (bricard(), 1, 1, 0, False),
    "Sarrus": (sarrus(), 1, 1, 0, False),
    "Stewart platform": (stewart(), 6, 6, 0, False),
    "Cardan shaft": (cardan_shaft(), 1, 1, 0, False),
    "shaky truss": (planar((0, 0), (1, 0), (2.5, 0)), 1, 0, 1, False),
    "shaky truss with balls": (ball_truss(), 4, 2, 2, False),
    "Roberval balance": (roberval(), 1, 1, 0, False),
    "generic six hinges": (generic(6, 3), 0, 0, 0, False),
    "generic seven hinges": (generic(7, 3), 1, 1, 0, False),
    "spherical four-bar": (spherical_four_bar(), 1, 1, 0, False),
    "door with two hinges": (door(2), 1, 1, 0, False),
    "door with four hinges": (door(4), 1, 1, 0, False),
    "table": (table(), 3, 3, 0, False),
}


def manifest(joints, *, mobility=None, ground="base"):
    """The mechanism as a ball-and-stick manifest in TOML, lengths in m."""
    names = sorted({name for joint in joints for name in joint[:2]})
    lines = ["schema = 1", "[assembly]", 'name = "sticks"', 'units = "m"', f'ground = "{ground}"']
    for name in names:
        lines += ["[[part]]", f'name = "{name}"']
    lines += ["[function]"] + ([] if mobility is None else [f"mobility = {mobility}"])
    for number, (a, b, kind, *vectors) in enumerate(joints):
        lines += ["[[function.joint]]", f'name = "j{number}"', f'between = ["{a}", "{b}"]', f'type = "{kind}"']
        for key, vector in zip(("axis", "point", "axis2"), vectors, strict=True):
            if vector is not None:
                lines.append(f"{key} = {[float(x) for x in vector]}")
    return "\n".join(lines) + "\n"


CLOSED = {
    "four-bar": (([0, 0, 0], [0, 2, 0], [3, 3, 0], [4, 0, 0]), [Z] * 4, 1),
    "parallelogram": (([0, 0, 0], [1, 2, 0], [5, 2, 0], [4, 0, 0]), [Z] * 4, 1),
    "five-bar": (([0, 0, 0], [0, 2, 0], [2, 3.5, 0], [4, 2, 0], [4, 0, 0]), [Z] * 5, 2),
    "triangle": (([0, 0, 0], [1, 1, 0], [2, 0, 0]), [Z] * 3, 0),
    "shaky truss": (([0, 0, 0], [1, 0, 0], [2, 0, 0]), [Z] * 3, 1),
    "bricard": (
        ([0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]),
        [Y, Z, X, Y, Z, X],
        1,
    ),
    "generic spatial seven-bar": (
        np.random.default_rng(1).normal(size=(7, 3)),
        np.random.default_rng(2).normal(size=(7, 3)),
        1,
    ),
    "four-bar with one axis off": (([0, 0, 0], [0, 2, 0], [3, 3, 0], [4, 0, 0]), [Z, [1e-3, 0, 1], Z, Z], 0),
}
