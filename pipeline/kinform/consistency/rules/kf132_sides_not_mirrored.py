"""Left and right links of a robot description are not mirror images.

Links are pairs by name (left and right, l and r, fl and fr, …), and the plane is the one in which the frames of at
least half of the pairs are mirrored, each beside the pair above it; without one nothing is asked. Then, of each pair:
frames, stated masses, centres of mass and inertias, and geometry. Where more than half of the pairs differ in geometry,
only those are told whose stated masses say that they are mirror images. Equal parts that are turned by half a turn
instead of mirrored pass, and so do their masses under that turn. Of each kind the worst pair is told, with the others.

Why it matters: a robot that leans to one side in simulation and not in reality; usually one side was edited, or its
inertia was copied without turning the signs of its products.

What to do: mirror the numbers of the side that is right: across the plane y = 0, `y` of the centre of mass, `ixy` and
`iyz` change their signs.

Example: the right thigh has the `ixy` of the left one, with the same sign.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.consistency.comparisons.links import Weighed
from kinform.consistency.comparisons.sides import (
    MIRRORED_ANGLE,
    Image,
    Look,
    Pair,
    Sides,
    brought,
    inertial_off,
    look_of,
    sides_of,
    unlike,
)
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import angle, counted, length, number, quoted
from kinform.model.assembly import Source
from kinform.model.descriptions import Description
from kinform.model.findings import Finding

SAME = 0.02
"""Share of a link's size by which its geometry and its centre of mass may be off the image of the other side, and
relative difference of their masses: screws, labels, connectors. Chosen, not measured."""
SAME_INERTIA = 0.10
"""Relative difference of inertias of two sides, products included: they go with the square of distances, and what is
off by `SAME` at both ends of the size is off by some times as much. Chosen, not measured."""


_Told = tuple[float, Pair, str]
"""How bad, which pair, in which words."""


def check(context: Context) -> Outcome:
    """The pairs of every description."""
    findings: list[Finding] = []
    count = 0
    for description in context.assembly.descriptions:
        sides = sides_of(description)
        if sides is None:
            continue
        count += len(sides.pairs)
        findings += _Judge(context, description, sides).findings()
    if not count:
        return skipped("no links are told to be left and right, and mirrored in one plane")
    return decided(findings, f"{counted(count, 'pair')} compared")


class _Judge:
    def __init__(self, context: Context, description: Description, sides: Sides):
        self.context, self.sides = context, sides
        self.bodies = {body.name: body for body in context.weighed}
        self.looks: dict[str, Look | None] = {}
        by_name = {str(part.name): part for part in context.assembly.parts}
        for pair in sides.pairs:
            for link in (pair.left, pair.right):
                parts = tuple(by_name[name] for name in link.parts if name in by_name)
                shape = Weighed(link.name, 0.0, link.position, link.rotation, parts, Source(link.file), link)
                self.looks[link.name] = None if link.name in description.incomplete else look_of(shape)

    def findings(self) -> Iterator[Finding]:
        """One for each kind of difference."""
        looks = list(self._looks())
        seen = [pair for pair in self.sides.pairs if self._seen(pair)]
        if 2 * len(looks) > len(seen):
            looks = [told for told in looks if self._mass_mirrored(told[1])]
        if looks:
            yield from self._told(looks, "geometry is no mirror image", "Mirror the mesh (a negative scale does), or "
                                  "correct its origin.")  # fmt: skip
        yield from self._told(list(self._frames()), "frame is not mirrored", "Mirror the origin of the joint.")
        yield from self._told(list(self._inertials()), "stated mass is not mirrored",
                              "Mirror the numbers of the side that is right.")  # fmt: skip

    def _told(self, told: list[_Told], what: str, remedy: str) -> Iterator[Finding]:
        if not told:
            return
        _, pair, words = max(told, key=lambda item: item[0])
        others = [other.right.name for _, other, _ in told if other is not pair]
        also = f"; so are {quoted(others)}" if len(others) > 1 else f"; so is {quoted(others)}" if others else ""
        line = pair.right.line if pair.right.stated is None or "mass" not in what else pair.right.stated.line
        yield RULE.finding(
            [pair.right.name, pair.left.name],
            f"link '{pair.right.name}' beside '{pair.left.name}': its {what}: {words}{also}",
            found=words,
            intended=f"the mirror image of '{pair.left.name}'",
            place=pair.right.position,
            declared=Source(pair.right.file, line),
            remedy=remedy,
        )

    def _frames(self) -> Iterator[_Told]:
        for pair in self.sides.pairs:
            if not self.sides.agrees(pair):
                tilted = f", and its axis {angle(pair.tilt)} askew" if pair.tilt > MIRRORED_ANGLE else ""
                bad = pair.off / self.sides.span + pair.tilt
                yield bad, pair, f"it is {length(pair.off, self.context.units)} from there{tilted}"

    def _seen(self, pair: Pair) -> bool:
        return self.looks[pair.left.name] is not None and self.looks[pair.right.name] is not None

    def _image(self, pair: Pair) -> tuple[float, Image]:
        """The mirror, or the half turn that fits better, and how far the right is from that."""
        left, right = self.looks[pair.left.name], self.looks[pair.right.name]
        if left is None or right is None:
            return 0.0, self.sides.mirror
        images = [self.sides.mirror, *(brought(turn, left, right) for turn in self.sides.turns)]
        offs = [unlike(image, left, right) for image in images]
        best = 0 if offs[0] <= SAME else min(range(len(offs)), key=offs.__getitem__)
        return offs[best], images[best]

    def _looks(self) -> Iterator[_Told]:
        for pair in self.sides.pairs:
            if self._seen(pair):
                off, _ = self._image(pair)
                if off > SAME:
                    yield off, pair, f"it differs by {number(100.0 * off, 2)} % of its size"

    def _mass_mirrored(self, pair: Pair) -> bool:
        """Whether the stated masses of a pair are mirror images, by numbers that its geometry does not have."""
        left, right = self.looks[pair.left.name], self.looks[pair.right.name]
        one, other = self.bodies.get(pair.left.name), self.bodies.get(pair.right.name)
        if left is None or right is None or one is None or other is None:
            return False
        size = max(one.size, other.size)
        masses, centres, inertias = inertial_off(self.sides.mirror, one, other)
        same = masses <= SAME and centres <= SAME * size and inertias <= SAME_INERTIA
        beside = np.linalg.norm(self.sides.mirror.of(left.centroid) - right.centroid)
        return bool(same and beside > SAME * size)

    def _inertials(self) -> Iterator[_Told]:
        for pair in self.sides.pairs:
            left, right = self.bodies.get(pair.left.name), self.bodies.get(pair.right.name)
            if left is None or right is None or not (left.possible and right.possible):
                continue
            off, image = self._image(pair)
            if off > SAME:
                continue
            masses, centres, inertias = inertial_off(image, left, right)
            size = max(left.size, right.size)
            words = [
                f"the masses differ by {number(100.0 * masses, 2)} %" if masses > SAME else "",
                f"the centre is {length(centres, self.context.units, 3)} from there" if centres > SAME * size else "",
                f"the inertias differ by {number(100.0 * inertias, 2)} %" if inertias > SAME_INERTIA else "",
            ]
            if any(words):
                bad = max(masses / SAME, centres / (SAME * size), inertias / SAME_INERTIA)
                yield bad, pair, ", ".join(filter(None, words))


RULE = Rule("KF132", "sides-not-mirrored", "warning", __doc__, check, needs=("descriptions",))
