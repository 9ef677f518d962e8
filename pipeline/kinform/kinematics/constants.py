"""Numbers that decide in the kinematics: of each what it is, and the reason or the measurement that chose it.

Grouped by the module that uses them. What a user may set is in `model.tolerances`, above all from which singular value
on a motion counts as free or held: `Tolerances.free` and `held`. Where no reason is given the number is a choice that
was not measured. "Relative" is to what the sentence names, else to 1.
"""

from __future__ import annotations

import math

# --- more than one room ---------------------------------------------------------------------------------------------

SIGMAS = 3.0
"""Standard uncertainties by which fitted axes, centres and normals may be off: beyond it chance is below 1 %."""
RCOND = 1e-9
"""Relative singular value below which least squares ignore a direction: rounding, amplified a thousand times."""
LEAST_FRAME = 0.05
"""Share of the assembly's size that the scaling length of a block is at least: axes that meet have no size of their
own."""
CLOSED = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops; the axes have been made exactly
parallel and coaxial before, so true zeros are rounding."""
PART_OF_TURN = 1e-3
"""Share of the fastest turn of a joint's freedoms below which a combination of them is a slide."""
FAR_AXIS = 1e-9
"""A twist whose axis is farther away than the size of the assembly over this is a slide."""
MET = 1e-15
"""Relative to the coordinates: what agrees within this agrees as well as numbers can say."""
AT_REST = 1e-9
"""Relative speed below which a motion does not concern a pair or a joint."""

# --- derivation -----------------------------------------------------------------------------------------------------

MOST_BASIS_NUMBERS = 1_000_000
"""Largest dense basis of freedoms that is kept; the named freedoms are sparse."""

# --- wording --------------------------------------------------------------------------------------------------------

EXACT_MOTION = 1e-5
"""Of unit twists, scaled in their frame: what is zero is zero to rounding and snapping."""
EXACT_WRENCH = 1e-6
"""The same of wrenches, whose joints are snapped already."""
NO_LEAD = 1e-6
"""Advance a turn, over the length of the frame, that is none."""
NAMED_AXIS = 5e-4
"""Directions this near (sine) to an axis of the world have its name: their components read 1, 0 and 0 then."""
SHOWN_COMPONENT = 5e-4
"""Components below this are shown as 0: they would not be seen in three digits beside 1."""
SHOWN_COORDINATE = 1e-6
"""The same of coordinates of a point, over the largest, and over the length of the frame."""
SAME_DIRECTION = 1e-3
"""Two unit directions that differ by less are one; a screw with less advance a radian (over the size) is a turn."""

# --- pair/evidence --------------------------------------------------------------------------------------------------

GAP_BANDS = ((0.12, 1.0), (0.42, 0.5), (float("inf"), 0.25))
"""(gap over the contact tolerance, weight): gaps weigh, they do not switch."""
TOUCHING_GAP = GAP_BANDS[0][0]
"""Gaps up to this share of the contact tolerance have full weight: the surfaces touch."""
WIDE_GAP = GAP_BANDS[1][0]
"""Gaps beyond this share have the least weight."""
SAME_PITCH = 5e-3
"""Relative difference of pitches that are one."""
STRAY_SHARE = 0.02
"""Share of the contact area below which a one-sided patch counts only where it touches."""
BOTH_SIDES = -0.9
"""Least cosine between facets of such a patch that is on one side only."""
UNKNOWN_DIRECTION = math.radians(2.0)
"""rad: standard uncertainty between two axes from which on it is not known that the surfaces mate. Of a knee of public
robots it was 3° or 90° by the pose, and with it the mate was found or not; of all others that decide it is below 1°."""
LOOSE_ANGLE = 0.2
"""rad by which the direction of facets of no known surface may be off."""

# --- pair/hypotheses ------------------------------------------------------------------------------------------------

