"""Constants of the simulation: every number that decides something and that no user sets (`SolverSettings` has those).

Gaps of loops are in rad and in shares of the mechanism's length; a margin is the smallest pivot of the loops over the
largest, 0 in a singular pose. The kernel's functions are compiled with the values of these numbers in them:
`kernel.compiled` compiles afresh where one has changed.
"""

from __future__ import annotations

# of_system: what a run may give.

OUTPUT_NUMBERS = 100_000_000
"""Numbers that a run gives in all, at all output times: 800 MB in the results file, and three times that while they are
computed. A four-bar has a hundred at each time."""
OUTPUT_TIMES = 10_000_000
"""Output times of a run, whatever it gives at each."""

# kernel.explicit: control of steps, end stops, crossings of singular poses.

SAFETY = 0.9
"""Share of the step that would just keep the tolerance: what Hairer's DOP853 takes."""
ERROR_ROOT = 0.125
"""The error of a step of order 8 grows with this root's inverse power, the eighth, of its length."""
LEAST_SHRINK = 0.2
"""Share of a step below which the next is not made after an error, however great: a choice."""
LEAST_SHRINK_AT_CROSSING = 0.6
"""The same near a singular pose, where the error may be that of one evaluation: a choice."""
HOPELESS_ERROR = 1e30
"""Error over the tolerance from which on its root tells nothing, and the least share is taken."""
GREATEST_GROWTH = 2.5
"""Greatest growth of a step: with more, one can land far outside the region of stability unnoticed."""
EASY_ERROR = 0.4
"""Error over the tolerance below which a step that was cut short does not shorten the next: a choice."""
SHORTEST_STEP = 1e-13
"""Share of the time (of 1 s at least) below which a step is none: a few hundred roundings of the time."""
REOPENED_SHRINK = 0.25
"""Share of a step to try where loops could not be closed at its end: a choice."""
SHORTEST_CLOSING_STEP = 1e-9
"""s: steps so short that still leave loops open end the run."""
STABLE_DECAY = 3.0
"""Step times the fastest decay: the method is stable up to about 6."""
REAL_ROUGHNESS = 10.0
"""Times the noise of accelerations that a change of slopes has to be to count as a decay: a choice."""
LEAST_REAL_MARGIN = 1e-6
"""Margin below which the noise of accelerations is not taken to grow further: bounds a quotient."""
MOST_LAYINGS = 4
"""Times that a step is laid anew to avoid a singular pose."""
LAID_ALIKE = 0.01
"""Share of a step: one that differs by less from the last is not worth trying."""
ROUNDINGS_EVERY = 20
"""Steps after which roundings are looked at again."""
STOP_PARTS = 4
"""Parts of a step in which a joint turns back at most once: steps are far shorter than what moves in them."""
STOP_PASSED = 1e-12
"""rad or m beyond a limit that is passed: less is rounding."""
TURN_HALVINGS = 40
"""Halvings of a part of a step to find where a joint turns: to 1e-12 of it, enough where the curve is flat."""
STOP_HALVINGS = 60
"""Halvings of a step to find where a stop is passed: to the last bit of its share."""
CROSSING_AROUND = 0.1
"""Share of the step about the place where a singular pose is expected, within which it is."""
CROSSING_NARROWINGS = 12
"""Times that this is narrowed, to two thirds each."""

CORNER_TURN = 0.05
"""Curvature of the motion times the margin from which on it turns from one branch of the loops into another. At the
tip of such a corner it is 0.2 to 3, wherever lengths differ by 1e-12 to 1e-3 of themselves; where branches cross it is
the margin times the curvature of either, below 0.005."""

# kernel.crossings: how a step is laid across a singular pose.

