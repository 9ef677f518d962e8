"""The numbers that decide on the ground floor, by the module that uses them. Where neither a reason nor a measurement
is named the number is a choice."""

from __future__ import annotations

import numpy as np

# algebra/screws

ROUNDINGS = 8.0
"""Roundings of a coordinate in what follows from a few: positions of parts, what is measured on them, and twists."""

# texts

JSON_DEPTH = 32
"""Brackets in each other in a JSON file: those that kinform writes go five deep."""
JSON_DIGITS = 18
"""Digits of a whole number in a JSON file: more is no count."""
JSON_LARGEST = 1e60
"""The largest magnitude of a number in a JSON file: moments of inertia of mountains in g·mm² are smaller, and cubes of
it are still finite."""
JSON_BYTES = 16 << 20
"""Bytes of a JSON file (a lock, a baseline): a hundred thousand entries. Values take 25 times that at worst, 400 MB."""

# meshes/boxes

CHUNK = 48
"""Facets of a chunk."""
OFTEN = 128
"""Questions that are cheaper to answer without chunks than the chunks are to make: they take as long as 100 to 200 of
them, of 20,000 facets and of 400,000."""
CHUNKED_LEAST = 16_000
"""Facets up to which all are asked as quickly as chunks are: 0.02 ms."""
COLUMNS_MOST = 200_000
"""Facets up to which the sides of their boxes are kept by columns as well, of which numpy compares as many in a third
of the time: 10 MB."""
GRID_FINEST = 512
"""Cells along the side of a grid, at most."""
GRID_LISTED = 12
"""Cells of a grid that a facet is listed in on average, at most, ..."""
GRID_LISTED_LEAST = 4096
"""... and these in all, which cost nothing."""
UNLISTED = 32
"""Comparisons of points with boxes, a facet, that cost less than a grid."""
FOLLOWED = 2
"""Such comparisons that a point beside a box along one axis takes to be compared along the other."""
COMPARED_MOST = 8000
"""So many comparisons of points with boxes take no longer than to find out which need not be compared."""
FOLLOWED_AT_ONCE = 500_000
"""Of which so many, and those of one box, are compared at once: 30 MB."""
SIZE_OCTAVES = 20
"""Octaves of size that facets are sorted by."""
PLACE_BITS = 10
"""Bits of a coordinate along the Z-curve that facets are sorted along."""

# meshes/depths

DEPTH_FACETS = 128
"""Facets of a group."""
MODEL_WORTH = 1.0
"""Questions to groups, a facet, that cost as much as a model of all facets: 8 us each, as what it takes a facet."""
DEPTH_PART = 16
"""Facets of a part of a group."""
DEPTH_POINTS = 2048
"""Points that are asked together which facets they are near: 40 MB where 200 parts of groups are about each."""
SLIVER_HEIGHT = 1e-6
"""Share of a facet's longest side: of a lower one the plane may be off by more than 1e-9 of that."""

# meshes/balls

BALL_SHARE = 0.012
"""Share of a mesh's diagonal that balls about its facets are as small as."""
BALL_PARTS = 6
"""Divisions of a facet's side for it at most."""

# meshes/parity

RAYS = np.array([[0.577, 0.523, 0.627], [-0.67, 0.31, 0.675], [0.21, -0.83, 0.517]])
"""(3, 3) directions along which no designer lays an edge."""

# meshes/shells

SAME_ANGLE = 1e-7
"""rad: facets about an edge within this are coincident."""

# meshes/shell_faults

SHELL_PROBES = 32
"""Facets of a shell that are probed, ..."""
PROBE_PARTS = 3
"""... each in the middles of the triangles that it is divided into along each side: finds what is as large as a few
hundredths of a shell."""
SHELL_DEPTH = 1e-3
"""How far from a facet it is probed, in the longest side of the shell's facets: fits are shallower, walls thicker."""
CROSSING_SHARE = 0.02
"""Share of a shell's area that may lie in others: screws in bores that are too narrow do."""

# meshes/box_pairs

BOXES_MATRIX = 600_000
"""Boxes times boxes up to which all are compared, however many of either kind there are."""
SLAB = 600_000
"""Boxes times boxes that are looked at in one slab, of those that can meet at all: as many as are all compared."""
SLABS_MOST = 100
"""Slabs in all: the horns of so101's motors have 30."""
BOXES_COMPARED = 1_500_000
"""The same where there are not very many of either: 1 ms; a grid takes from 0.5 ms to 4."""
BOXES_EXACT = 20_000
"""The same up to which they are compared as they are: steps of a scale take 0.04 ms to be made."""
BOXES_MOST = 50_000
"""Boxes of either kind up to which a grid is made of them."""
BESIDE_MOST = 100_000
"""Pairs in common cells up to which they are compared: a few milliseconds, in which FCL makes a tree of a thousand
facets."""

# meshes/near