MOST_DIRECTIONS = 24
"""Directions tried, the best supported first: parts of real robots have hundreds of tiny planes."""
MOST_NORMALS = 12
"""Normals of planes, the heaviest first, of which each two suggest the line in which their planes meet."""
MOST_FACES = 6
"""Of these, how many suggest slides across themselves."""
MOST_SLIDES = 72
"""Slides that are tried in all."""
SEPARATE_CENTRES = 1e-3
"""Share of the contact's size from which on two centres of balls suggest the line through them."""
CENTRE_SLACK = 1e-9
"""Share of the contact's size by which centres that are known exactly may be apart and be one."""
DISTINCT_SLIDE = 0.25
"""Directions that differ by less than this share of the alignment are tried once."""
MOST_LOOSE = 4
"""Patches of facets of no known surface, the largest first, each of which suggests directions in a plane."""
LEAST_MEETING = 0.1
"""Planes at a smaller angle (sine) have no line in common that could be told."""
ONE_NORMAL = 1e-3
"""Relative spread of normals below which they say one direction only."""
LEAST_POSITION = 1e-7
"""Share of a patch's length below which its place counts as no better known: keeps the weights of fits comparable."""

# --- pair/freedoms --------------------------------------------------------------------------------------------------

NEW_FREEDOM = 0.03
"""A motion adds a freedom when this much of its unit twist lies outside those already found."""
CLEARLY_NEW = 0.5
"""Above this share a further motion is not a variant of those already found."""
DIFFERENCE_SLACK = 2.0
"""What is left of a further motion may be off by this many times the tolerances: it is a difference."""
PURE_SLIDE = 1e-9
"""Unit twists that turn by less are slides."""
CONE_SLACK = 1e-6
"""rad beyond the fit by which a slide along a cone may be off: rounding, for its slope is a fact."""
THREAD_TURNING = 1e-3
"""Unit twists that turn by less are not tried on a thread."""

# --- pair/lower_pairs -----------------------------------------------------------------------------------------------

EXACT_PAIR = 1e-6
"""Twist spaces come out of snapped rows: what is zero is zero to rounding."""
NEAR_PAIR = 0.02
"""Spaces pieced together from patches that agree within their tolerances are off a lower pair by this much."""

# --- pair/canonical_basis -------------------------------------------------------------------------------------------

NO_COMPONENT = 1e-13
"""Share of the size of a vector below which a component is rounding."""

# --- pair/decision --------------------------------------------------------------------------------------------------

DEEP_OVERLAP = 0.2
"""Overlaps below this share of the contact tolerance are presses: they never excuse a patch."""
PRESS_RATIO = 2.0
"""Nor do overlaps within this many times those of the patches that carry the joint."""
MOST_LEFT_OUT = 0.25
"""Largest share of the contact area that consensus may leave out."""
MOST_STOPPED = 0.6
"""Largest share that end stops of a turn may have: a closed gripper's jaws touch over more than its hinge."""
RIVAL = 2.0
"""Times as much area that others may have which could be left out instead of what is: of a block in a corner nobody
knows along which of two walls it slides, unless one is much longer."""
ALONG_AXIS = 0.01
"""Normals and axes this near (sine) to an axis are along it."""
OPPOSING_SPEED = 0.05
"""Share of a patch's greatest normal speed that is opposition, and no rounding beside it."""

# --- pair/certainty -------------------------------------------------------------------------------------------------

MISSED_AXES = 0.5
"""Axes that miss each other by less than this share of the contact tolerance are meant to be one."""
TILTED_AXES = 4.0
"""So are axes within this many times the alignment."""
PASSING_GAP = 2e-3
"""Gaps below this share of the size of the smaller body are as good as none."""
ON_RADIUS = 0.02
"""Relative: points this near to the radius of a surface from an axis are on a surface about that axis."""
ACROSS_LINE = 1e-3
"""Planes whose normals are this near (sine) to a line of contact lie across it."""
WEDGED = 8.0
"""Times as fast as a body moves what touches it, above which that is wedged: lines that lean against each other by
0.12 rad, the angle of friction of steel that is hardly oiled."""
STRAY_AREA = 5e-4
"""Share of the squared size of the smaller body below which a one-directional contact that touches may be a stray."""
STRAY_AREA_APART = 2e-2
"""The same where it does not touch."""
WIDE_CONTACT = 0.15
"""Contact whose box is larger than this share of the smaller body is not one stray touch: feet, rims."""
THREAD_AXES = 4
"""Axes about which threads are suspected."""
THREAD_SECTORS = 8
"""Parts of a turn of which all but one must have contact where a thread is suspected."""
FILLED_SECTOR = 0.02
"""Share of the weight from which on such a part has contact."""
THREAD_SLOPE = 0.01
"""Mean square of the normals along the axis below which nothing leans."""
THREAD_LEAN = 5e-3
"""Advance a radian, in radii, of what leans like a thread."""
THREAD_FIT = 0.75
"""Share of the squared speeds that a screw may leave where facets lean like a thread."""