WIDEST_GAP = 0.4667
"""Share of the step: middle of the widest gap between evaluations, from a third to three fifths."""
CROSSING_CLEAR = 0.08
"""A share of the step: evaluations nearer to a singular pose than this are to be avoided."""
CROSSING_AHEAD = 1.2
"""A pose so far, in steps, is near the step's end."""
SLOPES_ALIKE = 0.5
"""Slopes of a line agree when the lesser is more than this share of the greater."""
CROSSING_PASSED = 0.05
"""Share of the step: a pose nearer ahead than this is as good as passed."""
NEAREST_APPROACH = 0.2
"""Least share of the way to a singular pose that a step towards it goes: a choice."""

# kernel.steps: one step and its error.

CLOSED_SHARE = 1e-4
"""Loops at an evaluation of a step are closed to this share of the tolerance."""
DISTURBANCE = 2.0**-51
"""A rounding or two of a number, as a share of it."""
ROUGHER_SLOPES = 4.0
"""Times what one disturbance does to the slopes: others do more."""
THIRD_ORDER_SHARE = 0.01
"""Weight of the estimate of order 3 beside that of order 5 in the error of a step: that of Hairer's DOP853."""
ROUNDING_NOISE = 1e-13
"""Relative rounding of accelerations, times the pivots' ratio: what remains of closed loops."""
LEAST_NOISY_MARGIN = 1e-5
"""Margin below which the noise is not taken to grow further: bounds a quotient."""

# kernel.equations: projection onto closed loops.

TORN_GAP = 1e-4
"""Rows that depended on others leave a gap (rad, or lengths) at most as large as the rank overlooks."""
SLOW_CORRECTION = 0.05
"""Corrections that leave more than this share of a gap are made by new factors."""
FACTORS_STALE = 1e-9
"""rad, or lengths: a correction of a gap so small moves so little that the factors serve once more."""
MOST_CORRECTIONS = 10
"""Corrections of a pose; they converge in three or four."""

# kernel.loops, kernel.choice: pivots.

PIVOT_SWAP = 1.5
"""Rows change places for a pivot so many times as large: order is no matter of the mathematics."""
CLOSING_PIVOT = 0.3
"""Pivots of the joints that close loops are taken first while they are larger than this: a choice."""

# mechanism.construction: the size of a mechanism.

ONE_PLACE = 1e-6
"""Share of the greatest radius of gyration within which joints and centres of mass are at one place: rounding, and what
fits of axes differ by."""

# mechanism.dynamics: motions without mass.

NO_MASS = 1e-13
"""Share of the greatest inertia of a free motion below which one has none."""
MOVES_WITHOUT_MASS = 1e-6
"""Share (rad, or lengths) of a joint in such a motion from which on it is named."""

# solver.start: initial positions and velocities.

LEAST_MOTION = 1e-9
"""Share of the greatest rate above which rates are motions."""
REMEMBERED = 2_000_000
"""Numbers of the rows whose decomposition is kept for who asks for it next."""
EVEN = 0.1
"""Share of the singular value before it above which one goes on with those that count: of n four-bars in a row the
least are 3, 2 and 1 times 0.27/n of 3.3, and fall below 1e-4 of the largest from n = 150 on. A choice."""
FALLEN = 1e-4
"""Share of the singular value before it below which one is nothing: rounding is 1e-12, what snapping leaves 1e-8. Where
values neither go on nor fall so, the share of the largest decides alone. A choice."""
START_SHARE = 0.03
"""Of a motion (rad, or lengths) from the start that shows whether the loops bear it."""
START_GAP = 0.01
"""Share of the square of that motion: loops that open by more do not bear it, as its curvature opens them by less."""
START_NAMED = 1e-6
"""Share of the greatest rate of a motion that tears loops from which on a joint is named."""
CONTRADICTION, CONTRADICTION_LEAST = 1e-9, 1e-12
"""Relative and absolute difference (rad or m, a second) from a law of motion that an initial value may have."""

# solver.follow, solver.kinematic: joints that are led.

DETERMINED = 1e-8
"""Share (rad, or lengths) of a rate in what led joints leave open, from which on they do not determine it."""

# solver.run, solver.dynamic: the drive of the kernel.

