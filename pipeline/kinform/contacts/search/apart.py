"""Which pairs keep so far from each other that nothing of them touches, which is asked before it is looked for how they
touch: of parts whose boxes meet, many do.

Surfaces further apart than the contact tolerance do not touch, and no facet stands further off its surface than the
slack that is known of it. So parts whose facets keep a distance have none of these: points and lines, which are within
a share of the tolerance of both surfaces, with facets of both beside them; rims and edges, which are nearer still;
freeform faces, whose facets are within the tolerance; outlines, whose curves are, and stand off their segments by no
more than a bulge. Mates may be further apart: parts of which some are known are not asked.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts.constants import CYLINDER_EXACT, MATING_REACH
from kinform.contacts.search.pair_view import PairView, PartView, near_facets
from kinform.foundation.meshes.separated_sets import surely_separated
from kinform.foundation.meshes.surface_table import CYLINDER
from kinform.model.arrays import Array, Flags


def far_apart(pairs: Sequence[PairView]) -> list[bool]:
    """Whether it is sure of each pair that no facets are so near each other that anything touches but surfaces that
    mate, or rings that stand for them: of all at once, and of one whatever the others are."""
    asked = {k: (*_facets(pair, far), far) for k, pair in enumerate(pairs) if (far := _distance(pair)) is not None}
    told = dict(zip(asked, surely_separated(list(asked.values())), strict=True))
    return [told.get(k, False) for k in range(len(pairs))]


def _distance(pair: PairView) -> float | None:
    """m: parts whose facets keep it do not touch; None of large parts, and where threads meet, whose flanks may be
    further apart."""
    a, b = pair.near
    # no chain of facets of one plane makes a turn of so few
    if max(len(part.faces) for part in pair.parts) > 10_000:
        return None
    if "helicoid" in a.present and "helicoid" in b.present:
        return None
    bulges = [bulge_of(part, pair.tolerances.smooth_edge) for part in pair.parts]
    slacks = pair.a.table.slack + pair.b.table.slack
    beside = float(a.slacks.max(initial=0.0)) + float(b.slacks.max(initial=0.0))
    outlines = sum(bulges) + slacks if any(bulges) else 0.0
    # Facets on both sides of a point in which parts touch are within this of each other, and what they stand off their
    # surfaces: `CAPTIVE`, and thrice `PROBE_SPARE`.
    points = 0.6 * pair.tolerance + beside
    return max(MATING_REACH * pair.tolerance + outlines, points)


def bulge_of(part: PartView, smooth: float) -> float:
    """m by which curves through its outlines may stand off them; 0 of a part that has no smooth outline but round
    ones. Edges are smooth below `smooth` (rad)."""
    return part.index.bulge(part.surfaces, exact_cylinders(part), smooth)


def exact_cylinders(part: PartView) -> Flags:
    """(s,) which surfaces are cylinders whose fit is better than any curve through their vertices."""
    table = part.table
    return np.asarray((table.kinds == CYLINDER) & (table.residuals < CYLINDER_EXACT * table.chords))


def _facets(pair: PairView, far: float) -> tuple[Array, Array]:
    """(n, 3, 3) and (m, 3, 3) m: facets of both parts, all that come within a distance (m) of the other part among
    them."""
    (a, b), out = pair.parts, []
    for part, other in ((a, b), (b, a)):
        if far <= part.clear:
            faces = part.faces if part.region.facets is None else part.faces.take(part.region.facets, axis=0)
        else:
            faces = part.faces.take(near_facets(part, other.low - far, other.high + far)[0], axis=0)
        out.append(part.vertices.take(faces, axis=0))
    return out[0], out[1]
