"""Contacts: where the parts of an assembly touch, as patches between surfaces, and where they overlap.

How a patch is found is best read in this order:

1. `find` is the stage. `search.candidates` names the pairs of parts whose boxes come within the contact tolerance, and
   every pair is then a question of its own, which `pair.mated_pairs`, `pair.touching` and `pair.pair_contacts` answer
   step by step: of pairs of small meshes the first of them answers many at once, to the same bytes.
2. `search.pair_view` lays both parts into the frame of the pair and keeps what of either lies near the other: a
   `PairView`, with the tolerance, is what all questions below take; a `SurfacePair` is one surface of either part.
3. `mating.analytic` and `mating.one_sided` say which surfaces could lie on each other by their axes, radii and gaps
   alone: a `Mate`. `mating.charts` unrolls what both stand for into a plane, where `mating.overlay` cuts the facets of
   either side with each other: areas that both cover, gathered by `mating.cells`.
4. `search.narrow_phase` asks the meshes if facets of both really are there, face each other and have nothing between.
   What holds is a `Patch` (`mating.patches`): points with normals out of the first part, gaps and areas.
5. Surfaces without a chart are compared by their facets (`mating.freeform`), threads by their profiles
   (`mating.threads`). Where parts share no surface, `higher` looks for points and lines: balls, rollers and rings
   (`rounds`, `tapers`, `rings`), edges on planes (`edges`), sharp rims on balls, cones, bores and rings (`rims`), cams
   and teeth by their outlines (`profiles`); beside shared surfaces, only rims that stand all round in a seat, points
   and lines that hold what these leave in both senses, as a cross pin in its slot (`beside_patches`), and lines of
   rollers on their races beside the flanges at their ends (`rollers`). Where nothing of all this is there and the
   meshes come as near as parts that touch do, the place is a patch of a contact that is not known (`higher.unknown`).
6. `overlap` measures how solids go into each other, deeper than chord errors and mates explain: `boundaries` says
   whether they cross, `shrunk` that they share nothing all the same, `solids` cuts, `interference` measures,
   `coarse_facets` says whether the facets about a piece explain it. `fastening` reads the patches for hints that parts
   are one body, which nobody has to believe.

Of parts whose boxes meet, most do not touch: `search.apart` says so of many pairs at once before 5 is begun, of those
that have no mates.

An example, `fixtures/pairs/cylindrical_gap_015`: a shaft of 10 mm radius in a bore of 10.15 mm. Their boxes meet; the
tolerance is 0.5 mm. The mate of the shaft's cylinder (124 facets) with the bore's has a gap of 0.15 mm, three times
the chord errors, within its limit of 0.51 mm. Unrolled about the mean of both axes, the facets of both sides cover
1,899 mm², in bins of at most an arc of 15°, with the rim as points of its own: 146 points. A probe a bin finds facets
on both sides, and the patch is a `cylinder` with 0.15 mm of `clearance`.

Sub-packages; each imports only those above it:

- `search`: pairs of parts, and places on them, that are near each other
- `mating`: surfaces that lie on each other
- `higher`: contact at points and along lines
- `overlap`: solids that share a volume
- `fastening`: suggestions of what is fastened
"""

from __future__ import annotations

from kinform.contacts.find import find

__all__ = ["CODE_VERSION", "find"]

CODE_VERSION: int = 37
"""Raised when the same input would give other contacts."""