FIRST_STEP = 1e-3
"""s: the first step that is tried in a stretch; the control finds the right one in a few steps."""
STIFF_PATIENCE = 15.0
"""Steps in a row that a decay kept short before the run is looked at for stiffness: those of Hairer's DOP853."""
PASSED_BEFORE_STOP = 1e-3
"""s: a singular pose nearer than this to where a run stopped is why it did, and was not passed."""
PLAIN = 20_000
"""Evaluations times links that are made without the compiled functions: 25 μs each, 60 in loops, so about as long
as loading them takes."""
UNREADY = 10
"""Times more where they would have to be compiled first."""
LONGER = 1.5
"""Times the plain evaluations that a run must promise to take before it is compiled early: its pace may fall."""
SHOWN = 60
"""Steps from which on the whole run can be told to be longer than that."""
PASS = 200
"""Multiplications a rate of one pass of articulated bodies along the tree (`kernel.choice.way`). Counted; with it the
two ways take as long as each other where they are said to."""
LARGE = 1000
"""Rates times independent rows of the loops from which on plain functions would take too long at all."""
STALL = 1000
"""Steps after which the run must have come on: at their pace it would take ten times its budget."""
STALLED_BUDGETS = 10.0
"""Budgets of steps that a run may promise to take before it counts as stalled."""
LOOK = 250
"""Steps after which the run is looked at for stiffness."""
REPORTS = 50
"""Times at least that the progress of a run is told."""

# mechanism.mechanism, solver.follow, kernel.explicit: what is known of lengths.

CORNER_MARGIN = 2.0
"""Margin of a corner over the root of the difference in lengths that makes it, as a share of the mechanism's length:
at most."""

LENGTH_SIGMAS = 3.0
"""Standard uncertainties by which lengths may be off: beyond it chance is below 1 %."""
ONE_DIRECTION = 1e-12
"""Sine between axes that were made parallel: rounding."""
LENGTHS_ROUNDED = 1e-13
"""Share of the mechanism's length by which lengths that are exact in double precision may be off: a few hundred
roundings, as poses are products of many factors."""

# solver.leap, solver.collocation: across singular poses.

AT_LIMIT, AT_LIMIT_SHARE = 0.05, 0.1
"""Margin of the loops for what is not led, and its share of that for all rates, below which a run that cannot go on
has come to the end of what the loops let be led. Runs end at margins of a hundredth and less. A choice."""
APPROACHED = 3e-3
"""Margin below which a step that ends there was not laid across a singular pose ahead, but came too near."""
FAR_BEHIND = 3.0 * APPROACHED
"""Margin above which a pose that could not be leaped over is behind, and others are looked for: a choice. Forty
four-bars in a row never come above 0.05."""
LEAP_MARGIN = 0.02
"""Margin, by singular values, below which a singular pose may be ahead; and below which rows of the loops are about to
depend on others: a choice."""
LEAP_REACHES = (0.025, 0.05, 0.1, 0.2, 0.4)
"""How far a step reaches from the pose to either side, tried from the first on: rad, or lengths, that the fastest joint
moves. The error of the stages' slopes goes with the inverse square of it, what the polynomial leaves out with its
twelfth power; for chains of 2 to 40 four-bars the first that are tried agree to 1e-12."""
LEAP_SHORTEST = 0.5
"""A step begins so much farther before the pose than the run has come to, as a share of that distance."""
LEAP_COARSE, LEAP_FINE = 6, 8
"""Stages of the two steps that are compared: even, as none may lie in the middle."""
LEAP_ACCURATE = 1e-12
"""Difference between them (rad, lengths, also a second, or a share of that where it is more) that is good enough: a
hundredth of the tolerance of a step."""
LEAP_ERROR = 1e-8
"""Difference beyond which the run is left as it is: what a run of ten seconds gathers at the default tolerance."""
LEAP_NEARER = 100.0
"""A step that errs so many times as much as one that is shorter is too long, and longer ones are not tried."""
LEAP_TURNED = 0.1
"""Share of itself that the least singular value must have as its negative behind the pose: straight on it has all."""
LEAP_TOLERANCE = 1e-12
"""Relative and absolute error a step of the way back."""
LEAP_EVALUATIONS = 4000
"""Evaluations of a way back before it is given up; a hundred are usual."""
COLLOCATION_ROUNDS = 40
"""Iterations of the stages; five to ten are usual."""
COLLOCATION_SETTLED = 1e-15
"""Change of a state (rad, lengths, also a second) by one that ends them; below its root they also end where the noise
of slopes keeps it from falling to half."""
NODE_ROUNDING = 1e-16
"""Newton's last correction of a node: below its last bit."""
CROSSED_GAP = 1e-12
"""What is open at a pose in which branches cross exactly (rad, shares of the length): the polynomial's rounding."""

