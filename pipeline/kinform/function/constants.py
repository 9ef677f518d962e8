"""Numbers by which questions about function are answered, by the module that uses them."""

from __future__ import annotations

import math

# --- configurations ---------------------------------------------------------------------------------------------------

LOOPS_CLOSED = 1e-9
"""Residual (rad, share of the size) at which loops count as closed."""
CLOSING_STEPS = 40
"""Newton's steps to close loops, after which they cannot be closed."""
CLOSING_STEP = 0.3
"""rad, or share of the size, that one of these steps changes a coordinate at most."""
DEPENDENT = 1e-7
"""Relative singular value below which constraints depend on each other, as in the count of freedoms."""
SOLVED = 1e-9
"""The same in least squares."""
RATE_MOVES = 1e-6
"""Rate of a coordinate in a unit motion above which it takes part."""
BODY_MOVES = 1e-9
"""Twist of a body in a unit motion above which it moves."""
ONE_POINT = 1e-9
"""Share of the largest part's size within which the joints of a chain are at one point; rounding."""

# --- acted freedoms ---------------------------------------------------------------------------------------------------

FREEDOM_AT_REST = 1e-6
"""Share of the fastest joint's rate (slides over the size) below which a freedom of a joint is at rest in a motion:
far above rounding, and far below what the ends of a ram turn or slide when it moves."""

# --- clearances -------------------------------------------------------------------------------------------------------

GRID = 8
"""Divisions of a triangle's side by points between which a place to look at is found; a choice."""

# --- coverage ---------------------------------------------------------------------------------------------------------

SAMPLES = 4000
"""Configurations in the box of ranges."""
WALK = 600
"""Configurations along closed loops."""
WALK_STEP = 0.25
"""rad, or share of the size, of a step of that walk in the coordinate that moves most; a choice."""
WALK_TRIES = 8
"""Steps for each configuration after which the walk ends."""
RANGE_ROUNDING = 1e-9
"""rad, or share of the size, by which such a step may leave a range."""
STARTS = 6
"""Samples from which each target is approached."""
AGAIN = 40
"""How many of the farthest targets are approached again, ..."""
STARTS_AGAIN = 48
"""... and from how many samples."""
TOGETHER = 400
"""Approaches that are made at once, so that their arrays stay small."""
TURNS = 60
"""Steps of an approach at most."""
TARGET_CLOSED = 1e-8
"""Residual at which the loops of an approach count as closed."""
FAR = 1.0
"""Loops may close in several ways: what is farther (rad, or sizes) from all that the walk came through is not
counted."""
STIFF = 10.0
"""Weight of a loop that is open beside a target that is missed."""
DAMPING = 1e-3
"""Levenberg and Marquardt's damping at the start, ..."""
DAMPING_BETTER = 0.2
"""... its factor after a step that came nearer, ..."""
DAMPING_WORSE = 5.0
"""... and after one that did not: textbook values."""
DAMPING_RANGE = (1e-12, 1e6)
"""Where it stays."""
DAMPING_STUCK = 1e2
"""When no approach comes nearer and none is damped by less, all have ended."""
APPROACH_STEP = 0.5
"""rad, or share of the size, that one step changes a coordinate at most."""
AT_BOUND = 1e-12
"""How near a coordinate is to the end of its range when it is held there."""

# --- fits -------------------------------------------------------------------------------------------------------------

OPPOSED = -math.cos(math.radians(1.0))
"""Cosine of normals below which two planes face away from each other."""

# --- holding ----------------------------------------------------------------------------------------------------------

STILL = 1e-9
"""Twist of a body in a unit motion below which it does not move."""
POSE_STEPS = 20
"""Steps in which joints are brought to a pose, so that loops are followed and not jumped."""
MOVES = 1e-6
"""Rate by which a joint may miss a unit motion that is asked of it."""
NO_WORK = 1e-6
"""Share of the work of the joint's motion that forces may do along what else is free, ..."""
LEAST_WORK = 1e-9
"""... and W below which that motion counts as so much."""

# --- regions ----------------------------------------------------------------------------------------------------------

INSIDE = 240
"""Directions inside of a cone."""
RIM = 48
"""Directions on its rim."""
ALONG = 7
"""Places along each edge of a box."""

# --- sweeps -----------------------------------------------------------------------------------------------------------

BUDGET = 4000
"""Poses that are measured before giving up."""
FIRST = 1e-3
"""Share of the shortest step to which the first pose that falls short is found."""
FLOOR = 1e-4
"""Shortest step, of the size of the smaller group, ..."""
FLOOR_TOGETHER = 10.0
"""... and how many times that where several joints move at once."""
