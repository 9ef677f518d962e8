"""Left and right links of a description: which are a pair, in which plane the robot is mirrored, and what is not.

Pairs are told by names (left and right, l and r, fl and fr, …). The plane is the one in which the frames of most pairs
are mirrored. A pair of links whose geometry is not mirrored may be turned by half a turn instead, as equal parts on
both sides often are: then stated masses are compared under that turn.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

import numpy as np

from kinform.consistency.comparisons.links import Weighed
from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.descriptions import DescribedLink, Description

MIRRORED = 2e-3
"""Share of the span of all pairs by which a frame may be off its mirror image: numbers that were rounded to millimetres
in a robot of half a metre. Chosen, not measured."""
PLANE_NEAR = math.cos(math.radians(15.0))
"""Cosine of the angle within which the plane of symmetry is across an axis of the first link: robots are drawn so.
Chosen, not measured."""
MIRRORED_ANGLE = math.radians(0.5)
"""rad by which an axis may be off its mirror image: numbers that were rounded to two decimals. Chosen, not measured."""


_OTHER = {
    "left": "right", "l": "r", "fl": "fr", "lf": "rf", "hl": "hr", "lh": "rh", "bl": "br", "lb": "rb", "rl": "rr",
    "lr": "rr", "ml": "mr", "lm": "rm",
}  # fmt: skip
"""What stands for the left, and for the right in its place."""


@dataclass(frozen=True, eq=False)
class Image:
    """A motion of space: x ↦ A x + b, a mirror or half a turn."""

    A: Array
    b: Array

    def of(self, points: Array) -> Array:
        """Images of points (…, 3)."""
        return np.asarray(points @ self.A.T + self.b)


@dataclass(frozen=True, eq=False)
class Pair:
    """A left link and the right one beside it."""

    left: DescribedLink
    right: DescribedLink
    off: float
    """m between the mirrored origin of the left and that of the right: the axis through it, where a joint turns it."""
    tilt: float
    """rad between the mirrored axis of the left and that of the right; 0 without axes."""


@dataclass(frozen=True, eq=False)
class Sides:
    """The pairs of a description, and the mirror of most of them."""

    pairs: tuple[Pair, ...]
    mirror: Image
    turns: tuple[Image, ...]
    """Half turns about axes in the plane."""
    span: float
    """m: how far the frames of the pairs are apart."""

    def agrees(self, pair: Pair) -> bool:
        """Whether the frames of a pair are mirrored."""
        return pair.off <= MIRRORED * self.span and pair.tilt <= MIRRORED_ANGLE


def partner(name: str, names: Mapping[str, DescribedLink]) -> str | None:
    """The name of the right link for that of a left one; None where there is none."""
    pieces = re.split(r"([_\-./ ]+|(?<=[a-z])(?=[A-Z])|(?<=[A-Za-z])(?=[0-9]))", name)
    for k, piece in enumerate(pieces):
        other = _OTHER.get(piece.lower())
        if other is None and piece.lower().startswith("left"):
            other = "right" + piece[4:].lower()
        if other is None:
            continue
        written = other.upper() if piece.isupper() else other.title() if piece[:1].isupper() else other
        right = "".join([*pieces[:k], written, *pieces[k + 1 :]])
        if right in names:
            return right
    return None


def sides_of(description: Description) -> Sides | None:
    """The pairs and their plane; None where there are no pairs, or most of them are not mirrored in one plane."""
    names = {link.name: link for link in description.links}
    found = [(link, names[other]) for link in description.links if (other := partner(link.name, names)) is not None]
    if not found:
        return None
    parents = {joint.between[1]: joint.between[0] for joint in description.joints}
    axes, above = _axes(description), {a.name: b.name for a, b in found}
    left, right = (np.array([pair[k].position for pair in found]) for k in (0, 1))
    span = float(np.linalg.norm(np.ptp(np.concatenate([left, right]), axis=0)))
    apart = [(a, b) for a, b in zip(left, right, strict=True) if np.linalg.norm(b - a) > 1e-3 * span > 0.0]
    readings = []
    for mirror in (_mirror(a, b, description.links[0].rotation) for a, b in apart):
        pairs = []
        for a, b in found:
            pairs.append(_pair(mirror, (a, b), _above(a, b, parents, names, above), axes))
        readings.append(Sides(tuple(pairs), mirror, tuple(_turns(mirror)), span))
    if not readings:
        return None
    votes = [sum(map(sides.agrees, sides.pairs)) for sides in readings]
    best = int(np.argmax(votes))
    return readings[best] if votes[best] and 2 * votes[best] >= len(found) else None


def _above(
    a: DescribedLink,
    b: DescribedLink,
    parents: Mapping[str, str],
    names: Mapping[str, DescribedLink],
    partners: Mapping[str, str],
) -> tuple[DescribedLink, DescribedLink] | None:
    """The links above two links, where these are a pair, too."""
    first, second = parents.get(a.name, ""), parents.get(b.name, "")
    return (names[first], names[second]) if first in partners and partners[first] == second else None


def _axes(description: Description) -> dict[str, Array]:
    """The axes of the joints that carry links, by link."""
    turns = {joint.between[1]: joint.axis for joint in description.joints if joint.point is not None}
    return {link: axis for link, axis in turns.items() if axis is not None}


def _pair(
    mirror: Image,
    ends: tuple[DescribedLink, DescribedLink],
    upper: tuple[DescribedLink, DescribedLink] | None,
    axes: Mapping[str, Array],
) -> Pair:
    """The pair of a left and a right link; relative to the links above them where these are a pair, too."""
    left, right = ends
    if upper is None:
        gap = right.position - mirror.of(left.position)
    else:
        gap = (right.position - upper[1].position) - mirror.A @ (left.position - upper[0].position)
    for link in (right, *(() if upper is None else upper[1:])):
        if link.name in axes:  # where on its axis the origin of a joint lies is the writer's choice
            gap = gap - axes[link.name] * (axes[link.name] @ gap)
    tilt = 0.0
    if left.name in axes and right.name in axes:
        tilt = math.asin(min(1.0, float(np.linalg.norm(np.cross(mirror.A @ axes[left.name], axes[right.name])))))
    return Pair(left, right, float(np.linalg.norm(gap)), tilt)


def _mirror(a: Array, b: Array, R: Array) -> Image:
    """The mirror that takes a to b, across an axis of the frame R (3, 3) that is near; the plane half way between."""
    normal = (b - a) / np.linalg.norm(b - a)
    nearest = R[:, int(np.argmax(np.abs(R.T @ normal)))]
    if abs(float(nearest @ normal)) > PLANE_NEAR:
        normal = nearest
    return Image(np.eye(3) - 2.0 * np.outer(normal, normal), 2.0 * float(normal @ (0.5 * (a + b))) * normal)


def _turns(mirror: Image) -> Iterator[Image]:
    """Half turns about the two directions in the plane that are nearest to the world's axes."""
    normal = np.linalg.eigh(mirror.A)[1][:, 0]
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    u = first - normal * (normal @ first)
    u /= np.linalg.norm(u)
    for axis in (u, cross(normal, u)):
        yield Image(2.0 * np.outer(axis, axis) - np.eye(3), np.zeros(3))