# solver.stiffness, solver.implicit: stiff models, and vibrations too fast to be followed.

FAST_DECAY = 0.4
"""Decay within a step, as an exponent, from which on it is what limits the step."""
VIBRATES = 0.05
"""Phase (rad) of a vibration within a step from which on it is what limits the step: with the tolerances it is 0.3 to
1, whatever the amplitude, as that of a vibration which matters is far above them."""
JACOBIAN_STEP = 1e-6
"""Share of a number of the state (of 1 at least) by which it is changed for the derivative: the third root of a
rounding, at which rounding and curvature disturb central differences alike, but for a factor of six."""
DAMPING_STEP = 100.0
"""Phase (rad) of the fastest vibration in a step that damps it, by 0.03; one of a tenth of its frequency by 0.3, one of
a thousandth by 1e-9 of itself."""
DAMPS = 30.0
"""Phase from which on a step counts as damping: by 0.1."""
DAMPING_STEPS = 16
"""Steps that damp: a vibration to 1e-16 at least of what it was."""
WITHOUT_CONTROL = 1e3
"""Relative and absolute error a step that no step has: errors do not control the steps that damp."""
DAMPING_SETTLED = 1e-10
"""Newton's last correction in such a step, over the state and 1."""
DAMPING_NEWTON = 0.03
"""The same as a share of the change by the step before."""
STIFF_ROUNDING = 1e-12
"""Rounding of a position (rad, lengths): times the frequency it is what rates are known to; ten thousand last bits."""
STIFF_NEWTON = 0.01
"""Newton's last correction over the error allowed, where rates are only known to such roundings."""
DAMPING_GAIN = 1e-6
"""Share of the kinetic energy that such steps may add: what they damp they never make more, and slow motion is kept far
better."""
DAMPED_AHEAD = 2000
"""Implicit steps still to go from which on a vibration that has come up again is damped again."""
MOST_DAMPINGS = 1000
"""Times that vibrations are damped in one run: after it they come up too often."""
FIRST_IMPLICIT_STEP = 1e-6
"""s: short enough for decays that begin; Radau lengthens it tenfold a step."""
REAL_ROOT = 1e-12
"""Imaginary part of a root of a cubic that is real but for rounding."""

# solver.stops: impacts and held stops.

MOST_IMPACTS = 1000
"""Impacts in one run, after which it chatters."""
STOP_MOVES = 1e-9
"""Share of a joint in the motions that are left, from which on it moves in one of them."""
SLOW_LEAP = 1e-7
"""rad/s or m/s: leaps from stops so slow that they end at once."""
AT_STOP = 1e-9
"""rad or m: so far beyond a stop a joint is at it."""
IMPACT_ROUNDING = 1e-6
"""Share of the greatest pace at an impact up to which a joint may seem to go on beyond its stop."""
LAW_PARTS = 8.0
"""Parts of half a period of a law that a step may be as long as while a stop holds: in longer ones push turns to pull
and back unseen."""
RELEASE_HALVINGS = 40
"""Halvings of a step to find where a stop begins to pull: to 1e-12 of it."""
RELEASE_PARTS = 4
"""Parts of a step at whose ends a held stop is asked whether it pulls."""
RELEASE_BUDGET = 1000
"""Steps to go again from the start of a step to a time within it."""

# simulation.of_system: what is said of a run.

