"""The numbers that decide how surfaces are recovered, by the module that uses them.

Lengths are shares of the mesh's span, angles radians. What users may set is in `Tolerances`. Where no measurement
is named, a number is a choice: the meshes of the fixtures and of real robots give the same surfaces well around it.
"""

from __future__ import annotations

import numpy as np

# ---- several modules

EPS32: float = float(np.finfo(np.float32).eps)
"""Relative rounding of single precision, in which STL files store coordinates."""

COVERAGE = 3.0
"""Stated uncertainties are this many standard deviations."""

SAGITTA = 4
"""Fits by which the middle of a round face stands off the chord of its ends, at least: less is as well a flat."""

LEAST_POINTS = 6
"""Vertices that suggest a circle, sphere or cone, at least: twice what determines a circle."""

LARGEST = 10.0
"""Radius, in spans, beyond which a cylinder or cone is none that a joint could use."""

FACET_ROUNDING = 1e-3
"""Angle that is added to the greatest that a facet may subtend: what rounding makes of equal facets."""

PLAINLY = 1e-9
"""Share by which a sum is beyond doubt, in whatever order it was made."""

# ---- polygons.noise

FITS_PER_NOISE = 10
"""The tolerance of fits in noises that are expected of vertices, and the noise as such a part of the tolerance."""

NOISE_ROUNDINGS = 1.5
"""Noise in roundings of the largest coordinate: a vertex is off by half of one in each of three directions."""

SCATTER_SHOWS = 2
"""Vertices scatter where twice the standard deviation that is read exceeds the expected noise."""

NOISE_SIGMAS = 4
"""Standard deviations of scattered vertices that are noise: one vertex in 16,000 is beyond."""

FIT_SIGMAS = 5
"""Standard deviations of scattered vertices that a fit allows."""

CALM_SHARE = 0.25
"""Share of the area, from the calmest vertices up, at which the scatter is read: saddles are rarely more
than the rest."""

CALM_SHARE_OF_RIPPLE = 0.1
"""The same for the difference from the neighbours, which is smaller on saddles too."""

RIPPLE = 0.05
"""Where scattered vertices differ from their neighbours by this much of what they show, saddles do by less
(0.12 to 0.4 against 0.01 to 0.02 where tried)."""

MIXED_PER_SIGMA = 1.2
"""What is read there, in standard deviations of one coordinate (tried on noisy copies of robots' parts)."""

LEAST_EDGES = 4
"""Edges that show something at a vertex, at least, so that it can mix signs."""

LEAST_SPOKES = 3
"""Edges that end at a vertex, at least, so that it has neighbours to differ from."""

REPEATED = 1e-2
"""Relative difference of what neighbours show that is no accident in a long row of them."""

REPEATED_ROW = 12
"""Vertices in a row that is long."""

RUN_OF_EDGES = 1 << 14
"""Edges that are worked on at a time, so that what is computed of them stays in the processor's cache. It changes no
bit."""

# ---- polygons.coplanar

THIN_NOISES = 2
"""Facets of less altitude than this many noises have meaningless normals; polygons that are less flat are cut."""

COPLANAR_ANGLE = 0.06
"""Angle up to which facets that differ in height by no more than the noise are coplanar."""

COPLANAR_SIGMAS = 3
"""Standard deviations by which the four vertices of an edge in a plane may leave one."""

COPLANAR_ROUNDINGS = 0.75
"""The same for vertices that are only rounded, in roundings: half of one in each direction, √3 times."""

TURNED_SIGMAS = 4
"""Standard deviations, over the altitudes of two facets, by which scatter may turn their normals."""

MOST_TURNED = 0.5
"""Angle beyond which facets are never coplanar, whatever the scatter."""

SLIVER_PASSES = 8
"""Passes in which slivers join their neighbours: a fan of slivers halves in each."""

JOININGS = 2
"""Passes in which polygons that are coplanar by their means are joined."""

PEELS = 60
"""Planes taken off a cluster before the rest of it falls into its facets."""

PEELS_SEEN = 8
"""Planes of a cluster after which it is asked whether planes make it up."""

PEELED = 0.1
"""Share of a cluster that the rest of the planes would take if all were as large as the largest of those, at least:
what is less is curved."""

