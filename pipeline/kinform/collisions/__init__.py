"""What motions run into: the range of joints, collisions along a run. By FCL on the meshes.

Three questions are asked from outside, each in a module of its own: `joint_ranges`, how far each joint goes;
`ways_out`, whether parts leave along a straight line; and `run_collisions`, what parts meet along a run that was
computed, whose bodies `between_outputs` takes on between its outputs; where very many meet, the earliest of them
(`first_crossings`). All come down to one: where on its course relative to another does a part first meet it (`pair`)?
Read the sub-packages in this order:

1. `parts`: what is asked of one part. `slippage` says which of its surfaces a motion maps onto themselves; their facets
   are left out, so that journals, guides and threads need not be told from collisions by any depth.
   `coarse_meshes` gives it fewer facets, for how far away it is; `probes` are points on it, which may come to be inside
   of others.
2. `pair`: a `Course` is how one part moves relative to another. `distance_bounds` goes along it in steps as long as the
   parts are apart. `advancement` then halves what is left of it with the facets that count (`prepared_pair`) until it
   has the first crossing that no mate explains (`facet_crossings`, `mate_surfaces`) and that is too deep
   (`penetration`), or a point that came to be deep inside (`deep_entry`): of a turn or a slide it is told once where
   points pass through facets (`passages`). Either is followed back to where it began (`onsets`). What crosses is told
   of several places at once where parts go on touching (`states`). `posed_pairs` makes courses of poses of bodies.
3. `driving`: `alone` drives a joint that no loop closes over. Of pairs that come near each other (`candidates`), the
   one free for the shortest way goes on first. What points keep as they turn or slide tells which of its facets
   can meet (`swept_profiles`), and where (`meeting_spans`, `swept_spheres`): only there the course is followed, and of
   parts that mate with those facets alone that can meet there other than along mates.
   `loops` drives all joints of a block along its one motion (`loop_motion`); of parts that only turn or slide on
   each other, with those of their facets that can meet (`apart_for_good`).

Less deep than mates may overlap it is a scrape, and none of this counts.

Sub-packages; each imports only those above it:

- `parts`: one part: its shape, its probes, the motions that map it onto itself
- `pair`: two parts on a course: when they first touch, and how deep
- `driving`: joints driven until something stops them
"""

from __future__ import annotations

from kinform.collisions.joint_ranges import ranges, too_large
from kinform.collisions.run_collisions import along

__all__ = ["CODE_VERSION", "along", "ranges", "too_large"]

CODE_VERSION: int = 28
"""Raised when the same input would give other ranges or collisions."""
