"""The numbers that decide about contacts, by the module that uses them first.

Lengths are shares of the contact tolerance, which scales with the parts, unless a unit is stated. Where neither a
reason nor a measurement is named the number is a choice.
"""

from __future__ import annotations

import math

import numpy as np

# search: which parts and surfaces come near each other

MATING_REACH = 1.02
"""Limits reach this much beyond the contact tolerance: designers put clearances of exactly 0.5 mm, and
rounding must not decide whether those are contacts."""
CLEARANCE_SHARE = 0.03
"""Share of its radius that a shaft may be smaller than its bore, where that is more than the contact tolerance."""
FACE_SHARE = 0.5
"""Share of the smaller extent of two faces beyond which a gap between them is none of contact."""
HALF_RADIUS_SHARE = 3.0
"""A radial gap of the radius divided by this is no fit."""
FEW_BESIDE = 1000
"""Facets in the common box of two parts up to which all are taken for near: to look closer takes as long as FCL's model
of the rest."""
MOST_SURFACES = 3000
"""Surfaces of one part that a pair looks at: a bound of memory for crumpled meshes."""
OVERLAPS_KEPT = 200_000
"""Surfaces times surfaces of a pair up to which it is kept which come near each other: 0.2 MB."""
FACING_LEAST = 0.5
"""Least cosine between a probe and the facet that it has to meet."""
BETWEEN_MARGIN = 0.01
"""What lies this close to one of the two facets that a probe meets is not between them."""
BETWEEN_SHARE = 0.05
"""The same as a share of the distance of the two facets."""
PROBE_SPARE = 0.05
"""By so much further than a facet is expected at most it is looked for."""

APART_FACETS = 10_000
"""Facets of a part up to which it is asked whether it keeps apart from another: no chain of facets of one plane makes a
turn of so few."""
TOUCHING_WITHIN = 0.6
"""Facets on both sides of a point in which parts touch are within this of each other, and what they stand off their
surfaces: `CAPTIVE`, and thrice `PROBE_SPARE`."""

# mating/charts, overlay: surfaces drawn in a plane, and what both parts cover of them

CHART_ARC = math.radians(15.0)
"""rad: angle that one sample of a curved surface may stand for."""
CHART_FAR = 1e3
"""Radii to which charts of cylinders and cones reach."""
HINT_LEAST = 1e-6
"""Share of a hint across an axis below which it says nothing."""
POLE_SEEN = -0.97
"""Least cosine from the pole of what Lambert's projection shows: beyond, facets would be torn apart."""
SEEN_FROM_AXIS = 1e-3
"""Share of the radius nearer than which to the axis or centre a point gives no direction to look in."""
PATCH_BINS = 24
"""Least number of bins of a patch, so that a blocked part of it can be told."""
PATCH_RIM_POINTS = 96
"""Greatest number of points that stand for the rim."""
REGION_THIN = 0.01
"""Regions thinner than this are lines, not patches."""
REGION_SIMPLE = REGION_THIN * 0.1
"""Corners of a region that are off by less than this are left out."""
REGION_SMALL = 0.02
"""Regions smaller than this share of the squared tolerance are points, not patches."""
MANY_TRIANGLES = 64
"""Triangles of which the outline is quicker to unite than all of them."""
POINT_SAME = 1e-6
"""Points of a region closer than this are one."""

# mating/mate, analytic: two analytic surfaces of one kind

MATING_TILT = math.radians(5.0)
"""rad: no clearance excuses a greater angle between two mating axes."""
TILT_LIKELY = 1.5
"""Angles of axes up to this many times that are looked at."""
MATING_OFFSET = 0.5
"""By so much axes or centres of surfaces that mate may miss each other beyond the clearance."""
LENS_WIDTH = 0.7
"""Mean width of a lens between an arc and its chord, over the greatest (2/3), rounded up: polygons with
different corners on one circle overlap in such lenses."""

NARROW_SHARE = 5e-4
"""Share of the contact of a pair below which overlaps narrower than such lenses say nothing: corners cross by chance.
Of 38 kinds of clean random assemblies one was in doubt without this (1e-4); the shoulder that it is for has 3e-2."""