PEEL_STEPS = 3
"""Fits of each plane: to the facet, then to what lies in its plane."""

FACING = 0.5
"""Cosine of the angle between a facet and the plane that it is taken off with, at least."""

OUTWARD = 0.99
"""Cosine between the plane through the vertices and the mean normal of the facets, below which the vertices (of a
sliver) determine no plane."""

# ---- polygons.patchwork

SLACK_ROUNDINGS = 2
"""Roundings, over the altitude, by which the normal of a polygon may be turned."""

MOST_SLACK = 0.3
"""Angle by which rounding may turn a normal, at most."""

FLAT_NOISES = 2
"""Height, in noises, that a polygon gains over its neighbour below which their edge is neither convex nor concave."""

# ---- polygons.curvature

ALIKE_WIDTHS = 3.0
"""Ratio of widths up to which neighbours look like facets of one surface."""

ALIKE_STRONG = 0.35
"""Difference of the larger principal curvatures of neighbours on one surface, as a share of the largest: what coarse
facets of unequal width make of equal ones."""

ALIKE_WEAK = 0.3
"""The same of the smaller principal curvatures."""

SIMPLE_RATIO = 0.12
"""Ratio of the two curvatures below which a polygon bends one way only."""

GOING_ALONG = 0.7
"""Cosine between a step to the neighbour and the generators, above which it goes along them."""

TURNED_ALONG = 0.03
"""Angle between the generators of neighbours on one surface that bends one way, besides that of their normals."""

# ---- kinds.kind

RUN_OF_PAIRS = 1 << 13
"""Pairs of region and polygon that are worked on at a time, so that what is computed of their corners stays in the
processor's cache."""

CONVERGED = 1e-13
"""Change of the parameters (rad, spans) at which a fit stands still."""

KEPT_FITS = 3.0
"""Tolerances within which the vertices of a surface lie, by their root mean square, that is kept where a step of its
fit leads away: where they would be off by more than the tolerance, and KEPT_RISE times as much as before."""

KEPT_RISE = 2.0
"""Least squares that converge bring vertices nearer; rounding alone does not double what they are off."""

LEAP = 1e-3
"""Change of the parameters (rad, spans) by a last step after which the vertices are looked at again: a fit that
closes in on its end moves by a thousandth of that."""

DAMPING = 1e-11
"""Share of the scaled diagonal that is added to normal equations: nothing to a regular fit, a bound for a vague one."""

NEAR = 4
"""Tolerances within which shared vertices of spheres and tori define them: beyond, they lie on chords."""

TILT_LIMIT = 0.3
"""Greatest change of an angle in one step of a fit, so that it does not leap over to another surface."""

LEAST_RADIUS = 1e-9
"""Least radius that a fit may reach."""

# ---- kinds.axial

ON_AXIS = 1e-3
"""Distance from the axis, in radii, within which a corner has no azimuth."""

# ---- kinds.ruled

ALONG: float = float(np.cos(np.radians(10.0)))
"""Cosine of the angle between an edge and a generator, above which it is one."""

BOW = 1e-5
"""Depth (spans) to which a generator that leans may dip below the surface: the ends of slanted ridges lie on it,
but a cut between them does not."""

ROWS = 2**15
"""Rows that are computed at a time where each is for itself: 2 MB of eight columns. It bounds memory and changes no
bit."""

APEX = 0.05
"""Distance from the axis, in radii, within which a vertex of a cone is its apex."""

SECOND_STRIP = 0.4
"""A strip counts as like the widest when it subtends at least this share of its angle."""

RING_APART = 0.2
"""Share of the angle of a typical facet by which generators, and rings of a torus, differ that are not the same."""

SHIFT_LIMIT = 1e-6
"""Shift in one step of a fit that is allowed besides the radius."""

STEEPEST_CONE = 1.567
"""Half-angle that a cone has at most: 0.2° short of a plane."""

# ---- kinds.cylinder, kinds.cone

RIDGES_AGREE = 0.98
"""Share of the squared lengths of inner edges along one direction, above which they are the ridges of a cylinder."""

EQUAL_STEPS = 1.02
"""Ratio of the angles of strips and ridges up to which their steps are equal."""