LINE = np.array([0.57735, 0.51763, 0.63144, 0.44317])
"""(4,) direction along which no designer lays an edge."""
FEW_PAIRS = 1 << 16
"""Pairs that share a place up to which all of them are measured: in all, ..."""
SHARED_PAIRS = 2
"""... and a point."""
MEASURED = 1 << 21
"""Distances to points of one set that are measured before a tree is made: 0.02 s, a tenth of what importing trees
takes."""
MEASURED_BESIDE = 1 << 17
"""The same where trees are imported already: a few times what making one takes."""

# meshes/probes

SLIVER_WIDTH = 1e-3
"""Width of a sliver relative to its length: zero width misses most facets."""
HITS_A_PROBE = 256
"""Facets that one probe may hit on average."""
STEEP_LEAST = 1e-3
"""Least cosine between a probe and a facet's normal at which the place where they meet is known."""

# meshes/proximity

CELLS_MOST = 48
"""Most cells along the longest side of the common box."""
CELLS_LEAST = 8
"""Least; between them a quarter of the root of the number of boxes is added."""

# meshes/rings: flats about an axis

RING_FEW = 6
"""Up to so many flats a ring is round only where ..."""
RING_EVEN = 0.05
"""... their distances from the axis differ by no more than this share of that of the corners: those of a box do not."""
RING_SIDES = 3
"""Flats of a ring, at least."""
RING_TURN = (np.radians(20.0), np.radians(125.0))
"""rad between two neighbours of a ring: of a triangle they differ by 120°; below 32° strips are found to be round, but
not where three of them are left."""
RING_PARALLEL = np.radians(1.0)
"""rad by which the ridges of one ring differ in direction."""
RING_ASKEW = np.radians(5.0)
"""rad by which the edge of two flats may leave the line in which their planes meet: vertices scatter."""
RING_ROUND = 5e-3
"""Share of their distance from the axis by which corners of a ring differ."""
RING_NOISES = 4.0
"""The same in standard deviations of scattered vertices: one corner in 16,000 is beyond."""
RING_OPEN = np.radians(200.0)
"""rad: the widest angle about the axis without a flat. Half a ring, as of a half-bearing, goes round enough."""
RING_DIRECTIONS = 24
"""Directions of ridges that are looked at, the longest first: crumpled meshes have thousands."""
RING_SPARE = 1e-3
"""Share by which a row of flats misses a limit of the above before it is left out at first sight: sums about a middle
are good to far less."""
RING_FLAT = 1e-8
"""Corners whose spread across their length is no more than the root of this share of it are on a line at first sight:
beyond, sums about their middle keep eight digits."""
MOST_RINGS = 64
"""Rings along one direction that are looked at, those of the longest ridges."""

# --- meant ---

NAME_SHOWN = 255
"""Characters of a name that a message shows."""
CLOSE_NAMES = 0.6
"""Likeness (of difflib, its default) from which on a known name is probably the one that was meant."""
CHOICES_COMPARED = 500
"""Known names that a wrong one is compared with: each takes ten microseconds."""
MEANT_NAMES = 2
"""Names that are proposed, at most."""
LISTED_NAMES = 12
"""Known names that are listed where none is close."""

# --- meshes/hulls -----------------------------------------------------------------------------------------------------

HULL_POINTS = 4096
"""Points that are held against the planes of a hull at once: memory, no result depends on it."""
HULL_THICKNESS = 1e-7
"""Share of its size by which a flat set of points is thickened on each side, so that it has a hull: far below what any
mesh is exact to."""
ROWS_TOGETHER = 64
"""Rows of an array that are looked at as one for the least and the greatest of its columns."""
KEPT_EDGES = 200_000
"""Facets up to which the shared edges of a mesh are kept: 10 MB."""
LARGE_MESH = 1_000_000
"""Facets from which on a model of all of them, half a gigabyte, is made only where one of some does not do."""
ABOUT = 0.02
"""Distance from another part, in diagonals of a large mesh, within which its facets are expected to be asked for."""
MOST_EXPECTED = 0.8
"""Share of its facets above which a model of all is made, which does for every other part."""
KEPT_TRIANGLES = 50_000
"""Facets up to which the corners of a mesh, or of those near another part, are kept, and their boxes: 6 MB."""
KEPT_SPANS = 200_000
"""Facets up to which the spans of a mesh are kept: 5 MB; of more those that are asked for are computed anew."""

# meshes/slivers

