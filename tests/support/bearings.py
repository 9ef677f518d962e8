"""Bearings as solids: rings, a shaft, rolling elements as parts of their own, cages. Lengths are in mm.

The truth of each is what its ring and its shaft may do by all contact through the rolling elements while that contact
is kept; the joint is between parts named `ring` and `shaft`, about z through the origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from manifold3d import Manifold
from random_assemblies.lathe import turned

from kinform import contacts, kinematics, surfaces
from kinform.consistency.comparisons.answers import Answer, answer_of
from kinform.consistency.comparisons.comparison import FROM_GEOMETRY
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.consistency.context import Context
from kinform.design import Design
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Kinematics
from support.assemblies import assembly, intended
from support.solids import part, random_pose

Profile = list[tuple[float, float]]


@dataclass(frozen=True)
class Size:
    """How large a bearing is drawn, and how finely."""

    count: int = 8
    """Rolling elements."""
    shaft: float = 8.0
    """mm: radius of the shaft, or of what carries the inner races."""
    element: float = 2.0
    """mm: radius of the rolling elements, of tapered ones at their middle."""
    length: float = 12.0
    """mm: of rollers."""
    play: float = 0.0
    """mm: by which the elements are smaller, as a radius."""
    segments: int = 96
    facets: int = 40
    """Of a ring, and of an element, all round."""
    phase: float = 7.0
    """Degrees."""

    @property
    def race(self) -> float:
        """mm: radius of the outer race of straight rollers."""
        return self.shaft + 2.0 * self.element


@dataclass(frozen=True)
class Bearing:
    """Solids by name, and the joint of ring and shaft that is right."""

    solids: dict[str, Manifold]
    truth: str


def around(size: Size, solid: Manifold, name: str) -> dict[str, Manifold]:
    """The rolling elements: copies of one evenly about z."""
    step = 360.0 / size.count
    return {f"{name}{k}": solid.rotate((0.0, 0.0, step * k + size.phase)) for k in range(size.count)}


def _tube(inner: float, outer: float, low: float, high: float, size: Size) -> Manifold:
    return turned([(inner, low), (outer, low), (outer, high), (inner, high)], size.segments)


def _rod(radius: float, low: float, high: float, segments: int) -> Manifold:
    return turned([(0.0, low), (radius, low), (radius, high), (0.0, high)], segments)


def _shaft(size: Size, collars: bool) -> Manifold:
    """A plain shaft, or one with two collars that hold rollers along it."""
    shaft, high = size.shaft, size.shaft + 0.6 * size.element
    profile: Profile = [(0.0, -14.0), (shaft, -14.0), (shaft, size.length + 14.0), (0.0, size.length + 14.0)]
    if collars:
        profile = [
            (0.0, -14.0), (shaft, -14.0), (shaft, -2.0), (high, -2.0), (high, 0.0), (shaft, 0.0),
            (shaft, size.length), (high, size.length), (high, size.length + 2.0), (shaft, size.length + 2.0),
            (shaft, size.length + 14.0), (0.0, size.length + 14.0),
        ]  # fmt: skip
    return turned(profile, size.segments)


def _race(size: Size, flanges: bool) -> Manifold:
    """An outer ring with a straight race, or one between two flanges."""
    race, outer, low = size.race, size.race + 5.0, size.race - 0.6 * size.element
    if not flanges:
        return _tube(race, outer, 0.0, size.length, size)
    profile = [
        (low, -2.0), (outer, -2.0), (outer, size.length + 2.0), (low, size.length + 2.0), (low, size.length),
        (race, size.length), (race, 0.0), (low, 0.0),
    ]  # fmt: skip
    return turned(profile, size.segments)


def rollers(
    size: Size, *, flanges: bool = False, collars: bool = False, cage: bool = False, ends: float = 0.05
) -> Bearing:
    """Straight rollers or needles; `ends` mm of play along the axis at either flange."""
    room = ends if flanges or collars else 0.0
    roller = _rod(size.element - size.play, room, size.length - room, size.facets)
    middle = size.shaft + size.element
    solids = {"ring": _race(size, flanges), "shaft": _shaft(size, collars)}
    solids |= around(size, roller.translate((middle, 0.0, 0.0)), "roller")
    if cage:
        band = _tube(middle - 0.2 * size.element, middle + 0.2 * size.element, -1.5, size.length + 1.5, size)
        pocket = _rod(size.element + 0.02, -0.1, size.length + 0.1, size.facets).translate((middle, 0.0, 0.0))
        for hole in around(size, pocket, "").values():
            band -= hole
        solids["cage"] = band
    return Bearing(solids, "revolute" if flanges and collars else "cylindrical")


def tapered(size: Size, *, rib: bool = False) -> Bearing:
    """Tapered rollers, whose cones and those of the races have one apex on the axis."""
    half, middle = math.radians(3.0), size.shaft + size.element
    # the roller's axis leans by the half-angles of the inner race and of its own
    far = size.element / math.tan(half)
    lean = math.asin(middle / far)
    inner, outer = lean - half, lean + half
    low, high = far - 0.5 * size.length, far + 0.5 * size.length
    radii = (low * math.tan(half) - size.play, high * math.tan(half) - size.play)
    # the large end is a piece of the ball about the apex, as of real ones, which slides on the rib
    reach = math.hypot(radii[1], high)
    dome = [(reach * math.sin(a), reach * math.cos(a)) for a in np.linspace(math.atan2(radii[1], high), 0.0, 9)[1:-1]]
    roller = turned([(0.0, low), (radii[0], low), (radii[1], high), *dome, (0.0, reach)], size.facets)
    bottom, top = low * math.cos(inner) - 1.0, high * math.cos(outer) + (0.0 if rib else 1.0)
    slope_in, slope_out = math.tan(inner), math.tan(outer)
    shaft = turned([(0.0, bottom), (bottom * slope_in, bottom), (top * slope_in, top), (0.0, top)], size.segments)
    ring = turned(
        [(bottom * slope_out, bottom), (top * slope_out + 5.0, bottom), (top * slope_out + 5.0, top),
         (top * slope_out, top)], size.segments,
    )  # fmt: skip
    solids = {"ring": ring, "shaft": shaft}
    solids |= around(size, roller.rotate((0.0, math.degrees(lean), 0.0)), "roller")
    if rib:
        arc = [(reach * math.sin(a), reach * math.cos(a)) for a in np.linspace(inner - 0.01, inner + 1.2 * half, 12)]
        (r, z), (far, _) = arc[0], arc[-1]
        collar = turned([(r - 1.0, z), *arc, (far, z + 3.0), (r - 1.0, z + 3.0)], size.segments)
        solids["shaft"] = shaft + collar
    return Bearing(solids, "revolute" if rib else "general")


def _ball(size: Size) -> Manifold:
    half = np.linspace(-0.5 * math.pi, 0.5 * math.pi, size.facets // 2 + 1)
    radius = size.element - size.play
    outline: Profile = [(0.0 if k in (0, len(half) - 1) else radius * math.cos(a), radius * math.sin(a))
                        for k, a in enumerate(half)]  # fmt: skip
    return turned(outline, size.facets, 3.0)


def _groove(centre: float, radius: float, height: float, span: float, facets: int) -> list[tuple[float, float]]:
    """Points of the arc about (centre, height), from `span` radians before to after its bottom at +r."""
    angles = np.linspace(-span, span, max(5, round(facets * span / math.pi)))
    return [(centre + radius * math.cos(a), height + radius * math.sin(a)) for a in angles]


def deep_groove(size: Size, *, conformity: float = 1.04, cage: bool = False) -> Bearing:
    """Balls in torus grooves of both rings, whose radius is that of the balls by `conformity`; drawn in the middle."""
    ball, groove = size.element, size.element * conformity
    middle, width, span = size.shaft + ball, 2.4 * ball, math.radians(60.0)
    outer_arc = _groove(middle + ball - groove, groove, 0.0, span, size.facets)
    lip = outer_arc[0][0]
    outer = middle + ball + 0.6 * ball
    ring = turned([(lip, -width), (outer, -width), (outer, width), (lip, width), *outer_arc[::-1]], size.segments)
    inner_arc = [(2.0 * middle - r, z) for r, z in outer_arc]
    lip = inner_arc[0][0]
    shaft = turned(
        [(0.0, -2.0 * width), (lip, -2.0 * width), *inner_arc, (lip, 2.0 * width), (0.0, 2.0 * width)], size.segments
    )
    solids = {"ring": ring, "shaft": shaft} | around(size, _ball(size).translate((middle, 0.0, 0.0)), "ball")
    if cage:
        band = _tube(middle - 0.25 * ball, middle + 0.25 * ball, -1.3 * ball, 1.3 * ball, size)
        pocket = _rod(ball + 0.02, middle - ball, middle + ball, size.facets).rotate((0.0, 90.0, 0.0))
        for hole in around(size, pocket, "").values():
            band -= hole
        solids["cage"] = band
    return Bearing(solids, "revolute")


def thrust_rollers(size: Size) -> Bearing:
    """Rollers that lie like spokes between two flat washers."""
    middle, length = size.shaft + size.length, 0.8 * size.length
    washer = _tube(size.shaft, middle + size.length, 0.0, 3.0, size)
    roller = _rod(size.element - size.play, middle - 0.5 * length, middle + 0.5 * length, size.facets)
    solids = {"ring": washer.translate((0, 0, size.element)), "shaft": washer.translate((0, 0, -size.element - 3.0))}
    return Bearing(solids | around(size, roller.rotate((0.0, 90.0, 0.0)), "roller"), "planar")


def thrust_balls(size: Size, *, grooves: bool = False, conformity: float = 1.04) -> Bearing:
    """Balls between two washers, flat or with torus grooves."""
    ball, middle = size.element, size.shaft + 2.0 * size.element
    inside, outside = middle - 2.2 * ball, middle + 2.2 * ball
    face, groove = ball, ball * conformity
    profile: Profile = [(inside, face), (outside, face), (outside, face + 3.0), (inside, face + 3.0)]
    if grooves:
        arc = _groove(ball - groove, groove, 0.0, math.radians(55.0), size.facets)
        lip = arc[0][0]
        turned_up = [(middle - z, r) for r, z in arc][::-1]
        profile = [(inside, lip), *turned_up, (outside, lip), (outside, ball + 3.0), (inside, ball + 3.0)]
    washer = turned(profile, size.segments)
    solids = {"ring": washer, "shaft": washer.rotate((180.0, 0.0, 0.0))}
    return Bearing(
        solids | around(size, _ball(size).translate((middle, 0.0, 0.0)), "ball"), "revolute" if grooves else "planar"
    )


def self_aligning(size: Size, *, conformity: float = 1.04) -> Bearing:
    """Balls in a groove of the shaft, within a ring whose race is a ball about the middle."""
    ball, groove = size.element, size.element * conformity
    middle, race = size.shaft + ball, size.shaft + 2.0 * ball
    span = math.radians(20.0)
    arc = [(race * math.cos(a), race * math.sin(a)) for a in np.linspace(-span, span, 15)]
    outer = race + 3.0
    ring = turned([arc[0], (outer, arc[0][1]), (outer, arc[-1][1]), *arc[::-1][:-1]], size.segments)
    groove_arc = [(2.0 * middle - r, z) for r, z in _groove(middle + ball - groove, groove, 0.0, 1.0, size.facets)]
    lip, width = groove_arc[0][0], 2.4 * ball
    shaft = turned([(0.0, -width), (lip, -width), *groove_arc, (lip, width), (0.0, width)], size.segments)
    solids = {"ring": ring, "shaft": shaft} | around(size, _ball(size).translate((middle, 0.0, 0.0)), "ball")
    return Bearing(solids, "spherical")


KINDS: dict[str, Callable[[Size], Bearing]] = {
    "needles": rollers,
    "needles, flanges": lambda size: rollers(size, flanges=True),
    "needles, collars": lambda size: rollers(size, collars=True),
    "needles, flanges and collars": lambda size: rollers(size, flanges=True, collars=True),
    "needles, flanges without play": lambda size: rollers(size, flanges=True, ends=0.0),
    "needles, both without play": lambda size: rollers(size, flanges=True, collars=True, ends=0.0),
    "needles, cage": lambda size: rollers(size, cage=True),
    "needles, flanges and cage": lambda size: rollers(size, flanges=True, cage=True),
    "tapers": tapered,
    "tapers, rib": lambda size: tapered(size, rib=True),
    "balls": deep_groove,
    "balls, tight": lambda size: deep_groove(size, conformity=1.0),
    "balls, wide": lambda size: deep_groove(size, conformity=1.12),
    "balls, cage": lambda size: deep_groove(size, cage=True),
    "thrust rollers": thrust_rollers,
    "thrust balls": thrust_balls,
    "thrust balls, grooves": lambda size: thrust_balls(size, grooves=True),
    "self-aligning balls": self_aligning,
}


@dataclass(frozen=True)
class Answers:
    """What contact says of the joint of ring and shaft: where the right one is stated, and where each other is."""

    right: Answer
    others: tuple[Answer, ...]
    kinematics: Kinematics
    reason: str

    def outcome(self) -> tuple[str, str]:
        """agrees, undecided, FALSE (an error of a right function) or WRONG (agreed with what is not), and why."""
        agreed = [one.type for one in self.others if one.answer == "agrees"]
        if agreed:
            return "WRONG", f"agrees with {agreed[0]}, and is {self.right.type}"
        if self.right.answer in ("agrees", "undecided"):
            return self.right.answer, self.reason
        return "FALSE", f"{self.right.type}: {self.right.answer} {self.right.free or self.right.blocked_by}"


def answers_of(bearing: Bearing, rng: np.random.Generator, scale: float = 1e-3, *, complete: bool = False) -> Answers:
    """The answers for a bearing at a random pose; `scale` metres are a mm. `complete`: the function states
    all joints."""
    X = random_pose(rng, 100.0 * scale)
    parts = [part(name, solid, X, scale) for name, solid in bearing.solids.items()]
    axis, point = X[:3, 2], X[:3, 3]

    def stated(kind: str) -> IntendedJoint:
        return intended("spin", "ring", "shaft", kind, None if kind == "spherical" else axis, point)

    made = assembly(*parts, ground="ring", joints=(stated(bearing.truth),))
    if complete:
        made = replace(made, function=replace(made.function, complete=("",)))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    derived = kinematics.derive(made, found, touching)
    kinds = [kind for kind in FROM_GEOMETRY if kind != bearing.truth]
    right, *others = compare_joints(made, touching, derived, [stated(kind) for kind in (bearing.truth, *kinds)])
    context = Context(Design(made, found, touching, derived))
    return Answers(answer_of(context, right), tuple(answer_of(context, one) for one in others), derived, right.reason)
