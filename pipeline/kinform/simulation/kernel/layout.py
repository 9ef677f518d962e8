"""Where the numbers of the kernel are: tables in three tuples, and the columns of each table.

The kernel takes `ints` and `nums`, the constants of a mechanism, and `work`, scratch space, as tuples of
two-dimensional tables, lists of rows where they are not compiled: few arguments of few types are what keeps
compilation short. Rates are numbered in the order of the tree, so that what carries a rate has a lower number.

State: y = (q, v, x, w): positions, rates, states of controllers and motors, work put in so far.
"""

from __future__ import annotations

# Tables of integers.
COUNTS, LINKS, COLUMNS, CLOSURES, SIGNALS, ACTORS, LOADS, SPRINGS, MODE, STOPS = range(10)

# Tables of numbers. LINKS, CLOSURES, SIGNALS, ACTORS, LOADS, SPRINGS and STOPS are as above.
CONSTANTS, SCALE, GEARS, PIECES = COUNTS, COLUMNS, MODE, 10

# Tables of scratch.
STATE, SCREWS, MASS, ROWS, HALF, REDUCED, VECTORS, STAGES, DENSE, MOTIONS = range(10)
"""MOTIONS: columns keep the loops closed. HALF: the mass matrix times them."""

# ints[COUNTS][0]
RANK, LED, POSITIONS, STATES, RATES, SIZE = range(6)
"""RANK of the loops for the rates that are not led; LED: how many rates are led; SIZE of the state."""

# nums[CONSTANTS][0]
GRAVITY, LENGTH, LAST = 0, 3, 4
"""LAST: signals are evaluated at this time at the latest, so that a law ends with its own piece."""

# ints[LINKS]
PARENT, KIND, Q, FIRST, WIDTH, HEAVY, TIP = range(7)
"""TIP: the last rate of the chain that carries the link, −1 for the ground."""
SCREW, BALL, LLAB = range(3)
"""LLAB: a ball taken from its second body to its first."""

# nums[LINKS]
AXIS, POINT, SLIDE, WEIGHT, COM, TENSOR = 0, 3, 6, 9, 10, 13

# ints[COLUMNS]
LINK, BEFORE, SIGNAL = range(3)
"""BEFORE: the rate before on the chain to the ground, −1 for none. SIGNAL: that leads it, −1 for none."""

# work[STATE]
ROT, POS, TWIST, GAIN, WRENCH, INERT = 0, 9, 12, 18, 24, 30
"""GAIN: acceleration at constant rates. INERT: m, m·c, then xx yy zz xy xz yz about the centre."""

# ints[MODE]: independent rows; rates in the order dependent, free, led; where each is in it. Of the rows as
# gathered and factored: for each dependent rate how far down rows reach that touch it or one before, and
# for each row the last dependent rate that it touches.
CHOSEN, ORDER, PLACE, LOWEST, REACH = range(5)

# work[VECTORS]:
FORCE, ACC, NEED, GAP, GIVEN, PIVOT, REFERENCE, TRIAL, RIGHT, KEPT = range(10)
"""KEPT, its first number: smallest pivot over that of its choice, at the last projection."""

# ints[ACTORS], and their kinds.
DOES, AT_Q, AT_V, LAW, FIRST_STATE, SECOND_STATE = range(6)
EFFORT, SPRING, DAMPER, SERVO, MOTOR, CONTROLLED = range(6)
"""CONTROLLED: a motor with a controller."""

# nums[SIGNALS]: four numbers, the kind, first of its pieces and how many. Kinds: polynomial of degree one,
# sine, pieces of cubics.
STRAIGHT, WAVE, CURVE = range(3)

COEFFICIENTS = 11
"""nums: of the integrator. Rows 0 to 15 a_ij, then b, c, both error estimates, and four of dense output."""
B_ROW, C_ROW, E3_ROW, E5_ROW, D_ROW = 16, 17, 18, 19, 20

# work[STAGES]: sixteen slopes, then the state tried, the new state, scratch, and what rounding does to slopes.
TRIED, NEW, ROUND = 16, 17, 19

# clock: times (s) and tolerances; tally: counts; both are rows that the integrator changes.
NOW, END, STEP, RTOL, ATOL, CLOSED, NEAR, OPEN, MARGIN, TIGHTEST, KEEP, LEAST, PATIENCE = range(13)
CROSSING, MARGINS, CLOCK = 13, 14, 26
"""Time of a singular pose ahead; margins at the twelve evaluations of a step; how many numbers."""
STEPS, BUDGET, NEXT, PAUSE, STIFF, SLOPES, FRESH, HIT = range(8)

NOISE = 1e-13
"""Relative rounding of accelerations, times the pivots' ratio: what remains of closed loops."""

# What the integrator fills.
TIMES, OUT = range(2)
"""A row of the times (s) at which outputs are due; a row of output for each."""

# What the integrator returns.
DONE, PAUSED, STUCK, STIFFENED, MASSLESS, OPENED, STOPPED, SPENT, WORN = range(9)