CIRCLE_OF_NORMALS = 1e-2
"""Variance of the normals along the axis, as a share of the next, below which they lie on the circle of a cone."""

LEAST_TAPER = 2
"""Fits by which the ends of a cone differ in radius, at least: less is a cylinder."""

# ---- kinds.sphere, kinds.torus

LARGEST_SPHERE = 5.0
"""Radius, in spans, beyond which a face is no sphere that a joint could use."""

SECOND_QUADRIC = 0.5
"""Fits by which the vertices of a sphere are off every other quadric in the mean, at least: two rings lie on one to
the last digits, to a fifth of a fit where vertices scatter; three rings of a cap whose sagitta is just enough are half
a fit off."""

ONE_PLANE = 1e-4
"""Variance of vertices across their plane, as a share of that along it, below which they are one ring: any sphere about
its axis goes through it."""

LARGEST_TORUS = 5.0
"""The same for both radii of a torus."""

LEAST_TURNING = 0.05
"""Share of turning in the motion of a torus (patch of radius 1), at least."""

TORUS_PITCH = 0.05
"""Advance of that motion, per arm and one, below which it is a turn."""

LEAST_PROFILE = 9
"""Vertices of a profile that suggest its circle, at least."""

RINGS = 5
"""Rings of vertices that a profile has at least: three lie on a circle anyway, and four that are symmetric."""

STEPS = 3
"""Places around the axis that a torus is known at, at least."""

STEP_APART = 0.3
"""Share of what tells rings apart that tells places around the axis apart, where facets are narrower."""

LEAST_MAJOR = 0.02
"""Radius of the circle in the tube's middle, in radii of the tube, at least: less is a sphere."""

LEAST_MAJOR_FITS = 10
"""The same in fits."""

# ---- regions.candidates

WIDEST = 1.2
"""Greatest angle that a facet may subtend (rad)."""

WIDER = 1.6
"""A polygon this much wider than the next narrower one of a region is a flat on it, not a facet of it."""

TYPICAL_WIDTH = 0.75
"""Share of a region's polygons that are narrower than a typical one: cuts leave narrow pieces of facets."""

NORMAL_SLACK = 5e-3
"""Angle by which a facet's normal may differ from the surface's, besides half of its width."""

# ---- regions.growth

LOOSE = 2.5
"""Fits within which a first guess is held to its region."""

MAJORITY = 0.6
"""Share of a piece that must conform at the first look."""

FIRST_LAYERS = 2
"""Layers of polygons that a region gains in its first round, and twice as many in each."""

MOST_LAYERS = 512
"""Layers that it gains in a round at most."""

LAYERS_OF_WHOLE = 64
"""Layers of polygons beside a piece that is whole already."""

ABSORPTIONS = 6
"""Rounds in which whole pieces grow."""

STAGES = 14
"""Rounds in which seeds grow: with doubled layers enough for 4,000 facets in a row."""

PERIODS = (2, 3)
"""Rounds after which regions are what they were, where they gain and lose the same polygons without end."""

STEADY = 1e-8
"""Change of such a region's parameters over a period (rad, spans), at most: a two hundredth of the least noise."""

UNSHARED = 0.4
"""Share of a region's polygons that belong to no larger one, above which it stays."""

TOLERANCE_MEDIANS = 6
"""Tolerance of a region in middle distances of its vertices: four standard deviations."""

# ---- regions.partition

ROUNDS = 8
"""Rounds of searching from seeds, at most."""

LAST_ROUNDS = 2
"""Rounds of searching among what may be generators, without regard to how it bends, at least: the longest come first,
and hide those beside them until the second. More follow as long as they find what is worth it."""

MOST_LINKS = 32
"""Smooth edges of a polygon between two generators, at most."""

LEAST_TURNING_POLYGONS = 3
"""Polygons of a piece beside edges that turn one way, at least."""

LEAST_BLEND = 8
"""Polygons of a piece that may bend both ways."""

EXPLAINED = 0.98
"""Share of a piece that one kind explains, above which the others are not tried."""

FRESH = 0.9
"""Share of a region that no larger one has taken, at least."""