VAGUE_DIRECTION = math.radians(0.5)
"""rad: a surface whose direction is known no better than this does not decide alone, as an axis would not.

With 0.05 rad, two of 1,000 random assemblies were wrong, both of coarse circles whose vertices scatter; of 150 random
shafts in bores whose vertices scatter by 1 to 100 µm, none of which chose it, 0 were wrong, 17 in doubt, 1 blocked
(without this doubt and that of `contacts.constants.ENCLOSING_*`: 3, 6 and 4)."""

WEYL_SIGMAS = 3.0
"""A constraint whose singular value is less than so many standard uncertainties of the directions of all rows may be
none: one of 2,000 random assemblies was wrong without this (two hexagons of 6 mm whose vertices scatter by 3 µm)."""

# --- pair/uncertainty ------------------------------------------------------------------------------------------------

SAYS_DIRECTION = 0.1
"""Sine within which an axis is along, or a plane across, the joint's axis, and has a say about its direction."""
VAGUE_AXIS = math.radians(0.5)
"""rad: standard uncertainty of its direction above which an axis is too badly known for a joint."""
VAGUE_PLACE = 0.03
"""The same of its place, as a share of its radius: what a clearance may be."""

# --- pair/scraps -----------------------------------------------------------------------------------------------------

SLIVER_ARC = math.radians(30.0)
"""rad: rounds that cover less about their axis, ..."""
SLIVER_SHARE = 0.01
"""... with less than this share of the contact area, decide nothing. So do planes that only facets rest on."""
SLIVER_ARC_ONE_SIDED = math.radians(90.0)
"""rad: the same, whatever the share, where only facets of no known surface run on the round: flanks of teeth. Below the
share, whatever the arc."""
DIP = 0.1
"""Share of the contact tolerance from which on a flat that overlaps dips into the other part, ..."""
DIP_SHARE = 0.05
"""... and share of the area below which it then decides nothing, ..."""
FACED = -0.99
"""... unless another such flat faces it: cosine of their normals."""
STEP_WIDTH = 5.0
"""Width of each of the two faces of a step that two edges make (`scraps._width`: of rings π times their width), over
the overlap at the other, up to which the step is there by the overlap alone. It is π to the rounding of the mesh."""
STEP_CORNER = 0.5
"""Largest cosine between the normals of the two faces of a step."""

# --- pair/slots ------------------------------------------------------------------------------------------------------

SLOT_PLAY = math.radians(5.0)
"""rad by which what a pin holds may turn until it touches either side of its slot: as with axes that mate, no play
excuses a greater angle."""
SLOT_OPPOSED = -0.999
"""Greatest cosine between what two sides of a slot hold: as in `contacts`."""

# --- pair/stops ------------------------------------------------------------------------------------------------------

FACING_ONE_WAY = 1e-4
"""1 − cosine of normals of faces that face one way."""
SLIDES_FROM = 0.5
"""Length of a guide over its width from which on it slides and does not jam."""
ONE_SECTION = 0.05
"""Relative difference of radii that are one cross-section."""
INSIDE_GUIDE = 1.05
"""Faces that reach no further than this, in half widths of the guide, are inside of its cross-section."""
ROUND_FROM = 0.3
"""Points of a face beyond this share of its reach show whether it goes round the axis."""
BESIDE_AXIS = math.radians(200.0)
"""rad without any of a face about the axis, beyond which it lies beside it."""
SHORT_FLANK = 0.5
"""Length of a flank over that of the faces beside it below which it guides nothing."""

# --- pair/hollows ----------------------------------------------------------------------------------------------------

HOLLOW_ARC = math.radians(15.0)
"""rad by which the end of a slot may go further round its pin than half: patches have bins of up to 15°, and facets of
the slot begin where they will."""
HOLLOW_FACET = math.radians(12.0)
"""rad: half of the angle of a facet from which on, chord errors of both sides taken together, nobody knows whether a
hollow goes half round its pin or less: of 20 facets and fewer."""

# --- pair/joint -----------------------------------------------------------------------------------------------------

