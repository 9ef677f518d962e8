"""The contact evidence between two bodies, as arrays: patches, samples, rows and their weights.

Every patch counts with the square root of its area, shared over its samples, less where the gap is
wide: in real joints a small journal decides beside a large thrust face, so neither equal nor area
weights serve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import field
from functools import cached_property
from itertools import accumulate

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.lower_pairs import JointForm, name_space
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.tolerances import Tolerances

GAP_BANDS = ((0.12, 1.0), (0.42, 0.5), (float("inf"), 0.25))
"""(gap over the contact tolerance, weight): gaps weigh, they do not switch."""
TOUCHING_GAP = GAP_BANDS[0][0]
"""Gaps up to this share of the contact tolerance have full weight: the surfaces touch."""
STRAY_SHARE = 0.02
"""Share of the contact area below which a one-sided patch counts only where it touches. Chosen, not measured."""
BOTH_SIDES = -0.9
"""Least cosine between facets of such a patch that is on one side only. Chosen, not measured."""
UNKNOWN_DIRECTION = math.radians(2.0)
"""rad: standard uncertainty between two axes from which on it is not known that the surfaces mate. Of a knee of public
robots it was 3° or 90° by the pose, and with it the mate was found or not; of all others that decide it is below 1°."""
LOOSE_ANGLE = 0.2
"""rad by which the direction of facets of no known surface may be off. Chosen, not measured."""


COAXIAL = ("cylinder", "cone", "torus", "revolution", "helicoid")
"""Kinds of patches with an axis that is a line."""
GUIDES = (*COAXIAL, "sphere", "extrusion")
"""Kinds of curved patches that slide on themselves in a way that both sides share."""

Member = tuple[int, Patch, bool]
"""A patch with its index into Contacts.patches; turned where its part a belongs to the second body."""


@dataclass(frozen=True, eq=False)
class Item:
    """One patch as seen from the first body of the pair."""

    index: int
    """Into Contacts.patches."""
    patch: Patch
    points: Array
    normals: Array
    """(n, 3) out of the first body."""
    weights: Array
    """(n,) m², reduced by the gap bands."""
    area: float
    """m², reduced by the gap bands."""
    angle: float
    """rad: how far the direction of this patch may be off before it is a fact."""
    position: float
    """m: likewise for its line or centre."""
    interferes: bool
    loose: bool = False
    """Facets of no known surface, of no direction of their own."""

    @cached_property
    def middle(self) -> Array:
        """(3,) m: mean of the samples."""
        return np.asarray(self.points.mean(axis=0))


@dataclass(frozen=True, eq=False)
class Line:
    """An axis with the items that support it."""

    axis: Array
    point: Array
    weight: float
    items: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Evidence:
    """All patches between two bodies. Rows: relative twist of the second body, scaled in `frame`."""

    items: tuple[Item, ...]
    frame: Frame
    rows: Array
    """(n, 6)."""
    share: Array
    """(n,) weight of each row's square; sums to 1."""
    start: Ints
    """(items + 1,) first row of each patch."""
    arms: Array
    """(n, 3) samples from the centre, over the length."""
    angle: Array
    """(items,) rad, of each patch."""
    position: Array
    """(items,) m, of each patch."""
    contact: float
    """m: the contact tolerance of the pair."""
    size: float = 0.0
    """m: diagonal of the smaller body; 0: not known."""
    _forms: dict[int, tuple[Array, JointForm]] = field(default_factory=dict, repr=False)
    lines: dict[float, list[Line]] = field(default_factory=dict, init=False, repr=False)
    """The lines that were asked for (`hypotheses.coaxial_lines`), by the alignment (rad) within which axes are one."""

    @cached_property
    def areas(self) -> Array:
        """(items,) m²."""
        return np.array([item.area for item in self.items])

    def form(self, basis: Array) -> JointForm:
        """The joint whose freedoms are the columns of `basis` (6, k); of an array that was asked about before it is
        known."""
        if id(basis) not in self._forms:
            self._forms[id(basis)] = basis, name_space(basis, self.frame)
        return self._forms[id(basis)][1]

    def rows_of(self, chosen: Flags) -> tuple[Array, Array]:
        """Rows (n, 6) and weights (n,) of the items of the flags (items,) that are set, one at least."""
        if chosen.all():
            return self.rows, self.share
        bounds = self.start.tolist()
        parts = [slice(bounds[k], bounds[k + 1]) for k in np.flatnonzero(chosen).tolist()]
        return np.concatenate([self.rows[part] for part in parts]), np.concatenate([self.share[part] for part in parts])

    def speeds_of(self, chosen: Flags, twist: Array) -> Array:
        """(n,) of a twist (6,) along the normals of the items of the flags (items,) that are set."""
        return np.asarray(self.rows_of(chosen)[0] @ twist)

    def without(self, out: Flags) -> Evidence:
        """What is left without the items of these flags (items,), in the same frame; one at least is left."""
        items = self.chosen(~out)
        rows, share = self.rows_of(~out)
        held = np.repeat(~out, np.diff(self.start))
        return Evidence(
            items=tuple(items),
            frame=self.frame,
            rows=rows,
            share=share / share.sum(),
            start=np.array([0, *accumulate(len(item.points) for item in items)], dtype=np.int64),
            arms=self.arms[held],
            angle=self.angle[~out],
            position=self.position[~out],
            contact=self.contact,
            size=self.size,
        )

    def chosen(self, chosen: Flags) -> list[Item]:
        """The items of the flags (items,) that are set."""
        return [item for item, flag in zip(self.items, chosen, strict=True) if flag]