STRAIGHT = {"cylinder": 0.985, "cone": 0.85, "sphere": 0.0}
"""Cosine between a seed and the edges across which its surroundings lie, at least, for each kind."""

BEND_SLACK = 0.2
"""What the ratio of curvatures at a seed may be beyond the range of a kind."""

WORTH = 2e-3
"""Share of the mesh's area that a round of searching must explain for another one to follow."""

GRAIN = 1e-4
"""Share of the mesh's area that the two polygons at a seed have at least: finer detail that is no piece of its
own stays freeform."""

BROAD = 2e-2
"""Share of the mesh's area above which a polygon is a plane of its own, whatever is beside it."""

DOMINANT = 3
"""Areas of its mean neighbour above which a polygon is a plane of its own."""

LEAST_FREEFORM = 4
"""Polygons that hang together in a freeform patch, at least: fewer are planes."""

# ---- regions.chords

CHORD_FITS = (10.0, 100.0)
"""Fits, in multiples, to which closed rounds of strips are held once nothing else explains them. A shaft of 9 mm in a
decimated mesh of 78 mm has vertices 2 µm off its mean radius, where a fit is 1.6 µm."""

LEAST_CHORDS = 8
"""Polygons of such a round, at least."""

ROUND_CHORDS: float = float(np.radians(170.0))
"""Angle about its axis that it covers at least: arcs of less are flanks of teeth as well."""

TURNED_CHORDS: float = (ROUND_CHORDS - WIDEST) / 2
"""Angle to the middle normal of a piece that one of its normals makes at least where a round is in it: they are those
of the middles of strips, the outermost of which are no wider than WIDEST."""

ON_CHORD = 1.0
"""Chord errors of its middle facet by which its vertices are off, at most."""

# ---- regions.merge

PARALLEL_PLANES = 5e-3
"""Distance in normal (rad) and offset (spans) of planes that may be one."""

MERGED_SHAPE = 2e-3
"""Difference of radii (spans) and half-angles (rad) of surfaces that may be one."""

MERGED_SHAPE_FITS = 10
"""The same in fits, where that is more."""

MERGING_FITS = 20
"""Fits within which the vertices of the smaller surface lie on the larger, before both are fitted as one."""

MERGED_REACH = 1.05
"""Angle of the widest facet of merged surfaces that one may have, as a multiple."""

PARTNERS = 2
"""Larger surfaces, the nearest ones, that each is tried to be a piece of."""

SAMPLES = 24
"""Vertices of the smaller surface that are held against the larger before all of them are."""

# ---- describe

ROUNDED_SCATTER = 0.3
"""Least scatter of the vertices of a curved surface, in roundings: rounding to a step of one scatters by 1/√12."""

ROUNDED_SCATTER_OF_PLANES = 0.6
"""The same for planes, which are stated twice as carefully."""

LEAST_SPREAD = 1e-12
"""Extent of a plane across its longest direction, at least, for its uncertainty."""

SINGULAR = 1e-14
"""Ratio of eigenvalues below which a direction of the parameters is undetermined."""

FULL_TURN = 1e-6
"""Angle by which a sweep may miss a whole turn that is one."""

# ---- recovery, swept.threads

PACK = 200_000
"""Facets of meshes that are recovered at once, at most. A step of numpy takes as long to begin as for a few hundred
rows: so100 (60,000 facets in 13 meshes) takes 1.0 s of processor in one pack and 2.0 s mesh by mesh; packs of 400,000
gain 7 % over packs of 100,000, those of 200,000 5 %, for 140 and 60 MB more."""

LITTLE = 10_000
"""Facets in all that are recovered in one pack, however many processors there are: less than half a second of work."""

THREAD_FACET = 2e-2
"""Share of the area below which a plane may be a facet of a thread."""

THREAD_POLYGONS = 24
"""Polygons of a thread, at least."""

MOST_LINES = 6
"""Axes tried, the best supported first."""

MOST_PIECES = 4
"""Pieces of what no surface explains that suggest an axis."""

PIECE_TURNS = 0.1
"""Share of turning in the motion of such a piece (radius 1), at least."""

REWEIGHINGS = 6
"""Rounds of reweighing, until what is no thread counts little."""