LEAST_MISALIGNMENT = 1e-4
"""rad, and share of the contact's size, of misalignment that is told."""

# --- pair/extremes --------------------------------------------------------------------------------------------------

NORMAL_SECTORS = 16
"""Sectors of normals about the axis of a curved patch with many samples; of each its ends are kept."""
FEW_SAMPLES = 12
"""Patches with no more samples than this keep them all."""
SAME_PLACE = 1e-6
"""rad, and share of the height, by which samples of one line or ring differ: coordinates of mesh files are rounded."""
STRAIGHT_EDGE = 1e-6
"""Corners of a hull that stand out less than this share of its size are on an edge."""
HULL_DIRECTIONS = 16
"""Directions whose ends are corners of a hull: what lies inside of these corners is left out at once."""
MOMENT_ROUNDING = 1e-13
"""Share of its moments by which a sum of squares that follows from them may be off: hundreds of roundings."""
MOST_IN_STEP = 250
"""Pairs that are decided in step: their samples take a few MB, and more gain nothing."""
MOST_STACKED_SAMPLES = 8_000
"""Samples of patches that are looked at together: a few MB at a time, and no further gain from more."""
CAP = 1e-3
"""Cosine with the mean above which all normals of a ball are those of a cap, whose rim spans them."""
BALL_DIRECTIONS = 96
"""Directions in which the ends of a ball's normals are looked for."""

# --- bodies/fasteners -----------------------------------------------------------------------------------------------

SUGGESTED_AXIS = 1e-3
"""rad by which a suggested axis may differ from the normal of a planar joint."""

# --- bodies/readings ------------------------------------------------------------------------------------------------

ON_ONE_LINE = 1e-3
"""Sine between axes, and share of the assembly's size between lines, of contacts of a pin that are about one line."""

READING_PLACE = 0.1
"""Share of the size of a contact by which the place of an intended joint may be off that of the reading that it
chooses."""

# --- axes/snapping --------------------------------------------------------------------------------------------------

EXACT_AXIS = 1e-9
"""Uncertainty (rad, and relative to the reach) of exact geometry in double precision."""
UNMOVED = 1e-14
"""Relative: smaller moves are rounding, no misfit."""
DIRECTION_DECIMALS = 12
"""Decimals of a direction that several axes have in common: the rounding of one is not carried to all others."""

# --- axes/concurrence -----------------------------------------------------------------------------------------------

LEAST_CROSSING = 0.05
"""Lines at a smaller angle (sine) meet nowhere in particular."""
FIRST_LOOK = 1.001
"""Slack of the first look at which lines may meet, which must not lose any to rounding."""

# --- axes/equal_lengths -----------------------------------------------------------------------------------------------

MOST_COMPARED_JOINTS = 400
"""Blocks with more joints are left as they are: loops of four bodies grow with their square."""
ONE_PIN = 1e-13
"""Share of the assembly's size by which lines that were made coaxial may be apart: rounding."""
LEAST_SIDE = 100.0
"""Times what the pins of a loop may be shifted by in all that each of its sides is long at least: shorter sides are
equal to anything."""
EQUAL_SIDES = 4e-15
"""Share of the assembly's size by which sides that are equal differ: a few roundings of its coordinates."""

# --- axes/proportions -----------------------------------------------------------------------------------------------

CLOSED_GAP = 1e-12
"""rad, and shares of the size: loops that stay closed to this need nothing."""
GLANCE = 0.1
"""Share of that gap below which one look ahead is enough."""
IMPROVED = 0.01
"""Share of the gap before that moved axes may leave."""
STRIDE = 0.12
"""rad (of the joint that turns most) from one pose to the next."""
STRIDES = 16
"""Poses on each side of the start."""
MOST_FITTED_FREEDOMS = 3
"""Blocks with more freedoms are left as they are."""
MOST_FITTED_RATES = 48
"""So are blocks with more joint rates."""
SOUND_POSE = 0.01
"""Relative singular value that must be left: nearer to singular poses gaps say more of the pose than of the axes."""
FITTED_RANK = 1e-6
"""Relative singular value below which rows depend on the others."""
EXACTLY_PARALLEL = 1e-14
"""Sine below which axes are exactly parallel: snapping makes them so."""
FITTING_ROUNDS = 8
"""Rounds of Gauss and Newton, of the axes and of each pose: they converge in three."""
POSE_CLOSED = 1e-13
"""Change of a pose (rad, shares of the size) after which it is closed."""
POSE_LOST = 1e-9
"""Change after the last round beyond which it is not."""
WAY_LOST = 1e-3
"""Share of a direction that must be left among the freedoms of the next pose."""

