"""Numbers and colours that decide what reports, the page and its pictures show."""

from __future__ import annotations

import math

# full

WIDTH = 80
"""Columns of text at a terminal."""

# brief

MOST_BRIEF = 10
"""Findings that are told line by line, the worst; with all that stands around them they fill a screen of 24 lines."""

LEAST_BRIEF = 5
"""Findings that are told line by line though what was found has to be cut; above, fewer are told, and whole."""

BRIEF_LINES = 21
"""Lines up to which single findings that do not fit beside their rule take a second one: a screen of 24, without the
two of the next commands and the prompt."""

COMPARED = ("KF3", "KF4")
"""Rules, by how their codes begin, that compare with what is stated: what was found says little without it."""

TOLD_NOTES = ("KF509",)
"""Rules whose notes stand on the first screen with all that was found: what was simulated at all."""

LEAST_BESIDE = 12
"""Characters beside a rule below which a finding goes below it: two shortened names and what was found need so many."""

LEAST_NAME = 12
"""Characters of the name of a part to which names are shortened before what was found is: both its ends are still
recognised. A choice."""

MANY_JOINTS = 9
"""Derived joints from which a design without a complete function is told how it gets fewer: contact alone counts each
part that is screwed on; few mechanisms are meant to have so many. A choice."""

BRIEF_NAME = 28
"""Characters of the name of the ground: with the rest of its line it fits in 80."""

# colours of the viewer, the drawings and the pictures; none of them carries a meaning alone

GROUND_COLOUR = "#8b929c"
"""Of the body that is ground."""
BODY_COLOURS = (
    "#6b9ac4", "#d39a5b", "#79ab83", "#b08abf", "#c9807a", "#6fb0ae", "#bda956", "#8a92cf", "#c78ca9", "#94a86a",
)  # fmt: skip
"""Of the other bodies, one after the other and again from the first."""
FIT_COLOURS = {"clearance": "#3f7fbf", "touch": "#2e9e76", "transition": "#c9962b", "interference": "#c2410c"}
"""Of contact patches by their fit."""
OVERLAP_COLOUR = "#f0283a"
"""Of solids that occupy the same space."""
SIGNAL_COLOUR = "#e8590c"
"""Of what a finding is about."""

# page: how much of it there is

MOST_PICTURES = 24
"""Errors and warnings with a picture on the page; the others can be shown in the interactive view."""
MOST_PICTURE_FILES = 40
"""Findings that the summary tells, the worst first; errors and warnings among them get a picture."""
OVERVIEW_WIDTH, OVERVIEW_HEIGHT = 960, 600
"""px, of the picture of the whole."""
PICTURE_WIDTH, PICTURE_HEIGHT = 480, 320
"""px, of the picture of a finding."""
MOST_LISTED_PATCHES = 14
"""Patches that a joint lists; the rest are counted."""
LEAST_GAP = 1e-7
"""m: smaller gaps are not told; meshes are seldom finer."""
MOST_SAMPLES = 400
"""Samples of one contact patch that are drawn; of larger ones an even choice."""
MOST_OVERLAPS = 200
"""Overlaps that are cut out; further ones are marked at their place alone."""
MOST_FRAMES = 600
"""Poses of a simulated motion that are embedded; of longer ones an even choice."""

# scene: the signs of joints

SIGN_SIZE = 1.25
"""A joint's sign over half the extent of its contact."""
LEAST_SIGN, MOST_SIGN = 0.045, 0.16
"""Shares of the assembly's size between which a sign stays."""
EMPTY_BOX = 0.05
"""m, to each side of a scene that is a point."""
BOX_MARGIN = 0.02
"""Share of the assembly's size by which contact samples may leave its box."""

# freedoms: how they are shown

SIDE_FRAMES = 16
"""Steps to each side of the pose of the meshes; more where a turn would take larger ones than FINEST_TURN."""
FINEST_TURN = math.radians(3.0)
"""rad, of one step: the eye sees larger ones as jumps."""
FULL_TURN = 2.0 * math.pi
"""rad: no turn is shown further."""
SHOWN_TURN = math.radians(28.0)
"""rad, greatest turn of a driver whose range is not known; a choice."""
MOST_PROPOSED_PARTS = 400
"""Joints are proposed on the page of assemblies of so many parts at most: beyond, looking takes longer than drawing."""
SHOWN_SLIDE = 0.14
"""Greatest slide of such a driver as a share of the assembly's size; a choice."""
FOLLOWER_TURN = 1.4
"""No joint turns further than this times SHOWN_TURN at the rates of the start."""
LARGE_SHARE = 0.25
"""Share of the way that assemblies go whose motion is shown at first order only."""
CLOSED = 1e-5
"""rad, and share of the size, by which a loop may miss."""
CLOSED_WELL = 1e-8
"""At this gap no further step is taken: a thousandth of what may be missed."""
MOST_CLOSING_STEPS = 8
"""Gauss–Newton steps; from a neighbouring pose three or four are usual."""
SLOPE_RANK = 1e-7
"""Singular values of the slopes below this share of the greatest count as zero: the slopes of loops that are nearly
closed are known to about the square root of what they miss."""
FREEDOM_RANK = 1e-7
"""Pivots of joint rates below this share of the greatest count as zero."""
LEAST_MOVE = 1e-6
"""Share of the size by which a body moves that is said to move."""
LEAST_RATE_ERROR = 1e-9
"""A coordinate whose rate differs from ±1 by less is the driver's; rates are exact up to rounding."""
MOST_COORDINATES = 240
"""Assemblies with loops and more joint coordinates than this are shown at first order only: closing them is slow."""
MOST_FREEDOMS = 60
"""Freedoms that are shown."""

