"""Numbers that decide which parts are one body when the function names all joints. Prices have no unit: what counts is
their order. The first values are those of a trial on nine public robots (none of its numbers was tuned there)."""

from __future__ import annotations

import numpy as np

OPPOSED = 0.03
"""Share of the local speed that a normal may oppose, and still slide on itself."""
SLOW = 1e-4
"""The same as a share of the greatest speed in the contact: near the axis nothing moves."""
OPPOSED_AREA = 0.05
"""Share of the area between two parts that may oppose a joint that parts them: scraps decide nothing."""
OPPOSED_SOME = 5
"""One of so many points of a contact is asked about all joints before all are: a fifth has several times that share."""
JOURNAL = 40.0
"""Price of parting a journal, a collar or a guide."""
LOOSE_JOURNAL = 35.0
"""The same of one with play: a pin turns where it is loose and stays where it is tight. Less than `EITHER` below a
journal, so that it is listed: which side a pin goes with is for its maker to say."""
LOOSE = 2e-3
"""Play of a journal as a share of its radius from which it is loose: a running fit (ISO 286, H7/g6) has as much from
10 mm down."""
FACE_ROUND = 30.0
"""Price of parting a face that goes round the axis, without a journal. Less than a journal: most models end at a flush
face, and what is inside of a servo is its own. With 1 for the journal 155 of 204 bodies of 17 robots came out whole,
with 40 168, on no robot fewer; whichever robot is left out, the others choose 40."""
SERRATED = 100.0
"""Price of parting serrations about the axis: those of a servo's output turn with what they drive."""
FLAT_BESIDE = 300.0
"""Price of parting a flat beside the axis."""
FLAT_APART = 50.0
"""The same of one that does not touch: the tip of a screw over the face of a motor."""
APART = 0.05
"""Gap of a flat from which it does not touch, as a share of the root of its area."""
JOURNAL_OFF = 0.7
"""Share of its reach by which the middle of a round patch may lie beside the axis that it goes round: half of one."""
COAXIAL = np.radians(1.0)
"""rad: a surface of revolution whose axis differs by less from the joint's goes round it, however little of it
touches."""
COAXIAL_OFF = 0.1
"""The same of its distance, as a share of its radius."""
FACE_OFF = 0.5
"""The same of other faces."""
GUIDED_ROUND = np.radians(181.0)
"""rad: normals of a guide leave no wider gap round it than this."""
FASTENED = {"holes": 5000.0, "pocket": 1000.0, "spigot": 400.0, "pressed": 20.0}
"""Price of parting what is fastened, by what suggests it: screws that are not modelled, a pocket, holes that line up
round a journal (of a flange, or of a joint in the pose that is drawn), a press."""
ROLLING = 1.0
"""Price of parting what touches at points or along lines only: balls, rollers, teeth hold nothing together."""
BROKEN = 20000.0
"""Price of a contact between bodies that no joint of theirs may part: legs that cross are drawn touching, too."""
GRAZED = 300.0
"""The same of one at points or along lines: it holds no more than a flat beside the axis does. With 100 as many joints
of rings of bodies are found without any name as with 20000, but one that is asked."""
JAMMED = 25.0
"""Price of such a contact between two bodies that stated joints connect, beside: it is in the way of the joint, and
that of others is not. Less than any face, so that it only decides between a face and a journal; what it decides is
listed."""
EITHER = 25.0
"""Margin up to which a part may go either way: less than the price of a flange."""
EITHER_WAY = 150.0
"""The same without what suggests that parts are fastened, where joints may part all that would be parted: half a flat
beside the axis, more than three journals. Horns are screwed to what they drive or to what drives them, and screw holes
line up either way. On 17 robots the greatest of a part whose author put it elsewhere is 70, and no part's lies between
120 and 200: with 300 as many are listed for nothing as for a reason."""
PARTED = 100.0
"""Price up to which contact is made to be parted: it does not say that two names stand for one body."""
HELD_ACROSS = 250.0
"""Price beyond which contact that was parted, a flat beside the axis or more, says that bodies guessed from different
names are not sure."""
CLOSED_SHARE = 1e-3
"""Share of the largest up to which singular values, and rates, of stated joints round a loop count as zero: axes are
written with three digits or more."""
MOVES_TRIED = 6
"""Of the bodies that a name may be moved to, so many are tried: those that contact joins most firmly."""
MOST_CUTS = 600
"""So many ways of joining names are cut at most; then the best so far is taken."""
LOOK_AHEAD = 4
"""Up to so many sets of joints that hang together all ways of joining their names are looked at."""
TOUCH_WORTH = 0.5
"""Price of parting the pair that touches over the largest area of all, in proportion for others: what nothing else
tells apart goes with the part that it touches most."""
NEAREST_TRIED = 6
"""Of so many parts whose boxes are nearest to one that touches nothing, the nearest surface is looked for."""
MOST_SECONDS = 60.0
"""s: what the integer program may take before the best answer so far is taken and said to be unproven."""
CLEARLY_LESS = 1e-4
"""Cost by which the best labels are better than all others where no solver can take others for as good: a hundred times
what the integer program may miss. Sums of prices are known to 1e-10."""
MOST_IN_TABLE = 50_000
"""Numbers in a table of costs, of all labels of a few nodes together, up to which nodes are eliminated: beyond, the
integer program is as quick."""
PROPOSED = (100.0, 310.0, np.inf)
"""Greatest prices of parting a pair at which a joint is looked for where no function is: journals, faces round the axis
and serrations; where that parts nothing, flats beside it, too; then all that the turn leaves free."""
SUBSTANTIAL = 0.002
"""Share of the assembly's volume that either side of a joint has at least where it does not name its sides."""
PROPOSED_SHARE = 0.001
"""The same of a joint that is proposed. On 17 robots 118 of 118 proposals are true with it, 106 of 106 with 0.002."""
OF_A_PART = 0.5
"""The same of both, of the part in which an m³ of the assembly lies on average: it is less where there are more than
some 250 and 500 of one size."""
BESIDE = 0.1
"""Of several pairs of bodies on one axis, those are proposed whose smaller side is at least this share of the largest
such: legs on one hip axis, and not the rings of their bearings."""
ALIKE = 0.3
"""Share of the smallest side by which two ways of parting differ at most that are one: by a ring, a horn, screws."""
ONLY_WAY = 1000.0
"""Price by which every other way of parting is dearer than the one that is taken where a joint does not name its sides:
that of a pocket. Beyond it something would be parted that is fastened. Holes round a journal (400) are no such, as the
horns of servos have them: by 340 and 400 wrong ways were cheaper on a public robot, where batteries lie on the axis."""
FAR_ALONG = 0.2
"""Share of the assembly's size beyond which contact along an axis is too far from the joint's point to be taken unseen:
the true ones of ten robots lie within 0.094 (0 mostly), the wrong one of the hand that asked for this at 0.67."""
ROUND_OFF = 0.1
"""A part goes round an axis where the middle of its surface lies beside it by less than this share of its spread, and
its spread differs by less than this share from one direction to another."""
ROUNDS = 4
"""So many times the ways of joints round a loop are looked for, each beside those of the others."""
WAYS_NAMED = 4
"""So many ways of parting are named where it is not clear which is meant."""
SAME_AXIS = np.radians(1.0)
"""rad: journals whose axes differ by less are on one axis."""
SAME_AXIS_OFF = 0.02
"""The same of their distance, as a share of the smaller journal's reach."""
ALONG_STATED = np.cos(SAME_AXIS)
"""Cosine of the angle between such an axis and that of a joint that is stated from which they are one."""
SAME_CENTRE = 1e-6
"""m: balls on one pin that differ by less are one, seen from two contacts."""
BALL_AREA = 0.9
"""Share of its area that is one sphere, of a ball."""
ALL_ROUND = np.radians(300.0)
"""rad: what of a cylinder is there at least where it tells what a part is."""
TURNED = 0.9
"""Share of its area that lies about one axis, across it or flat along it, of screws, nuts, washers and pins."""
WASHER_HEIGHT = 0.3
"""Height of a washer at most, as a share of its outer radius."""
NUT_HEIGHT = 1.3
"""Height of a nut at most, by its width across flats: beyond, it is a spacer."""
HEAD = (1.25, 2.6)
"""Radius of a screw's head by that of its shank: 1.5 to 2.2 in the standards."""
SHANK = 1.0
"""Length of a screw's shank at least, by its radius."""
PIN_LENGTH = 2.0
"""Length of a pin at least, by its radius."""
HEXAGON = 0.02
"""By how much the cosine between faces of a hexagon may be off."""
NAMED_HOLDS = 3
"""Of the parts that hold another in its body, or that it was parted from, so many are named."""
NUMBERS_AT_ONCE = 8192
"""Joints times points of a contact that are looked at together: their columns stay in the cache."""