# --- axes/higher_pairs ----------------------------------------------------------------------------------------------

DOUBTFUL_MOTION = 3.0
"""A motion that the rows miss by less than this many times what is allowed is doubtful."""
NEARLY_LEFT = 0.02
"""Share of what rows hold of other motions below which holding one is doubtful: chamfers and reliefs of teeth lean by
degrees more than their facets show. Two flanks of a pinion in a ring with chamfered tips disagreed by 0.5 %."""
MOST_TURNED = 0.1
"""Share of a motion that may lie outside the space of a pair that nearly contains it: up to the alignment the space is
turned, beyond it the pair is ambiguous. Of the fixtures and twelve robots none is turned by more than 1e-14."""

# --- loops/block_closure --------------------------------------------------------------------------------------------

LOOSEST_CLOSED = 1e-4
"""Loops whose axes are in no relation that snapping knows (Bennett's) close to `SIGMAS` times the uncertainty of the
axes, but to no more than this relative singular value."""
FEW_RATES = 160
"""Blocks of at most so many joint rates are decided at once."""
MOST_RATES = 4000
"""Largest number of joint rates for which singular values are affordable."""
SURE_DROPPED = 1e-10
"""In the elimination, what is dropped is below this, ..."""
SURE_KEPT = 1e-5
"""... and what is kept above this, or else the decision is left to singular values."""
PIVOT_SHARE = 0.3
"""Any column of at least this share of the largest may be chosen: preference decides among these."""
RATE_ROUNDING = 1e-10
"""Rates below this share of the largest of a solution are zero."""
FACTOR_ROUNDING = 1e-13
"""Factors of an elimination below this are zero, ..."""
SUM_ROUNDING = 1e-14
"""... and sums of products of them below this."""
AXES_RANK = 1e-6
"""Relative singular value below which axes are parallel where the point nearest to all of them is looked for."""

# --- mobility/closed_pose -------------------------------------------------------------------------------------------

BALANCED = 1e-6
"""Curvature (of unit freedoms) that is rounding."""
UNBALANCED = 1e-4
"""Curvature that is none."""
MOST_TESTED_FREEDOMS = 40
"""Freedoms of a block up to which directions that pass the second-order test are looked for."""
SLOW_ITERATIONS = 60
"""Gauss–Newton iterations where convergence is linear: halving, at a simple singularity."""
MOST_PASSING = 12
"""Directions that pass the second-order test that are followed."""
SAME_LINE = 0.999
"""Cosine above which two of them are one."""
COMPLEMENT = 1e-6
"""Singular value below which a direction has no part in a space."""

# --- mobility/local_motions -----------------------------------------------------------------------------------------