# mating/coarse: rings of flats that may be round

PRISM_SIDES = 6
"""Sides up to which bars and sockets whose flats lie on each other are prisms: hexagon keys and nuts. Nobody
tessellates a cylinder that coarsely, and from 12 sides on strips are found to be round. Chosen on 300 random shafts of
3 to 200 facets in bores of as many (play to 0.2 mm, with and without collars), judged on 300 others: 1 wrong and 108 in
doubt, after 119 wrong and 71 in doubt without rings; the one, an octagon that just cannot turn, is in doubt since."""
TORN_FLATS = 3
"""So many flats of a ring that lie on flats of another part go round it: fewer may be those of a D or a key."""

TANGENT_SHARE = 0.5
"""Share of the gap at the corners of a bore that the gap at its flats has at most, where the bore is taken to be
tessellated by tangents: the chord error is most of it then."""

# mating/enclosing: facets that enclose the other part, and that no patch is of

TOUCHING = ("point", "line")
"""Kinds of higher pairs."""
ROUND_KINDS = ("cylinder", "cone", "sphere", "torus", "revolution", "helicoid")
"""Kinds of patches with an axis or a centre at a place."""
OPPOSED_LEVEL = 0.99999
"""Cosine between opposed planes from which on they are as good as parallel, 0.26°."""
FACING_NEVER = 0.25
"""Cosine between normals of surfaces up to which none of their facets face each other, whose normals scatter: half of
what a probe asks for."""
ENCLOSING_PROBES = 20_000
"""Middles of facets of either part that are looked at, of those that may be near what they face: as good as all. Where
they were 600 of 700, evenly by area, none need have been on a pin, and which were hung on the pose. Contacts of robots
(so100, dog, sigmaban2019) take as long as then."""
ENCLOSING_SAMPLES = 600
"""Of these that face the other part, as many as a patch is made of."""
STRAY_SHARE = 0.02
"""Share of the area of all patches below which facets that do not touch hold nothing on their own: what joints are
derived from leaves as much out."""
FACING_ROUNDED = 1e-9
"""By which the cosine of two facets may be off for rounding."""
MOST_ASKED = 20_000
"""Facets beyond which finding out which probes can hit any of them takes longer than casting all."""
ENCLOSED_HELD = 0.02
"""Singular value below which patches leave a motion that is to be looked at, turn of a unit twist below which it
slides, and speed along its normal, as a share of that of its place, above which a point or a line holds a motion."""
ENCLOSING_SPEED = 0.3
"""Speed along its normal, as a share of that of its place, from which on a facet opposes a motion."""
OPENS_AGAINST = 0.2
"""Speed up to which a facet may be approached by a slide that opens all others, ..."""
OPENS_SHARE = 0.02
"""... and share of the area that may be approached faster."""

# mating/patches: what a patch is

EXACT_GAP = 1e-3
"""A gap below this is none."""
GAP_SCATTER = 0.1
"""Scatter of the measured gap of a face that rests on a plane, and of profiles that lie along each other."""
SCATTER_CHORDS = 0.3
"""The same on curved surfaces, as a share of the chord error, where that is more."""
PATCH_AREA = 4.0
"""Least area, in squared tolerances, of patches that are measured by facets: less is a stray touch of two rounded
edges."""

# mating/one_sided: an analytic surface against facets

ANALYTIC_KINDS = ("plane", "cylinder", "cone", "sphere")
"""Kinds of surfaces that give normals to others."""
GIVER_AREA = 4.0
"""An analytic surface gives normals to others, and a plane to edges, from this area on, in squared tolerances."""
FACING_OPPOSED = -0.93
"""Greatest cosine between the surface's normal and a facet that rests on it."""
CLEARLY = 1e-9
"""Of the coordinates: more than rounding, of facets that are left out as they lie clearly off a surface."""
SURELY_FACING = 1e-6
"""More than rounding, of cosines of facets that are left out as they are clearly turned away."""
PLANES_TILTED = math.radians(3.0)
"""rad: planes that oppose each other within this lie on each other badly; beyond, they meet at an edge."""