# meshes: shading

CREASE = math.radians(32.0)
"""rad: facets that meet at more than this are not shaded as one surface; polygons of twelve sides still are."""
LINE_ANGLE = math.radians(18.0)
"""rad: edges between two surfaces that meet at more than this are drawn."""

# packing

PACKING_EFFORT = 6
"""Of zlib: 9 takes twice the time."""
STEPS = 65535
"""Steps across a box: 16 bits."""

# plots (px)

PLOT_WIDTH, PLOT_HEIGHT = 380.0, 168.0
"""px, of a plot."""
PLOT_LEFT, PLOT_RIGHT, PLOT_TOP, PLOT_BOTTOM = 54.0, 366.0, 12.0, 142.0
"""px, of the area of the curves."""
MOST_COLUMNS = 300
"""Columns of a curve; in each the least and the greatest value are kept."""
MOST_PLOTS = 48
"""Plots of one group."""
MOST_SPECTRA = 24
"""Spectra, and envelopes, of a page."""
MOST_POINTS = 600
"""Points of an effort over its speed: twice the columns of a curve over time, as it may pass each twice."""
SPECTRUM_DECADES = 4
"""Decades of amplitude that a spectrum shows: sensors are rarely better, and the lobes of the window fade
below."""
LEAST_FREQUENCIES = 24
"""Frequencies that a spectrum shows at least; else twice as many as stand above its lowest decade."""
NO_SPECTRUM = 1e-9
"""Share of the greatest value below which amplitudes are rounding."""
MOST_EVENTS = 40
"""Collisions that are marked in a plot."""
TICKS = 4.0
"""Steps of a scale at least about so many, before they are made round."""
ROUND_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Round steps of a scale, times a power of ten."""
FLAT = 1e-9
"""Curves that vary by less than this share of their values are flat lines."""

# raster and pictures (px are those of the finer drawing unless it is said)

PNG_EFFORT = 6
"""Of zlib: 9 takes three times as long for 3 % less."""
PORTION = 1 << 16
"""Pixels that are worked on at once: some megabytes."""
EYE_TURN, EYE_RISE = -0.95, 0.42
"""rad, the direction from which everything is seen: angle about z, and above the ground; that of the viewer's start."""
VIEW_MARGIN = 1.08
"""Size of a picture over that of what it holds."""
SIGNS_MARGIN = 1.5
"""The same where only signs of joints are drawn."""
FINDING_MARGIN = 1.35
"""The same in the picture of a finding."""
FINDING_ZOOM, FINDING_SHIFT = 1.12, 0.4
"""How much closer the picture of a finding with a place is, and how far it moves towards the place."""
FINER = 2
"""Pixels of the drawing to a pixel of the picture, each way."""
FAINT = 0.22
"""Weight of what a finding is not about."""
GLASS = 0.35
"""Weight of a part that stands before the place where it meets another."""
TINT = 0.4
"""Share of red in parts that meet."""
OVERLAP_WEIGHT, FINDING_OVERLAP_WEIGHT = 0.75, 0.8
"""Weights of overlaps over the whole, and over what a finding is about."""
MOST_SAMPLED = 4_000_000
"""Samples of a whole shape: 80 MB. Of larger ones, ..."""
WHOLE_OF_SEEN = 4
"""... and of those that have so many times as many as a picture shows of them, as of a machine beside the screw that it
is about, only what the picture shows is drawn."""
BAND = 1 << 15
"""Pixels that are shaded at once: they stay in the processor's cache."""
OUTLINE_STEP = 6.0
"""px: where depth changes by more from one pixel to the next, there is an outline; and what is nearer by more,
covers."""
OUTLINE_COSINE = 0.86
"""Cosine of the change of direction from one pixel to the next above which there is none (31°)."""
OUTLINE_SHADE = 0.52
"""Brightness of outlines."""
ARC_PIECES = 28
"""Pieces of an arc."""
MOST_AT_ONCE = 50_000
"""Pixels of pieces of lines that are looked at in one pass: with more they no longer fit in the processor's cache."""