SEED = 20000
"""Of the random mixes of freedoms that are stepped along: the same in every run."""
MIXES = 3
"""Mixes of the freedoms, all of which must be kept: one could by chance lie in a branch of its own."""
MANY_MIXES = 6
"""Mixes at a singular pose, beside the freedoms themselves."""
BRANCH_MIXES = 2
"""Mixes at a pose that lies on one branch, as far as is known."""
STEP_SIZES = (0.05, 0.01, 0.002)
"""rad, and shares of the block's size: near a singular pose a long step leaves the neighbourhood."""
STEPPED_RANK = 1e-6
"""Relative singular value below which a freedom counts as free at a stepped pose, whose loops are closed to
rounding."""
STEPPED_RANK_EXACT = 1e-9
"""The same where the loops close to rounding over the whole step: nothing of the axes' misfit is in it."""
CLOSURE_ROUNDING = 1e-13
"""Rounding of a closure."""
HIGHER_ORDER = 0.3
"""What a half stride leaves of a whole one's residual: more is misfit, which grows with the step, less an obstruction
of higher order."""
FAST_ITERATIONS = 12
"""Gauss–Newton iterations where convergence is quadratic."""
FAST_CHANGE = 1e-9
"""Change after which such a solve has converged."""
SLOW_CHANGE = 1e-11
"""Change after which a full solve has."""
LONGEST_CHANGE = 0.5
"""Share of a step that one iteration may change at most."""
REDUCED_RATES = 60
"""Rates of a block from which on its closure is made triangular before its singular values are asked: at 100 to 420
rates the two take 0.6 of the time of one, at 40 nine tenths."""
INVERSE_ITERATIONS = 8
"""Inverse iterations for the singular vectors that do not count: with a gap each gains digits by the square of it."""
CONVERGED_VECTORS = 1e-14
"""Share of a matrix that may be missing from its product with singular vectors that have converged."""
LEAST_DIAGONAL = 1e-250
"""Share of a triangle below which nothing can be divided by what is on its diagonal."""
FINEST_VALUE = 1e-12
"""Relative singular value that a full solve still uses: near a singularity of fourth order they are that small."""
STEP_KEPT = 0.9
"""Share of a step that is left when the motion is real."""
STEP_LOST = 0.1
"""Share that is left when it is none."""
STEP_ASTRAY = 2.0
"""Steps that end farther than this many steps away lead elsewhere."""
STEP_ASIDE = 0.2
"""Share of a step that may go aside within a smooth branch."""
CONE_SHARE = 0.05
"""Relative singular value from which on the ends of steps span a direction of the tangent cone."""
MOST_BRANCHES = 8
"""Branches that are told apart."""
SAME_BRANCH = 0.95
"""Least cosine between the freedoms of two poses of one branch."""
BRANCH_STEP = 0.1
"""Share of the distance from the pose by which a branch is stepped along."""
MOST_STEP_WORK = 2e10
"""Multiplications that the steps at a singular pose may take; a block that needs more stays undecided."""

# --- mobility/finite_motion -----------------------------------------------------------------------------------------

MOST_BLOCK_WORK = 5e8
"""Multiplications of one singular value decomposition of a block; above it the block is not tried. A mesh of
300 hinges has 5e7, one of 250 ball joints about 5e8."""
MOST_BATCH_NUMBERS = 200_000
"""Squares of freedoms of blocks that are tried in step: 10,000 four-bars, but no two blocks of 500 hinges, whose
matrices would take the memory of both."""
MOVING_JOINT = 1e-3
"""Share of the fastest rate from which on a joint is named as moving."""
MOST_STATEMENTS = 4
"""Blocks whose statements are told one by one."""

# --- mobility/idle --------------------------------------------------------------------------------------------------

IDLE_MIDDLE = 0.2
"""Distance of the middle of a face from an axis, over that of its points, beyond which it does not turn onto itself,
..."""
IDLE_OPEN = math.radians(60.0)
"""... and angle about the axis without any of it."""
IDLE_AXIS = 1e-3
"""Sine between axes, and part of a unit turn outside a joint's freedoms, that is none."""
IDLE_PLACE = 1e-4
"""Share of the assembly's size by which axes and centres may lie apart."""
INTENDED_AXIS = 0.02
"""Sine by which the axis of an intended joint may be off that of the turn that it names, ..."""
INTENDED_PLACE = 1e-2
"""... and share of the assembly's size by which its place may."""

# --- mobility/joint_redundancy, loop_redundancy ---------------------------------------------------------------------

NAMED_CONTACT_AXIS = 0.02
"""Directions of contacts this near (sine) to an axis of the world have its name: contacts are not snapped."""
SITE_GAP = 0.25
"""Patches whose gap is below this share of the radius of the smaller one belong together."""
FEW_OF_SITE = 4
"""One of so many samples is looked at before all are, where patches may lie together."""
HELD_TWICE = 1e-9
"""1 − cosine of directions that two sites both hold."""
MOST_SORTED_LOOPS = 60
"""Up to so many loops in a block, what they hold together is told apart."""
MOST_NAMED = 12
"""So many bodies or joints are named in a text."""

# --- mobility/named_freedoms ----------------------------------------------------------------------------------------

SAME_RATES = 1e-2
"""An idle turn is one of the assembly's freedoms when it is within this share of one."""
NO_TURN = 1e-10
"""Turn (rad/s) that is none, as a share of a velocity over the size of the assembly; rounding."""
NO_PITCH = 1e-6
"""m a turn that is none, as a share of the size of the assembly; a choice: a fine thread has 1e-2 of its screw."""
PITCH_ROUNDING = 1e-13
"""The same as a share of the distance of the axis from the origin: what products of doubles lose."""
EXCHANGED = 0.1
"""Rate in an idle turn from which on a driver may give way to it."""
NO_TWIST = 1e-12
"""Largest component of a relative twist that is none."""

