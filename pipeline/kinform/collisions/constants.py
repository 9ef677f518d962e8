"""The numbers that decide about ranges and collisions, by the module that uses them first.

Lengths are shares of the diagonal of the smaller part of a pair unless a unit is stated, so that an assembly of any
size answers the same. Where neither a reason nor a measurement is named the number is a choice.
"""

from __future__ import annotations

import math

import numpy as np

# parts: what is asked of the facets of one part

COARSE_CELL = 0.02
"""Side of the cells whose vertices become one, of the part itself: facets of fine details vanish, ..."""
COARSE_WORTH = 0.5
"""... and where more than this share of all are left, all are."""
SCRAPE = 1e-3
"""By so much parts may overlap as they slide along each other: by rounding of their files and by what is left over
where joints were fitted."""
SCRAPE_ANGLES = 1.5
"""What a surface may be off an exact invariance, in alignment tolerances."""
DRIFT = 0.02
"""Share of the advance of a screw by which its threads' pitch may be off."""
EVEN = 1e-6
"""Advance a radian, relative to a surface's radius, that is rounding."""

# pair/distance_bounds: two parts with all their facets

SHORT_STEP = 0.01
"""Steps below this are short."""
STEPS_MOST = 60
"""Steps that are taken as wholes."""
STEPS_TRIED = 8
"""Steps after which it is seen whether so many reach the end: a pair that stays near is followed with the facets that
count, which are fewer."""
CERTAIN = 1.0 - 1e-6
"""Share of a distance that is trusted."""
WHOLES_TOUCH = 1e-6
"""Wholes nearer to each other than this share of a short step touch."""

# parts/probes, pair/deep_entry: points of one part inside the other

POINTS_SURFACE = 24
"""Points on one surface."""
POINTS_PART = 480
"""Points on one part."""
POINTS_FINE = 6
"""A surface's largest facets are divided until they are about so many times smaller than it."""
POINTS_FAR = 0.05
"""Share of the other part's diagonal beyond whose box a point needs no closer look."""
SPECK = 1e-8
"""By this much a point is inside."""
UNSEEN = 0.5
"""Share of what mates may be deep that points may travel unseen."""
SPARSE = 0.016
"""So far points near the other part may travel between two questions: to ask whether they are inside is dear, and what
came in is found by halving anyhow."""

PASSAGE_ROUNDING = 1e-9
"""By this share of a facet's extent points pass through it that pass beside: of two that share an edge, one is met."""

# pair/prepared_pair: crossings, depths

DEPTH_ENDS = 32
"""Ends of crossing segments between which the depth is looked for."""
DEPTH_SEGMENTS = 256
"""Segments to which these are so near, or not, that they may be deep."""
DEPTH_MIDDLES = 64
"""Places between them that are asked whether they are inside both parts."""
DEPTH_INSIDE = 40
"""Of those that are, at which the depth is measured."""
DEPTH_MEASURED = 16
"""So many are sooner measured than asked whether they are inside: 10 us each, or 1 ms for all. Either answer is the
same."""
DEPTH_FINER = 4
"""So many times as many places for a depth that is reported."""
FACET_GRID = 12
"""Points along the side of a facet that are asked whether they are inside the other part."""
DIRECTIONS_ROUND = np.stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)], axis=1)
"""(8, 2) directions about a point in a plane."""
CROSSING_LEAST = 1e-9
"""Facets cross, and are apart, by more than this."""
CROSSINGS_MOST = 200_000
"""Crossing facets that one question may return."""
MATE_ROUNDING = 1e-6
"""By so much more than chord errors, gap and uncertainty points may be off the surface of a mate."""

ALONG_AXIS = 0.9
"""Cosine between axes of cylinders and of a turn, below which it is not told how far points are off."""

# pair/advancement: the first crossing along a motion

WORK = 4000
"""Poses of one pair that one question may try."""
STEPS_TOUCHED = 12
"""Steps in touch after which what crosses is told for several at once: as many as there were, ..."""
STEPS_AHEAD = 48
"""... and so many at most. One of a thread took 2.5 ms alone, and 0.8 ms among 48."""
RESOLUTION = 4e-3
"""So far a part may travel unseen where others are in touch."""
TOGETHER = 8.0
"""Surfaces that come to cross within so many chord errors of travel belong to one collision, and so does a point that
comes in."""
OVERLAPPING = 5.0
"""Steps are so much longer while parts overlap: all that is asked is whether they part."""
BEHIND_FACE = (1.0, 0.2, 0.04)
"""Shares of the resolution behind a face at which it is asked what is inside: parts may be thinner."""
BEHIND_LEAST = 4.0
"""Nothing is asked behind a face nearer than this many times what a contact is found to."""
BEHIND_DEPTH = 0.4
"""Share of the way behind a face by which its points are then inside."""
REFINED = 2e-3
"""Share of what a contact is found to, to which the facets that cross first, or a point that comes in, are followed:
less than 1e-9 rad of a turn."""
FIRST_TRIED = 4
"""So often the facets that cross first are looked for among those that cross a little later."""
OVERLAP_SAME = 1.25
"""Parts that overlapped at the start, and come to overlap by no more than this share of it, come back to where they
were; ..."""
DEEPER = 5e-3
"""... and go into each other where it is by so much more: an arm that lies 0.3 mm in its base, of 166 mm, rubs on it by
0.74 mm until it is clear of it."""
RISE = 0.02
"""Share of what may be overlap of mates or chord errors by which the depth has to grow."""
RISE_UNEVEN = 0.1
"""Share of the same by which a depth that grows may have been greater before: it is measured at some points."""

