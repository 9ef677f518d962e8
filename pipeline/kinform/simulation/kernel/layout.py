"""Where the numbers of the kernel are: tables in three tuples, and the columns of each table.

Functions import from here what they use, grouped by the table that it belongs to: tables, their columns and kinds, rows
of [VECTORS], the clock, the tally, what the integrator returns, types.

The kernel takes `ints` and `nums`, the constants of a mechanism, and `work`, scratch space, as tuples of
two-dimensional tables, lists of rows where they are not compiled: few arguments of few types are what keeps
compilation short. Rates are numbered in the order of the tree, so that what carries a rate has a lower number.

State: y = (q, v, x, m, w): positions, rates, states of controllers and motors, meters of drives, work put in so far.

The names of the types below are what the signatures of the compiled functions are made from (`compiled`). Not compiled,
tables are lists of rows, which Python reads and writes several times faster than arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Row: TypeAlias = list[float]
"""Compiled, it knows not its length."""
Counts: TypeAlias = list[int]
"""Compiled, it knows not its length."""
Table: TypeAlias = list[Row]
Index: TypeAlias = list[Counts]
Ints: TypeAlias = Sequence[Index]
Nums: TypeAlias = Sequence[Table]
Work: TypeAlias = Sequence[Table]
Vector: TypeAlias = tuple[float, float, float]

# Tables of integers.
COUNTS, LINKS, COLUMNS, CLOSURES, SIGNALS, ACTORS, LOADS, SPRINGS, MODE, STOPS = range(10)

# Tables of numbers. LINKS, CLOSURES, SIGNALS, ACTORS, LOADS, SPRINGS and STOPS are as above.
CONSTANTS, SCALE, GEARS, PIECES = COUNTS, COLUMNS, MODE, 10

# Tables of scratch.
STATE, SCREWS, MASS, ROWS, HALF, REDUCED, VECTORS, STAGES, DENSE, MOTIONS, CARRIED, HANDLES = range(12)
"""MOTIONS: columns keep the loops closed. HALF: the mass matrix times them. CARRIED and HANDLES: of links and rates,
where they are articulated bodies (`articulated`)."""

# ints[COUNTS][0]
RANK, LED, POSITIONS, STATES, RATES, SIZE, METERS = range(7)
"""RANK of the loops for the rates that are not led; LED: how many rates are led; STATES: meters included; SIZE of the
state; METERS: how many of its numbers, before the last, are integrals of what drives do, on which nothing depends."""

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

# nums[SCALE], of rates: what moves points about one length; whether it moves nothing; inertia of rotors on it.
MASSLESS_COLUMN, ARMATURE = 1, 2

# ints[COLUMNS]
LINK, BEFORE, SIGNAL, METER = range(4)
"""BEFORE: the rate before on the chain to the ground, −1 for none. SIGNAL: that leads it, −1 for none. METER: the first
of three numbers of the state, integrals over time of the square of what leads it, of its power, and of the square of
that; −1 for none."""

# work[STATE]
ROT, POS, TWIST, GAIN, WRENCH, INERT = 0, 9, 12, 18, 24, 30
"""GAIN: acceleration at constant rates. INERT: m, m·c, then xx yy zz xy xz yz about the centre."""

# ints[MODE]: independent rows; rates in the order dependent, free, led; where each is in it. Of the rows as
# gathered and factored: for each dependent rate how far down rows reach that touch it or one before, and
# for each row the last dependent rate that it touches.
CHOSEN, ORDER, PLACE, LOWEST, REACH, STANDING, WAY = range(7)
"""STANDING: what articulated bodies make of each rate. WAY, its first number: 1 where they are the way to solve."""
MOVED, LED_RATE, MASSLESS_RATE = range(3)
"""MASSLESS_RATE: of a branch that closes a loop; the loop says what it does."""

# work[VECTORS]:
FORCE, ACC, NEED, GAP, GIVEN, PIVOT, REFERENCE, TRIAL, RIGHT, KEPT = range(10)
"""KEPT, its first number: smallest pivot over that of its choice, at the last projection; its next, whether links have
wrenches (`articulated`)."""
PULLED = 1

# work[CARRIED], of links, and work[HANDLES], of rates, after the six numbers of their screw.
REFERENCE_POINT, SPATIAL, PULL, LOADED, GOING, RUNNING, CARRIED_WIDTH = 0, 3, 39, 45, 51, 57, 60
"""SPATIAL: 6 × 6 inertia of what the link carries. PULL: the wrench that it needs itself. LOADED: with what it carries.
GOING: its acceleration over that at constant rates; RUNNING: of its reference, at those."""
REACTION, INVERSE, SURPLUS, ROTOR, HANDLE_WIDTH = 6, 12, 13, 14, 15
"""REACTION: inertia times the screw. INVERSE: of what the rate moves. SURPLUS: effort that is left for it. ROTOR:
inertia of rotors on it."""

# ints[ACTORS], and their kinds.
DOES, AT_Q, AT_V, LAW, FIRST_STATE, SECOND_STATE, METERED = range(7)
EFFORT, SPRING, DAMPER, SERVO, MOTOR, CONTROLLED = range(6)
"""METERED: as METER of rates. CONTROLLED: a motor with a controller."""

# ints[LOADS]: the link, whether it turns with it, and the signal that it is multiplied by.
TURNING, FACTOR = 1, 2

# ints[SPRINGS]: the links, and which law holds between their points.
ELASTIC = 2
STRAIGHT_SPRING, GAS, CUSHION = range(3)
"""CUSHION: a bushing."""
NEAR_STRAIGHT = 1e-4
"""Turns (rad) of a bushing below which 1/12 is its series: the next term is θ²/720."""

# nums[SPRINGS]: two points; then stiffness or force, damping, rest or length, column, exponent; of a bushing stiffness,
# torsion, their dampings and its axes, three numbers each.
MEASURE, TORSION, DAMPED, TORSION_DAMPED, TRIAD = 6, 9, 12, 15, 18

# nums[SIGNALS]: four numbers, the kind, first of its pieces and how many. Kinds: polynomial of degree one,
# sine, pieces of cubics.
STRAIGHT, WAVE, CURVE = range(3)
SHAPE, FIRST_PIECE, PIECE_COUNT = 4, 5, 6
"""Columns of the kind and of the pieces."""

COEFFICIENTS = 11
"""nums: of the integrator. Rows 0 to 15 a_ij, then b, c, both error estimates, four of dense output, and the numbers of
the evaluations of a step in the order of their times."""
B_ROW, C_ROW, E3_ROW, E5_ROW, D_ROW, ORDER_ROW = 16, 17, 18, 19, 20, 24

# ints[STOPS]; nums[STOPS] holds the limits.
STOP_Q, STOP_V, SENSE, HELD = range(4)
"""Position and rate of the joint, in which direction it may not go on (1 or −1), whether it is held there."""

# work[STAGES]: sixteen slopes, then the state tried, the new state, scratch, and what rounding does to slopes.
AT_END, TRIED, NEW, ROUND = 12, 16, 17, 19
"""AT_END: the slope at the end of the step; those before and after are of the method and of its dense output."""

# clock: times (s), tolerances, and what is known of the step on trial; tally: counts. Both are rows that the
# integrator changes.
NOW, END, STEP, RTOL, ATOL, CLOSED, NEAR, OPEN, MARGIN, TIGHTEST, KEEP, LEAST, PATIENCE, CROSSING = range(14)
"""STEP: the length to try next. MARGIN: the least of the run, at the time TIGHTEST. LEAST: the least of the step.
CROSSING: time of a singular pose ahead. The others are settings, see `Run`."""
SPAN, REACHED, ERROR, WEAR, GROWTH, MARGINS, NARROW, APPROACH, ENERGY, CLOCK = 14, 15, 16, 17, 18, 19, 32, 33, 34, 35
"""SPAN and REACHED: length and end of the step on trial. ERROR: its error over the tolerance. WEAR: smallest pivot over
that of its choice at its end. GROWTH: what the next may be longer by. MARGINS: at its twelve evaluations and its end.
NARROW: the margin below which branches are not told apart by what is known of lengths. APPROACH: the margin below which
a step that goes on towards a singular pose is reported. ENERGY (J): the greatest of motion and weights so far. CLOCK:
how many numbers."""
STEPS, BUDGET, NEXT, PAUSE, STIFF, SLOPES, FRESH, HIT, LAYINGS, TALLY = range(10)
"""Steps tried; how many may be in one call; the next output, and which to come back before; steps in a row that a decay
kept short; evaluations; whether stage 0 is to be computed; the stop reached; times that a step was laid anew; how many
counts."""

FAILED = 1e300
"""Error of a step whose evaluations could not be made."""

# What the integrator fills.
TIMES, OUT = range(2)
"""A row of the times (s) at which outputs are due; a row of output for each."""

# What the integrator returns, and what one attempt at a step does.
DONE, PAUSED, STUCK, STIFFENED, MASSLESS, OPENED, STOPPED, SPENT, WORN, TAKEN, REJECTED, TURNED, NEARING = range(13)