# mating/freeform: facets against facets

FREEFORM_KINDS = ("freeform", "torus", "revolution", "extrusion", "helicoid")
"""Kinds whose contacts are found facet by facet."""
TURNING_KINDS = ("torus", "revolution")
"""Of these, those that turn on themselves about an axis."""
FREEFORM_PROBES = 400
"""Greatest number of probes from either side of a pair of surfaces."""
FACETS_FACING = 0.93
"""Facets rest on each other when their normals oppose within about 20°."""
FREEFORM_ANGLE = math.radians(1.0)
"""rad: the direction of a freeform patch is known no better than this."""
ENCLOSING_GAP = 0.95 * math.pi
"""rad: normals about an axis with no wider gap point to all sides."""

# mating/threads

PITCH_SAME = 2e-3
"""Relative difference of two pitches that are meant as one; less where the engagement is long."""
THREAD_AXIS_VAGUE = 0.02
"""rad: what is known no better than this about its axis is no thread that mates."""
THREAD_FACETS = 400
"""Greatest number of facets of either side that give samples."""
PROFILE_SHARES = np.array([1.0, 3.0, 5.0]) / 6.0
"""Where samples lie on the profile of a facet: the middles of its thirds."""
FLANK_NEIGHBOURS = 24
"""Samples of the other side that are held against each."""
FLANK_HELIX_WEIGHT = 0.1
"""Weight of the distance along the helix in looking for these."""
FLANKS_FACING = -0.7
"""Greatest cosine between the normals of two flanks that lie on each other."""
FLANK_GAP = 0.15
"""Greatest gap of two flanks, in pitches: beyond, neither is the other's."""

# higher: points and lines

TOUCH = 0.12
"""Within this a point or a line touches: the band of full weight."""
CAPTIVE = 0.42
"""Within this a pin in a slot, a ball in a groove or a tooth between two that has as much play on either side counts
as held by both."""
NEAREST_SLACK = 1e-6
"""Share of their size by which facets that are as near to a place as the nearest may be farther off: in corners and
along edges there are several."""
ZONE = 0.01
"""Bounds the zone of a point or a line whose area is stated."""
OPPOSITE_COSINE = -0.999
"""Two sides of a slot hold a pin where their normals have at most this cosine."""
STRAIGHT_COSINE = 0.999
"""Normals with at least this cosine are those of one straight line."""
CORNER_COSINE = 0.5
"""Two walls are at a corner for a pin where what they hold has at most this cosine, either way."""
ACROSS_SINE = 1e-3
"""Directions with at most this sine between them are parallel: planes across a line leave it free."""
ROUND_PLACE = 1e-3
"""Share of a part's span by which the axes of its surfaces may lie beside one, all of which it turns about."""
ROUND_REST = 0.02
"""Share of the area of a part that is round all over that may be anything: a mark, a centre, a scrap of a chamfer."""
STRIP_AREA = 0.02
"""Share of the area of a part below which a plane may be a facet of a curve."""
BALL_BORE_SAMPLES = 16
"""Samples around a ball in a bore."""
ROLLER_SAMPLES = 17
"""Samples along a roller on a plane or between two rollers."""
SHORT_PLANE = 0.5
"""Share of the length of a roller below which samples stand only where the plane is under it."""
ROUND_AXIS = 1e-9
"""Share of its radius by which a ball may be off the axis of a cone and be on it; the same of a unit axis."""
LINE_SAMPLES = 9
"""Samples along an edge, and along the line in which outlines meet."""
EDGE_RISE = math.sin(math.radians(3.0))
"""Faces beside an edge rise at least this steeply; flatter ones lie on the plane badly."""
NEARLY = 1.001
"""Share of a limit within which it is looked closer whether it is kept: far more than rounding."""
EDGES_MOST = 64
"""More edges and corners than these on one plane are a rough surface."""
RIM_UNEVEN = 0.02
"""Vertices of a rim are on one circle to within this: a sixth of what touches."""
RIM_EVEN = 0.75
"""Least share of the vertices of a rim that are."""
RIM_SAMPLES = 4
"""Least number of samples along a rim of which not all is there."""
RIM_ENDS = 1e-6
"""rad by which an edge of a rim may be longer, for rounding."""
RIM_TRIED = 96
"""Places round a rim at which it is looked how far the other surface is: it comes near at two places or four."""
RIM_STEPS = 20
"""Steps between two such places to where it comes nearest: the angle is then exact."""