# --- mobility/couplings, stated_couplings ---------------------------------------------------------------------------

FIXED_RATIO = 1e-6
"""Relative: rates that keep their ratio to this are coupled."""
TOOTHED_TURNS = 1.75
"""Full turns of the convex edges of an outline from which on it has teeth."""
INDEPENDENT_ROW = 1e-9
"""Share of the largest entry below which what is left of a row is rounding."""

# --- mobility/teeth -------------------------------------------------------------------------------------------------

EVEN_TEETH = 0.03
"""Share of the pitch by which teeth may stand elsewhere than at even distances, or leave the constant ratio:
tessellated involutes of five points a flank stay below a third of it, straight flanks on wheels do not."""
FEWEST_TEETH = 5
"""Teeth of a whole wheel, and teeth in a row of a rack or a sector, from which on they are teeth and no cams."""
TOOTH_POSES = 24
"""Poses in which the sections are held against each other while one tooth passes."""
IN_PLANE = 1e-3
"""rad: axes that are parallel or perpendicular to this lie in one plane."""
RATIO_AGREES = 0.01
"""Relative: what the ratio at one pose, from the normals of the flanks, may differ from that of the teeth."""
TIP_MARGIN = 1.02
"""Teeth up to this share of the other wheel's tip radius are within its reach."""
ROUNDED_LEVEL = 1e-9
"""Share of the greatest radius by which the end of an edge may be beyond a level that it meets, for rounding."""

# --- separation/cone ------------------------------------------------------------------------------------------------

CONE_FREE = 1e-4
"""Speeds over the size of a unit twist below which rows do not move: rounding of meshes and of HiGHS."""
CONE_HELD = 2e-3
"""Speeds above which they do; in between nobody knows."""
LEAST_ROW = 1e-3
"""Length below which what is left of a unit row says nothing."""
EQUAL_ROWS = 1e-6
"""A row counts as tight below this, and two rows as one."""
SURELY_HELD = 1e-5
"""Singular value of what is held in a block from which on HiGHS, whose rows are good to 1e-7, moves nothing so."""
SURELY_STILL = 1e-7
"""Share of a row that what is held leaves below which it opens by less than counts: LARGEST_TWIST times it is 5e-5."""
MOST_CERTIFIED = 120
"""Components of twists up to which it is first asked whether anything opens in a block: dense algebra of a
millisecond, where importing and calling a linear program takes hundreds."""
CERTIFICATE_SHARE = 1e-6
"""Least λ over the greatest of a certificate."""
NEWTON_STEPS = 25
"""Newton steps; certificates are found within a few."""
LONGEST_STEP = 2.0
"""Change of an exponent that one Newton step may make at most."""
FAR_EXPONENT = 40.0
"""Exponent at which the sum has evidently no minimum."""
MOST_RAYS = 48
"""Rays at an intermediate step beyond which there are too many to list."""

# --- separation/releases, separations -------------------------------------------------------------------------------

MOST_RELEASES = 12
"""Extreme directions up to which each is told."""
MIDDLE_STEPS = 200
"""Steps in which a direction inside a cone of very many extreme directions is looked for."""
MIDDLE_STRIDE = 0.1
"""Speed that such a step gives to the worst row."""
MOST_OPENING_ROWS = 12_000
"""Rows of one block's program beyond which it would take minutes: 400 bricks in a wall, 5,000 rows, take 3 s."""
ROUNDED_ROW = 1e-7
"""Entries of unit rows below this are rounding to HiGHS, which with them may not end: a hand of 146 parts did not in
ten minutes."""
MOST_TOGETHER = 8
"""Bodies up to which those are told that leave together."""
LARGEST_TWIST = 1.0 / CONE_HELD
"""Bound of twist components where a pair opens by 1: what opens slower does not open for certain."""
STILL_LIFTED = 1e-10
"""Speed of a row, of a slide of 1, that is none: LARGEST_TWIST times it is less than HiGHS admits."""

# --- questions ------------------------------------------------------------------------------------------------------