SAME_LINE = 1e-3
"""Lines (rad, and of the mesh's span) that are one axis."""

LEVEL = 2e-3
"""Share of its length by which an edge along a helix may change its distance from the axis."""

LEVEL_NOISES = 4
"""The same in noises, for short edges."""

WIDE = (8.0, 4.0, 2.0, 1.0, 1.0)
"""How much wider helices are looked for while axis and advance are refined."""

HELIX_STEP = 0.85
"""rad: greatest angle of an edge about the axis: a thread has eight vertices a turn, at least."""

ARC = 1.1
"""Length of such an edge along its helix, in its own lengths, at most: 1.031, with room."""

LEAST_ARC = 0.05
"""Arc of an edge along a helix, in rises, at least."""

STEEP = (2e-3, 4.0)
"""Range of the advance a radian, in radii, of what is a thread."""

ADVANCE_NOISES = 3
"""Noises, over its angle, by which the advance of an edge is uncertain."""

ADVANCE_SHOWS = 0.3
"""Uncertainty of the advance of an edge, as a share of it, with which it suggests one, at most."""

MOST_ADVANCES = 4
"""Advances tried about one axis."""

ALIKE_ADVANCE = 5e-3
"""Relative spread of the advance along edges of one thread, besides what rounding makes of each."""

ADVANCE_STEP = 0.1
"""Relative change of the advance in one step of a fit, beyond which it is another thread."""

TURNED = 0.7
"""Turns of helix, counted along all polylines of a thread, at least."""

LONGEST = 0.4
"""Turns of the longest of them, at least."""

SHORTEST = 0.02
"""Turns of the shortest polyline that counts, in those of the longest."""

HELIX_SIGMAS = 3
"""Standard deviations up to which residuals of a helix count fully."""

HELIX_MEDIANS = 1.5
"""A standard deviation in median sizes of a normal distribution."""

VAGUE_HELIX = 1e-12
"""Ratio of eigenvalues below which axis and advance of a thread are undetermined."""

TILT = 0.12
"""Root mean square of the normals' share of the screw's speed, of facets that belong to a thread."""

TILTS = 3
"""The same of a single facet that may be one of them, in multiples."""

LOPSIDED = 0.6
"""The same of a single facet between two helices: skew triangles lean far to either side in turn."""

LEAN = 0.3
"""Mean of that, as a share of the slope of the helix: beyond, the facets are as well a ring, or a helix of another
pitch."""

TOUCHING = 3
"""Corners of a piece of flank on helices, at least."""

BENT = 1.0
"""rad: facets of one flank make no greater angle."""

# ---- regions.across

TURNS_ON = (0.03, 0.56)
"""Angle by which a ridge turns where it goes on round an axis: more than lines of one direction differ, and no more
than a smooth edge."""

GOES_ON = 2.05
"""Ratio of lengths up to which the next edge goes on with a ridge: a fillet is longer than the edges of its corners."""

OPEN = 3.1
"""Angle that strips subtend together, at most, that may run across bands round another axis."""

# ---- swept.sliding

SLIDING_POLYGONS = 12
"""Polygons that show a motion, at least."""

STILL = 6e-3
"""Root mean square of the normals' share of the motion's speed (patch of radius 1) below which it slides."""

ACROSS = 0.1
"""Spread of the normals of an extrusion about its direction, at least: less is flat."""

UNIQUE = 5.0
"""Ratio to the next motion, at least: what slides in two ways nearly is too flat to tell."""

TURNS = 0.15
"""Share of turning in a motion (patch of radius 1) above which it is a turn."""

BOXES_AGREE = 0.6
"""Share of their common box, along each axis, that two patches of one thread share."""

SCREW_ADVANCE = 0.01
"""Advance a radian, in radii of the patch about the axis, below which a turn is no screw."""

# ---- copies

COPY_ROUNDINGS = 2
"""Roundings of the largest coordinate by which a vertex of a copy may be off."""

COPY_SIZE_ROUNDINGS = 4
"""Roundings by which the size of a copy may be, with room for the rounding of sums."""

MIRRORED = 1e-9
"""Spread across a flat mesh, as a share of its length, below which it is its own mirror image."""