MET_AT_ONCE = 100_000
"""Triangles of which a model is made at a time, a kilobyte each, to ask whether they meet a mesh."""
CROSSED_FEW = 400_000
"""Triangles times triangles up to which all are asked whether they cross, of several pairs at once; beyond, one in so
many first that it is this. Of 277 bolts in bores that share nothing, with 150,000 to 200,000 each, 40 % of the time."""
CROSSED_SOME = 64
"""... and no more than one in this many: where nothing crosses, all are asked after them."""
CULLED_LEAST = 4000
"""Pairs of triangles from which on those that are clearly apart are left out first: nearly all."""
CLEARLY_APART = 1e-9
"""Share of their coordinates by which they are then apart at least: far more than rounding, ..."""
CLEARLY_ROUNDED = 1e-12
"""... also that of the normal of a needle, in powers of its longest edge."""
CLEARLY_STEEP = 0.1
"""Sine between an edge and a triangle from which on it clearly passes through: where it does depends on rounding by no
more than ten times that, and no direction in which both are short is left."""
MET_FEW = 1000
"""Pairs of triangles up to which all directions but the normals are asked at once."""
MET_MOST = 10
"""Pairs of triangles, in all triangles, from which on to ask about each takes longer than to make trees of them."""

TOLD_AT_ONCE = 4096
"""Pairs of triangles that are looked at in one pass: 2 MB, which stay near the processor."""
CROSSED_MOST = 60
"""The same where it is only asked whether any meet: two trees for it take longer than one of few slivers does."""

# meshes/apart

APART_MOST = 20
"""Pairs of triangles near each other, in all triangles, beyond which it is not asked whether all keep apart."""
APART_SOME = 32
"""Of these at most so many are asked first."""
APART_TOGETHER = 50_000
"""Pairs of triangles of several sets that are brought together, 10 MB."""
APART_AT_ONCE = 4096
"""Pairs of triangles that are looked at in one pass."""
APART_ROUNDED = 1e-6
"""Share of a distance by which what keeps it is further apart."""

# meshes/facing

FACING_AT_ONCE = 20_000
"""Pairs of facets that are measured at once: 20 MB."""

# meshes/bulges

BULGE = 0.35
"""Share of a chord by which a smooth curve may stand off it: cubic curves through 32° and lengths of one to three come
to 0.3 at worst."""
BENDS_LEAST = 1e-12
"""By which the cosine between two planes is less than 1 where they are no continuation of each other."""
BENDS_MOST = 1.05
"""Share of the angle of a smooth edge up to which planes may meet smoothly, as an outline is not quite across them."""
BENDS_PLANES = 1000
"""Planes from which on it is not asked which of them do."""

# meshes/standoffs

EPS32 = 2.0**-23
"""Relative rounding of single precision, in which STL files store coordinates."""

STANDOFF_EDGES = 8.0
"""Times width and turn across an edge, over 8, that facets stand off at most: 16/3 where triangles with equal sides are
on a ball, up to 7 where they are less even, and 2 where they halve strips."""
STANDOFF_LOOSE = 0.01
"""Weight of no curvature among the polygons about one, each about one size of it away: what none of them tells of is
none, and what they tell is less by a hundredth at most."""
STANDOFF_CUT = 3.0
"""Times what a polygon tells by itself that it stands off at most where its surface ends, if those beside it do: a cut
that leaves half of a facet leaves about a third. Without, 4 of 300 random sockets overlap, of 41; without a limit, fans
of long facets hide 0.6 mm of a motor in an arm."""
STANDOFF_FAN = 300
"""Polygons that meet at a vertex up to which each speaks for all others there."""
STANDOFF_ROUNDED = 4.0
"""Roundings by which a sliver may be out of the plane of the facet beside it and be in it ..."""
STANDOFF_SLIVER = 0.1
"""... and how low it is for that, as a share of that facet."""
STANDOFF_TURN = 2.0
"""Angles of smooth edges by which facets that share a vertex may turn."""

# meshes/closest
AS_NEAR = 1e-9
"""Share of their distance by which facets may be farther than the nearest and still as near, ..."""
CLOSEST_ROUNDING = 1e-15
"""... and share of the largest coordinate."""
CLOSEST_SOME = 60_000
"""Points times the corners that bound how far they are off: nearer bounds cost more than they leave to be measured."""
CLOSEST_MOST = 1_000_000
"""Points times the facets near each up to which all are measured: 0.1 s, and 0.2 GB."""
CLOSEST_SIFTED = 8
"""Facets near each point from which on it is asked first which of their boxes are no farther than the nearest facet:
that takes a tenth of measuring them, and leaves a few."""

SEEN_AT_ONCE = 4096
"""Points times the facets whose solid angles are had at once: what is had of them stays in the cache."""

BOXES_AT_ONCE = 200_000
"""Boxes times boxes up to which all are compared with all: blocks of fewer take longer."""

BOXES_A_BLOCK = 64
"""Neighbouring boxes of which more are compared together, with what comes near them."""

# --- alike ------------------------------------------------------------------------------------------------------------

HASHES = 12
"""Hashes of rows before what is left, one row in eight after each, is sorted."""

# --- levelled ---------------------------------------------------------------------------------------------------------

AS_LARGE = 1e-3
"""Share by which parts and bodies differ in mass or size that are equal but for the rounding of their files: a bar of
56 mm, as STL 40 m from the origin, is off by up to a ten thousandth. None of them is the ground because of that."""
SIZE_BITS = 50
"""Bits in the sizes of all together, of the 53 that a float has."""