# higher/outlines, profiles: cams, teeth and racks by their smooth outlines

SEGMENT_LONG = 3.0
"""A segment this many times longer than both neighbours is a straight face between curves."""
CURVE_BEND_LEAST = math.radians(3.0)
"""rad: a curve that turns less than this in all is a straight face."""
STRIP_HEIGHT = 0.3
"""A facet is a strip of a doubly curved surface where its neighbour on along the direction is longer than this
share."""
CYLINDER_EXACT = 0.05
"""A cylinder is exact when its fit misses the vertices by less than this share of its chord error."""
DIRECTIONS_TRIED = 6
"""Directions tried, those of the largest faces first."""
DIRECTION_SINE = 1e-3
"""Directions with at most this sine between them are tried once."""
GRAIN = 1e-3
"""Ends of segments within this are one point."""
SHEET_RINGS = 6
"""Rings of facets about the common box of two parts: as many segments settle a spline."""
CURVE_SAMPLES = 6
"""Samples a segment, to find where two curves come close."""
CURVE_CHUNK = 16
"""Samples that follow each other in one box, whose distance says which need to be compared at all."""
CURVES_OPPOSED = -0.9
"""Greatest cosine between the tangents of two curves that touch."""
NEWTON_STEPS = 20
"""Steps of Newton's method to where two curves are parallel."""
CURVE_END_SPARE = math.radians(3.0)
"""rad: a curve may end this much before it is parallel to the other: it goes on where it was cut."""
SLIP_LEAST = 0.1
"""Share of the shortest segment, or of the contact tolerance, by which points that touch may be off each other's
normal."""
ROUNDER = 0.2
"""Curves touch along a line where they part from each other at least at this share of their own curvatures."""
LENGTH_SHARED = 0.1
"""Outlines touch along more than this."""
DISTINCT_DISTANCE = 0.2
"""Lines of contact nearer to each other than this, ..."""
DISTINCT_COSINE = 0.9
"""... with normals of at least this cosine, are one."""
GAP_ROUNDING = 2e-3
"""Lines of contact whose gaps differ by no more than this, or by two chord errors, touch alike."""
SIGMAS = 3.0
"""Standard uncertainties within which lines of action are one."""

# presses: what can be pressed

PRESS_SHARE = 0.03
"""Share of its radius by which a shaft can be larger than its bore, beyond chord errors and uncertainty. A press
stretches the bore by that share: plastics (bushes, rings, printed parts) yield at 2 to 4 %, steel at 0.4 %, and the
heaviest fits of ISO 286 that are pressed, H7/z6, reach 1.07 % at a diameter of 3 mm. Judged on 75 nominal overlaps of
round surfaces of 38 public robots: the 4 within it, bearings in their seats (0.6 %) and a printed holder (3.4 % of a
coarse mesh), are all inside one body; of the 71 beyond it, from 9.6 % on, 61 are screws in pilot holes and rings inside
one body, and 10 are across a joint. No corpus chose the number, and between 3.5 and 9.5 % none would differ."""

# overlap