SNUG = 1e-8
"""Gap (m or rad) up to which loops count as closed: those that fit exactly stay a million times below."""
TRUSTED_DRIFT = 1e-5
"""Drift of the energy over the energy exchanged; runs at the default tolerances stay a hundred times below."""
SUMMED_DRIFT = 1e-8
"""Drift of the energy over the kinetic energy that is no sign of anything, ten times that of sound runs."""
LEAST_DRIFT = 1e-12
"""J: drift of the energy that is rounding."""
INERTIA_ROUNDING = 1e-9
"""Share of the greatest number of an inertia by which it may be unsymmetric or have a negative moment."""
LAST_OUTPUT = 1e-9
"""Share of the output step within which the end of a run is the last multiple of it."""

# simulation.levels: what is said of teeth.

WHOLE_TURN = 1e-6
"""rad: teeth whose pitches make a turn to within this go all round."""

# outcome: reactions and their balance.

UNDETERMINED_SHARE = 1e-6
"""A component of a wrench that the choice of λ changes by more than this share of itself is not determined."""
UNSEEN = 1e-13
"""Of the most that a condition sees of a wrench in a loop: less of a direction of it is rounding, and none is seen."""
FEW_MEET = 0.05
"""Share of all products of two directions in a joint up to which those that are not nought are summed one by one."""
CHUNK = 128
"""Times whose reactions are solved at once."""
RANK_CHUNK = 256
"""Times whose ranks are found at once."""
VANISHING_WRENCH = 1e-6
"""Share of the greatest wrench of the run below which wrenches are no measure of errors."""
DEPENDENT_GEARS = 1e-12
"""Share of the greatest singular value of the gears' rows below which one depends on the others."""
NO_TURN = 1e-12
"""Half of an angle (rad) below which a turn has no axis."""

# solver.slip and solver.stick_slip: friction.

SLIP_STEEPEST = 1.0 - 1e-9
"""Growth of friction with itself, by the loads that it causes, from which on its answer is not unique (theory: 1)."""
SLIP_ROUNDS = 2000
"""Rounds of the fixed point: with a growth of 0.98 so many reach rounding; ordinary joints take under ten."""
SLIP_SETTLED = 1e-15
"""Change of a round over the friction at which it is settled: rounding."""
SLIP_PARTS = 8
"""Parts of a step at which rates are looked at for a reversal: more often than a polynomial of order 7 turns."""
STICK_PARTS = 4
"""Parts of a step at which what sticks is looked at; laws that swing shorten the steps (`Contact.longest`)."""
STICK_ROUNDING = 1e-12
"""Share of the limit by which what holds may exceed it and still sticks: a block at exactly atan μ stays."""
SAME_MOTION = 1e-9
"""Sine of the angle between the ways in which two frictions depend on the free motions, below which it is one."""
DEAD_CENTRE = 1e-6
"""Share of a free motion below which a joint takes no part in it, as at a dead centre: its rate turns."""
OTHER_WAY = 1e-6
"""Share of a surface's speed along the direction that has friction from which on it slides along others too."""
MOST_SWITCHES = 100_000
"""Changes between sticking and slipping before a run gives up."""
SWITCHES_AT_ONCE = 8
"""Changes at one and the same time, for each friction, before a run gives up: three are ordinary."""

# --- spectra ----------------------------------------------------------------------------------------------------------

UNEVEN = 1e-6
"""Share of the first step by which others may differ from it: times are sums of steps, with their rounding."""
LEAST_SAMPLES = 16
"""Samples of a spectrum, at least: the window alone is four of its frequencies wide."""
LEAST_LINE = 3e-2
"""Share of the greatest amplitude that a line has at least: the lobes of the window beside a line have up to 2.7 % of
it."""
NO_LINE = 1e-9
"""Share of the greatest sample below which a line is rounding."""
MOST_LINES = 3
"""Lines that are named."""
LEAST_PERIODS = 8.0
"""Periods below which an envelope says no more than the curve."""
LEAST_IN_PERIOD = 4.0
"""Samples of a period, at least, for its extremes to be among them."""