def gather(patches: Sequence[Member], tolerances: Tolerances, contact: float, size: float = 0.0) -> Evidence | None:
    """Evidence of the patches between two bodies.

    `contact` is the contact tolerance (m), `size` the diagonal of the smaller body (m). None when no patch has
    an area.
    """
    items = [
        _item(index, patch, turned, tolerances, contact)
        for index, patch, turned in patches
        if patch.area > 0.0 and len(patch.points) > 0
    ]
    items = _without_strays(items, contact)
    if not items:
        return None
    points = np.concatenate([item.points for item in items])
    normals = np.concatenate([item.normals for item in items])
    patch_weight = np.sqrt([item.area for item in items])
    patch_weight /= patch_weight.sum()
    share = np.concatenate([w * item.weights / item.area for w, item in zip(patch_weight.tolist(), items, strict=True)])
    frame = Frame.about(points, share)
    arms = (points - frame.centre) / frame.length
    return Evidence(
        items=tuple(items),
        frame=frame,
        rows=np.concatenate([cross(arms, normals), normals], axis=1),
        share=share,
        start=np.array([0, *accumulate(len(item.points) for item in items)], dtype=np.int64),
        arms=arms,
        angle=np.array([item.angle for item in items]),
        position=np.array([item.position for item in items]),
        contact=contact,
        size=size,
    )


def _without_strays(items: list[Item], contact: float) -> list[Item]:
    """The items without those that say nothing: facets of no known surface that pass near a small bit of a surface
    without touching it, but where they are on both sides of it, as of a pin in a slot, in one patch or in several; and
    small bits of a round surface that they leave unknown: its axis, and so whether it mates, hangs on their last
    digits."""
    total = sum(item.area for item in items)
    slight = [item for item in items if item.patch.gap > TOUCHING_GAP * contact and item.area < STRAY_SHARE * total]
    unknown = {
        item.index for item in slight if item.patch.kind in COAXIAL and item.patch.mismatch[0] > UNKNOWN_DIRECTION
    }
    passing = [item for item in slight if item.patch.one_sided and item.index not in unknown]
    strays = unknown | {item.index for item in passing if not any(_face(item, other) for other in passing)}
    return [item for item in items if item.index not in strays]


def _face(item: Item, other: Item) -> bool:
    """Are they on either side of one surface of a part?"""
    return (
        item.patch.parts == other.patch.parts
        and any(a == b for a, b in zip(item.patch.surfaces, other.patch.surfaces, strict=True))
        and float((item.normals @ other.normals.T).min()) < BOTH_SIDES
    )


def _item(index: int, patch: Patch, turned: bool, tolerances: Tolerances, contact: float) -> Item:
    """A patch with its weights, and with how far off it may be: by its fit, and by the clearance of what runs in it."""
    apart, touching = np.abs(patch.gaps), max(patch.tolerance, contact)
    weights = np.maximum(patch.weights, TINY)
    if apart.max() / touching > TOUCHING_GAP:
        relative = apart / touching
        band = np.empty(len(patch.points))
        for limit, weight in reversed(GAP_BANDS):
            band[relative <= limit] = weight
        weights *= band
    coaxial = patch.kind in (*COAXIAL, "sphere")
    clearance = max(patch.gap, 0.0) if coaxial else 0.0
    # facets of no known surface have no axis of their own: how uneven the gap is says how far off it may be
    offset = 0.5 * float(np.ptp(patch.gaps)) if patch.one_sided else 0.5 * patch.offset
    direction, position = patch.uncertainty
    loose = patch.one_sided and patch.kind not in ("plane", *GUIDES)
    return Item(
        index=index,
        patch=patch,
        points=patch.points,
        normals=-patch.normals if turned else patch.normals,
        weights=weights,
        area=float(weights.sum()),
        angle=LOOSE_ANGLE if loose else tolerances.alignment + SIGMAS * direction + 0.5 * patch.misalignment,
        position=SIGMAS * position + clearance + offset if coaxial else 0.0,
        interferes=patch.gap < -(patch.chord + SIGMAS * position),
        loose=loose,
    )