MOTION_THERE = 1e-3
"""A unit twist is there when less than this of it lies outside the freedoms (scaled by the size)."""
BLOCKING_SPEED = 0.02
"""Share of a patch's speed along its normals from which on it is named as blocking."""
MOST_PROGRAM_ROWS = 20_000
"""Rows of contact beyond which the linear program would take minutes."""
MOST_CONTACTS_TRIED = 40
"""Violated contacts up to which each is tried again, so that none is named without need."""
MOST_ROWS_TRIED = 2_000
"""Rows of contact up to which that is done."""
MOST_PATCHES = 40
"""Joints with more patches are not decided again without each."""
MOST_PATCH_SETS = 24
"""Sets of several patches that are tried, the smallest area first."""

# mobility/guides

PRESERVED_SHARE = 0.03
"""A patch mates along a motion whose velocity is within this share of tangential to it."""

# --- bodies/as_stated

ADMITTED = 0.02
"""Share of an intended motion that the freedoms of a contact may miss and still admit it: a degree, or a fiftieth of
the contact's size; axes are compared more finely where the types agree (KF403, KF404)."""
POINT_REACH = 1e-3
"""Of its distance from a stated joint, a contact at a point has at least this size: what blocks a turn there must not
seem small beside what a metre would."""

# questions.near_motion: what a small correction of one joint would free.

NEARLY = 0.02
"""Singular value of the closure over the greatest, below which a motion is nearly made: that of a hinge 2 % of the size
beside its place."""
NEARLY_APART = 10.0
"""The next singular value has to be greater by 1/(NEARLY · this), which is five times: else it is no single motion. A
choice."""
MOST_CORRECTED = 0.02
"""Greatest correction: rad, or shares of the size of the loops. What is off by more is another design."""
AS_SMALL = 1.5
"""Corrections up to so many times the least are told with it: any of them may be what is wrong."""
MOST_NEAR_RATES = 40
"""Joint rates of a block that is asked: each joint takes some hundred poses of it."""
NEAR_STEPS = (-0.6, -0.3, 0.3, 0.6)
"""Steps along the motion, of its rates together (rad, or shares of the size), at which loops have to close."""
NEAR_ROUNDS = 12
"""Rounds of Gauss and Newton; four or five are usual."""
NEAR_DIFFERENCE = 1e-5
"""Half the difference of a correction by which its effect is found."""
NEAR_RANK = 1e-9
"""Relative singular value below which unknowns are left as they are."""
NEAR_STRAYED = 1.0
"""Correction at which the search is given up."""
NEAR_SETTLED = 1e-13
"""Change of a round after which nothing more is gained."""
NEAR_CLOSED = 1e-12
"""rad, and shares of the size, by which loops may be open that close."""

# questions/afloat

AFLOAT_FACES = -0.93
"""Greatest cosine between the normals of two facets that face each other, 21°, as of freeform faces that rest on each
other: rounds in coarse meshes have no facets that oppose each other better."""
AFLOAT_BESIDE = -0.7
"""The same of facets that tell whether one of the two bends there, 45°: the neighbours of a facet of a coarse roller. A
face that stands askew, with an edge near, has one direction within that."""
AFLOAT_REACH = 1.02
"""Times the contact tolerance that such a part may keep from its sides, as for faces that fit: clearances of exactly
that are common, and rounding must not decide."""
AFLOAT_BENDS = math.radians(1.0)
"""rad: facets that differ by more bend."""
AFLOAT_DIGITS = 2
"""Of the coordinates of directions that are told apart, for the next."""
AFLOAT_OPPOSED = -0.5
"""Greatest cosine between the directions in which a part has its two sides for it to be between them. A wedge wider
than 60° pushes out what is in it; tapered rollers have 4° to 30°."""
AFLOAT_HELD = 0.5
"""Cosine from which on a contact keeps a part from going towards the other side: it hangs on what it touches then. The
pockets of cages hold rollers by up to 0.2."""
AFLOAT_OPPOSES = 0.35
"""Speed, of that of a unit motion of two bodies, at which a part between them is pressed and may hold it: 21°, by which
the facets of a roller that face its race may lean, while the race slides past."""
AFLOAT_BORE = -0.5
"""Least cosine of the normals of one round contact down to which it does not go round a part: 120°."""
