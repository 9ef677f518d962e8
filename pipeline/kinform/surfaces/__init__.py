"""Facets → analytic surfaces: planes, cylinders, cones, spheres, tori, revolutions, extrusions, helicoids, freeform.

How a surface is recovered
--------------------------
A mesh file has lost what its designer drew: a bore has become 32 strips, each cut into triangles. Contacts and joints
need the bore back, with its axis, its radius, and how well both are known. What is left of it are the vertices. A
tessellator puts them on the true surface; facets are chords of it, and their normals and areas are those of a prism.
So facets only guide the search, and vertices decide: a surface is fitted to vertices, and a polygon belongs to it where
its vertices lie on it. Surfaces fitted to facet normals would be prisms, and a 24-gon in a 32-gon, a shaft in its bore,
would slide and not turn.

The steps, in the order of `recovery.recover`, which calls them:

1. Unit coordinates: the mesh is centred and divided by its span, the greatest distance of two of its points; its
   vertices and facets are sorted. Neither size, place, nor the order in the file changes what comes out.
2. Facets and edges (`polygons.facets`): normals, areas, altitudes, and which two facets meet where.
3. Noise (`polygons.noise`): vertices stored in single precision, or scanned, are off their surface. Where edges that
   should be flat bend both ways around every vertex, vertices scatter, and their standard deviation σ is read. All
   later tolerances come of it: `Scale.noise` (4 σ) and `Scale.fit` (5 σ); without scatter 2e-6 and 2e-5 spans.
4. Polygons (`polygons.coplanar`, `polygons.patchwork`): how a flat face is cut into triangles says nothing, so facets
   that are coplanar as far as the noise lets one tell become one polygon. Slivers, whose normals mean nothing, join the
   polygon across their longest edge. Edges between polygons are smooth below 32°, and convex, concave or flat.
5. Curvature (`polygons.curvature`): each edge turns by θ over its length l. Spread over the area about it, θ l t tᵀ is
   the curvature tensor (normal cycles, Cohen-Steiner and Morvan 2003). Its ratio says which kinds are worth trying, its
   direction which neighbours continue each other.
6. Whole pieces (`regions.partition`, `regions.growth.whole`): polygons that continue each other are tried as one
   surface at once, because most of them are. Kinds are tried from the simplest to the most complex, only those that
   bend as the piece does: cylinder, cone, sphere, torus (`kinds`, one file each). A kind proposes parameters in closed
   form, refines them by least squares over the vertices that define it, and has to be credible: a few flats lie on
   some cylinder too. What conforms beside a piece is absorbed. Tori that bend little along their tube, as races do, are
   tried first: each row of their facets is a cylinder or a cone as well.
7. Seeds (`regions.growth.pursue`): where tangent surfaces run together no piece is one surface. Single edges then
   suggest surfaces, whose regions grow layer by layer over smooth edges (`regions.territory`). Fits alternate with
   growth, so that a fit over few polygons only has to predict twice as many. Cylinders and cones grow in the same
   rounds (`kinds.mixed`). The largest regions win. What seems to bend both ways only because a neighbour leans away as
   little as its own facets do (a chamfer of 30°) is tried last, as cylinder and cone.
   Agreement is no evidence where it could not fail. Two rings about one axis lie on a sphere, so the vertices of a
   sphere have to lie on no second quadric (`kinds.quadrics`); a torus needs five rings; strips between two meridians
   of a barrel lie on a circle, but their edges go on round the barrel (`regions.across`). A facet of a cylinder or a
   cone that was cut off has a generator in its plane still; a chamfer, however little it leans, has not.
8. Which vertices define a surface: those where three of its polygons meet, and ends of ridges along its generators. A
   vertex between two of its polygons and a foreign one may be a cut through a chord (a keyway in a shaft), and counts
   only where it lies on the surface.
9. Merging (`regions.merge`): two halves of a bore, faces parted by a slot. Regions of one kind and side whose vertices
   lie on one surface, fitted to all of them, are one surface.
10. What is left: threads by the helices that are their edges (`swept.threads`), planes, then patches that slide on
    themselves in one way, which are revolutions, extrusions and helicoids (`slippage`, `swept.sliding`; Pottmann and
    Randrup 1998, Gelfand and Guibas 2004). A patch that does not is freeform: it has facets, an area and a chord, and
    neither axis nor point. So are pieces too small to tell.
11. Uncertainty (`describe`): the covariance of the last least squares, with the scatter of the vertices about the
    surface, though at least that of their rounding, times three. It becomes that of joints, and decides what is
    parallel, coaxial or in doubt. `chord` is how far facets stand off the surface: the most that contacts between
    facets may differ from contacts between surfaces.

Meshes are recovered in packs (`recovery.packs`): steps 5 to 9 are done for all meshes of a pack at once, because most
of the time of small meshes goes into beginning steps. Each mesh has its own lengths (`Scales`) and its own ends of
iterations, so that it has to the last bit the surfaces that it has alone.

Equal parts are recovered once: `copies` finds meshes that are one shape in several poses (Kabsch 1976).

An example
----------
A plate of 60 × 40 × 10 mm with a bore of 32 strips and 8 mm radius, 10 mm off its middle, as a binary STL file has it:
144 facets, 72 vertices, span 72.80 mm.

- Noise: single precision rounds by 4.9e-8 spans (3.6 nm). No scatter: `noise` is 0.146 µm, `fit` 1.46 µm.
- Polygons: 38, the six sides of the plate (top and bottom of 36 facets each) and 32 strips of two facets. 32 of the 108
  edges are smooth, all concave, at 11.25°.
- Curvature of every strip: −125.2 and 0 per metre, the first across the generators; −1 / 8 mm is −125.0.
- One piece of 32 polygons, concave, ratio 0. The cylinder explains it whole, so no other kind is tried: 32 generators,
  64 defining vertices, none of them more than 0.75 nm off.
- The result: radius 8.000000 mm, side −1, axis (0, 0, 1) known to 0.11 µrad, point (10, 0, 0) mm to 1.1 nm, sweep 2π,
  and a chord of 38.5 µm, which is 8 mm · (1 − cos(180° / 32)). The planes of the strips are 7.9615 mm from the axis:
  what a fit to facets would call the radius.
- The same plate with vertices that scatter by 10 µm in each coordinate: σ is read as 8.2 µm, so `fit` is 41 µm. There
  are 38 polygons again and one cylinder: radius 8.0015 mm, its point off by 1.5 µm (stated: 5.1 µm), its axis by 0.46
  mrad (stated: 1.01 mrad).

Sub-packages; each imports only those above it:

- `polygons`: coplanar facets, noise, curvature
- `kinds`: one kind of surface a file
- `regions`: which polygons are one surface
- `swept`: threads, revolutions, extrusions
"""

from kinform.surfaces.copies import rigid_copies, surfaces_of_copy
from kinform.surfaces.recovery import packs, recover, recover_all

__all__ = ["CODE_VERSION", "packs", "recover", "recover_all", "rigid_copies", "surfaces_of_copy"]

CODE_VERSION: int = 20
"""Bumped when results change."""