# pair/drawn_overlap: whether parts that overlap as drawn go on into each other

OVERLAP_THIN = 0.25
"""Share of what mates may be deep to which pieces of an overlap are thin: twice their volume over their area, which is
half as much as a wedge is deep, or a third as a ball."""
OVERLAP_STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Thicknesses of a piece of the overlap that it travels until it is asked what the parts share there: two plates that
are drawn in each other by all of one's thickness have parted after twice as much, two ridges crest in crest after
more."""
OVERLAP_SOON = 4
"""So many of these, the first, tell whether parts go on into each other: on a longer way others of their features may
meet."""
OVERLAP_FINE = 1e-3
"""Share of the way to which these places are found."""
OVERLAP_GROWS = 1.15
"""Parts that come to share so many times as much go into each other: those of robots that rub on each other, or are
pressed together, share as much to within a few per cent over such a way."""
OVERLAP_SHRINKS = 0.5
"""Parts that come to share less than this part: a leaf that turns out of another has left it by half where its far end
has travelled as far as it was in it."""
OVERLAP_PIECES = 4
"""Pieces that are asked about, the largest."""

# pair/posed_pairs: pairs of bodies that move along given poses

HIGHER_KINDS = ("point", "line")
"""Patches whose place on the parts changes as they move."""
LOWER_TYPES = ("revolute", "prismatic", "cylindrical", "spherical", "planar", "screw")
"""Joints whose twists stay the same in both bodies."""
SPARE_SHARE = 1e-9
"""Share of the size by which boxes may miss each other and be looked at again."""
STILL = 1e-9
"""rad, and share of the assembly's size, that bodies at rest to each other move by rounding."""
REMEMBERED = 64
"""Displacements of a pair that are kept: the same are asked for several times."""
WORLD_BOXES = 64
"""Times for which bodies are boxed in the world, to see which of them stay away from each other."""
CHORD_SLACK = 1.05
"""Points between two poses may travel more than their straight distance."""

# driving/alone: a joint outside of loops

SEEN_BEYOND = 0.016
"""So much further than where the first pair is too deep others are followed, which may have met before it did: four
steps of parts in touch."""
STOP_ANGLE = math.radians(2e-5)
"""rad: to which a stop of a turn is found."""
STOP_LENGTH = 1e-5
"""To which a stop of a slide is found."""
SCREW_TURNS = 20
"""Turns of a screw that are tried at once to each side."""
SCREW_TURNS_MOST = 400
"""Turns of a screw that are tried in all, where its threads end."""
WINDOW_TURN = 2.0 * math.pi / 32
"""rad of a turn, ..."""
WINDOW_SLIDE = 0.05
"""... and share of the smaller part's diagonal of a slide, that parts which come near each other are followed with the
facets that can meet there, ..."""
WINDOW_LEAST = 0.1
"""... of which no less than this share is left where it begins."""
FACETS_STEP = 2000
"""Facets of a pair of which it is asked which can meet at all, in the time of one step as wholes: nested parts of 1,000
facets took 0.5 ms and 1 to 3 ms, those of an arm with 20,000 took 5 ms and 0.5 to 2 ms."""
MODEL_MOST = 0.7
"""Where more than this share of the facets that can meet at all can in a window, all are modelled, ..."""
MODEL_SHARED = 8.0
"""... and a model that is there is used for as many times fewer of its facets."""
MEETING_MARGIN = 1e-6
"""Facets whose swept profiles come no nearer than this never meet."""

CHUNK = 64
"""Facets that lie together and are asked as one whether any of them can meet any of others."""

# driving/meeting_spans: where along a motion facets can meet