@dataclass(frozen=True, eq=False)
class Look:
    """Moments of the surface of a link: area (m²), centroid (3,) m, second (3, 3) m² and third moments (3, 3, 3) m³
    about it, and box."""

    area: float
    centroid: Array
    second: Array
    third: Array
    size: float


def look_of(body: Weighed) -> Look | None:
    """The moments of the facets of all meshes; None where there are none."""
    areas, middles, spreads = [], [], []
    for part in body.parts:
        if part.mesh is None or not len(part.mesh.faces):
            continue
        points = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
        a, b, c = (points[part.mesh.faces[:, k]] for k in range(3))
        own = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        areas.append(own)
        middles.append((a + b + c) / 3.0)
        spreads.append(np.stack([a, b, c], axis=1))
    if not areas:
        return None
    weights, corners = np.concatenate(areas), np.concatenate(spreads)
    area = float(weights.sum())
    if area <= 0.0:
        return None
    centroid = weights @ np.concatenate(middles) / area
    away = corners - centroid
    mean = away.mean(axis=1)
    ends = np.einsum("n,nki,nkj->ij", weights, away, away)
    second = (ends + 9.0 * np.einsum("n,ni,nj->ij", weights, mean, mean)) / 12.0
    third = -27.0 / 48.0 * np.einsum("n,ni,nj,nk->ijk", weights, mean, mean, mean)  # exact for cubics
    for q in (0.6 * mean + 0.4 * away[:, k] for k in range(3)):
        third += 25.0 / 48.0 * np.einsum("n,ni,nj,nk->ijk", weights, q, q, q)
    return Look(area, centroid, second / area, third / area, body.size)


def brought(turn: Image, left: Look, right: Look) -> Image:
    """The turn about that axis which brings the centroid of the left to that of the right."""
    return Image(turn.A, right.centroid - turn.A @ left.centroid)


def unlike(image: Image, left: Look, right: Look) -> float:
    """How far the right is from the image of the left: the worst of its centroid as a share of its size, its second
    moments relative to their trace, a fifth of its third moments relative to that trace to the power of 3/2 (the
    second ones of what is moved and of what is turned are often equal), and a tenth of its area."""
    size = max(left.size, right.size)
    apart = float(np.linalg.norm(image.of(left.centroid) - right.centroid)) / size
    traces = float(np.trace(left.second)) + float(np.trace(right.second))
    spread = 2.0 * float(np.linalg.norm(image.A @ left.second @ image.A.T - right.second)) / traces
    turned = np.einsum("ai,bj,ck,ijk->abc", image.A, image.A, image.A, left.third)
    lopsided = float(np.linalg.norm(turned - right.third)) / float((0.5 * traces) ** 1.5)
    area = abs(left.area - right.area) / max(left.area, right.area)
    return max(apart, spread, 0.2 * lopsided, 0.1 * area)


def inertial_off(image: Image, left: Weighed, right: Weighed) -> tuple[float, float, float]:
    """Of stated masses under an image: relative difference of mass, distance of centres (m), relative difference of
    inertias."""
    masses = abs(left.mass - right.mass) / max(left.mass, right.mass)
    centres = float(np.linalg.norm(image.of(left.centre) - right.centre))
    turned = image.A @ left.inertia @ image.A.T
    scale = max(float(np.linalg.norm(left.inertia)), float(np.linalg.norm(right.inertia)))
    inertias = float(np.linalg.norm(turned - right.inertia)) / scale if scale > 0.0 else 0.0
    return masses, centres, inertias