DEPTH_SAMPLES = 400
"""Points at which the depth of one pair's overlap is measured."""
SURELY_INSIDE = 0.75
"""How often the facets of an open mesh go round a point that counts as inside: of a round gap in them, as wide as it is
deep, less is seen, and what lies nearer to the gap has no depth that is known."""
DEPTH_SAMPLES_LEAST = 16
"""The same of one piece of it, at least."""
BESIDE_DEEPEST = 100
"""Points beside the deepest one that are measured too."""
SURELY_SLIGHT = 1e-6
"""Share of a volume by which it is surely less than another: far more than rounding."""
SLIGHT_MOST = 400_000
"""Points times the facets that bound their piece up to which it is asked which are near each other: 10 MB, and 5 ms."""
SLIGHT_SOME = 8
"""One of so many points is asked about before all are: overlaps that count are deep at most of them."""
SLIGHT_FEW = 16
"""Pieces up to which what is not sure to be slight is measured piece by piece at once: that takes 0.2 ms each beside
what all take together."""
SURELY_EXPLAINED = 0.9
"""Share of the depth that surfaces which mate explain by which facets are moved to see whether all is explained: pieces
of the overlap are then thinner, too, than what their surfaces explain, as no two sides of one are further apart."""
EXACT_OVERLAP = 0.02
"""An overlap below this is none: rounding of coordinates."""
CURVED_FIRST = 20_000
"""Facets of a part up to which those of its round surfaces in contact are asked first whether they cross others."""
CUT_FEW = 1500
"""Facets of either part up to which a cut takes no longer, 2 ms, than it takes to see that none is needed, where round
surfaces touch and one mostly is."""
THINNER = 0.25
"""Share of what counts as an overlap by which a solid is made thinner to see that it shares nothing with another. No
depth is more than that then, and no ball that both share is larger, so that pieces of the overlap are no thicker than
half of what counts: their volume is no more than their area by the radius of that ball."""
BEYOND_FACETS = 2.5
"""Times what a facet stands off by which its surface may go on beside it, as where it ends at another at 22°."""
COARSE_AT_ONCE = 4_000_000
"""Points times facets near all of them of which it is asked at once which are near each other: 0.1 s, 0.1 GB."""
SHELL_TRIED = 16
"""Facets of a shell of which one that is not at the surface of another solid tells whether the shell is in it."""
SHELL_INSET = 0.98
"""Points just inside the corners of a facet are at this share of the way to them from its middle."""
PARTING_STEPS = 60
"""Steps of Frank and Wolfe's method."""
PARTING_LEAST = 0.1
"""Least speed at which parts leave all their plane contacts that counts as leaving them, of 1."""
PARTING_TRIED = 0.9
"""Share of what counts as an overlap by which parts are moved to see whether they are then free."""

# fastening: hints that parts are one body

AXES_PARALLEL = math.radians(0.5)
"""rad: greatest angle between two axes that line up."""
AXES_COAXIAL = 0.2
"""Distance of axes that count as one."""
ROUND_SWEEP = 0.9 * 2 * math.pi
"""rad: least sweep of a hole, and of the edges of a rim."""
HOLE_SINK = 0.6
"""Depth of a chamfer or countersink between a plane and the hole behind it, in radii of the hole."""
SHAFT_COSINE = 0.99
"""Least cosine between a hole and a shaft that stands in it."""
RIM_KINDS = frozenset({"cylinder", "cone", "torus", "revolution"})
"""Surfaces at which a rim ends."""
RIM_SCATTER = 0.01
"""Greatest spread of the distances of a rim's vertices from its axis, of their mean."""
AXIS_AREA = 100.0
"""Least area, in squared contact tolerances, of a contact from which an axis is read."""
PATTERN_ALIKE = 0.02
"""Relative difference of radii and distances within which holes are of one pattern."""
UPRIGHT_COSINE = 0.9999
"""Least cosine of planes that are parallel, and of holes that stand on one."""
WALL_COSINE = 0.02
"""Cosine below which a face is parallel to a direction."""
POCKET_GAP = math.pi - 0.05
"""rad: walls with no wider gap between them leave no way aside."""
# find: pairs side by side

TOGETHER_PAIRS = 64
"""Pairs whose decisions are taken together: numpy takes as long to begin as to go through hundreds of numbers, ..."""
TOGETHER_FACETS = 50_000
"""... as long as no more facets come to those of the first pair: what is known of one takes about half a kilobyte."""
SHARES = 4
"""Shares of the pairs that each process gets at least, one after the other: some take much longer than others."""

LITTLE_PAIRS = 64
"""Pairs, of ..."""
LITTLE_FACETS = 10_000
"""... facets in all, that are looked at in one process: less than half a second of work, and another process costs 0.05
to 0.1 s to start, with what it imports."""