DIVIDED_TO = 0.02
"""Share of a turn, or of a part's length along a slide, that a facet spans at most, or it is divided."""
DIVIDED_ROUNDS = 2
"""So often they are asked which of them meet, and those divided further."""
DIVIDED_AT_ONCE = 2
"""Times that they are divided into four before they are asked."""
DIVIDED_MOST = 60_000
"""Pieces of a part at most."""
PROFILE_CELLS = 60
"""Profiles of one surface that are the same to so many parts of where both parts are, are taken together."""
TESTED_MOST = 20_000_000
"""Groups of one part times those of the other, up to which they are asked."""
SPANS_MOST = 4_000_000
"""Spans of pairs of groups in all."""
PLACES = 8192
"""Spans begin and end at so many places of a turn, or of the length of the longer part."""
SECTORS = 64
"""Of the motion, for each of which it is known which facets can meet in it."""
TESTED_TOGETHER = 64
"""Groups of one that are asked at once."""

# joint_ranges: what is looked for unasked, and by several processes

SHARED_FACETS = 200_000
"""Joints times facets from which on processes share them: 300,000, of an arm, take 2 s, starting them 0.1 s."""

UNASKED_PAIRS = 10_000
"""Joints times parts up to which ranges are looked for where nobody asks: 100 links took 2.5 s of processor, ..."""
UNASKED_LOOPS = 8
"""... joints of loops, whose motions are followed step by step, counting so many times: 30 bars of four-bars took 4 s,
90 over a minute; ..."""
UNASKED_FACETS = 30_000_000
"""... and joints times facets: 27 million, of a humanoid of 1.3 million facets, took 9 s, as long as all before."""

# driving/apart_for_good: parts in loops that only turn or slide on each other

ONE_MOTION = 0.1
"""Share of what swept profiles are apart at least, by which points may leave the one axis or direction."""
TURNED_LEAST = 1e-3
"""Sine of the greatest turn, below which an axis is not looked for."""

# driving/loop_motion: the one motion of joints that loops tie together

STEP = 0.04
"""Arc length of a step: rad, and share of the block's size."""
PATH_STEPS = 900
"""Steps to each side at most."""
STEP_KEPT = 0.3
"""Share of a step that has to be left of it where the loops are closed again."""
STEPS_AWAY = 8
"""Steps after which the motion may be back where it began."""
CLOSING_STEPS = 12
"""Newton steps that close the loops."""
LOOP_RANK = 1e-4
"""Singular values of the closure below this leave motions."""
SINGULAR = 2e-3
"""One more of them within this is a branching."""
LONG_STEP = 0.4
"""rad: the longest step where a motion goes on evenly: screws and slides along one line, on which there is nothing to
be passed over."""
EVEN_TRIED = 30
"""Steps after which it is believed that a motion goes on evenly."""
EVEN_STEPS = 6000
"""Steps of an even motion in all."""
JACOBIAN_SAME = 1e-9
"""Change of the closure's Jacobian within which a motion goes on evenly."""
RETURN_MISS = 1e-5
"""rad and share of the size by which a motion may miss where it began and be back there."""
NARROW = 1e-2
"""Share of the assembly's size that a block's size is at least: its joints may be on one point."""
NODES_THROUGH = 6
"""Nodes that the motion between two of them is taken through."""
SMOOTH = 1e-9
"""rad and share of the size that loops may be open between nodes."""
CLOSED = 1e-6
"""rad, and share of the size: loops that are left open by less close, as far as their axes fit."""
CLOSED_EXACTLY = 1e-12
"""rad, and share of the size: loops that are left open by less need no more steps."""
RATE_SAME = 0.99
"""Rates of an idle freedom from this share of the greatest are the same but for rounding, and go by their order."""
TURNED_ROUND = 2.0 * math.pi - 0.2
"""rad: a joint of a motion that comes back, and turned by more, goes round and round."""
LEVEL = 1e-12
"""m a radian by which a turn may advance and keep heights, over its reach and the distance of its axis: rounding."""
LOOP_STOP = 1e-3
"""Share of a step to which a contact along a motion of loops is found."""

# run_collisions: collisions along a run

CONTACT_TIME = 1e-4
"""Share of the time between two outputs to which a first contact is found."""
OUTPUT_TURN = 0.2
"""rad that a joint may turn between outputs: then arcs are as good as straight."""
OUTPUT_SLIDE = 0.05
"""The same of a slide, as a share of the assembly's size."""
OUTPUT_PEAK = 0.005
"""Share of these that a joint may go further on between outputs than at them, where it turns back."""
OUTPUTS_MOST = 50_000
"""Outputs up to which a run is asked for again."""
OUTPUTS_FOR_PEAKS = 2_000
"""The same where that is for what happens where joints turn back: impacts would ask for any number."""
RUN_ASKED = 3
"""How often: with more outputs more of the motion is seen."""
COLLISIONS_MOST = 100
"""Collisions after which later ones are not looked for."""
DEPTH_SOON = 17
"""Times within an output step of the first contact at which the depth is measured too."""
DEPTH_TIMES = 12
"""Output times after the first contact at which the depth is measured: so many spread over the rest, and about the
worst."""
