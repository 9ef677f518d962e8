"""Motion through time: how a run is started, stepped and ended. This is how a step is controlled.

The state. y = (q, v, x, w): positions and rates of the tree of primitive motions, states x of controllers and
motors, and the work w that drives, dampers and loads have put in. A joint that closes a loop has coordinates like
any other (`mechanism.mechanism`), so q and v are more than the freedoms, and the loops are conditions g(q) = 0 and
G v = 0 on them. Joints that a law leads are put on their law wherever y is evaluated. The derivative
(`kernel.equations`) is explicit: composite rigid bodies and recursive Newton and Euler give mass matrix and forces
(Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 and 6), and the loops are eliminated: with rates
ordered dependent, free, led, motions E = (−B; 1) keep them closed, and Eᵀ(M a − f) = 0 has as many unknowns as
there are freedoms. Long trees with few loops go another way, of the same result, in time that grows as their links
(`kernel.articulated`; `kernel.pivoting.choose_method` decides by what either costs).

Which rows count. Redundant loops have dependent rows. Their rank is decided once, at the start, by singular values;
rows and dependent rates are then chosen by complete pivoting (`kernel.pivoting`), those of joints that close loops
first, and kept. Each evaluation eliminates in that order. When a pivot has fallen to a tenth of what it was when
chosen (`SolverSettings.keep`), the kernel comes back (WORN) and the choice is made again. The margin, smallest
pivot over largest, tells how far the pose is from a singular one.

One step. The method is that of Dormand and Prince of order 8 (Hairer, Nørsett and Wanner, Solving Ordinary
Differential Equations I, section II.5, and their program DOP853): twelve evaluations, and three more where values
within the step are wanted, which give a polynomial of order 7. Two estimates of the error, of orders 5 and 3, are
combined as they do. Each component counts by atol + rtol·|y| and by what rounding of y does to its slope, which is
measured every 20 steps: light bodies in heavy mechanisms lose more digits than the tolerances leave. A step is
taken when the error over that is below 1 (`kernel.steps.try_step` finds the error; `kernel.explicit.attempt` takes or
shortens, `accept` goes on). The next is 0.9·error^(−1/8) times as long, at most 2.5 times, and no
longer than before right after a failure.

Closing the loops. Integrating accelerations lets loops drift apart. At the end of each step y is projected onto
them (`kernel.equations.project`; Hairer and Wanner, volume II, section VII.2): least corrections by mass, of
positions by Newton and then of rates. Where the margin is below 0.1 (`near`) every evaluation whose loops are open
is projected too: the error of accelerations grows with the inverse square of the margin there.

Singular poses. Where the margin falls to zero within a step like a V, accelerations are 0/0 with a finite limit,
and shorter steps only bring evaluations nearer to it. `kernel.crossings` finds the tip of the V from the margins at
the twelve evaluations and lays the step so that the tip falls into the widest gap between them (0.4667 of the
step). A run that passes a pose below `doubtful` says so, as the loops could go on in several ways. Where lengths differ
by ε from those whose branches meet, the margin falls to about √ε and the motion turns there from one branch into the
other; where ε is within what is known of the lengths, the run ends (TURNED).

Friction. What a joint rubs with is a limit that grows with the loads it carries, and those depend on friction
(`mechanism.rubbing`: the law; `friction_forces`: all of them at once, or that they have no single answer). Where a
joint comes to rest it sticks until more is asked of it than the limit (`stick_slip`: when; `sticking`: whether).

What interrupts. Laws are smooth between knots, so a stretch ends at each knot and the next begins with a short step
(`dynamic`). An end stop that the dense output passes is found by halving, and the step ends there (`stops`): rates
take the impact (Moreau 1988; Newton's restitution), and the joint is held like a led one until the stop would have to
pull. A change of what is led makes new tables, a new rank and a new choice.

Stiff models. The kernel comes back where the change of slopes over the change of states between the last two
evaluations, times the step, exceeds 3 for 15 steps in a row, as DOP853 tests for stiffness; at tight tolerances
that finds nothing, so a run is looked at every 250 steps in any case. The eigenvalues of the derivative then
decide: where one decays as fast as the steps are short, and 20,000 of them are still to go
(`SolverSettings.ahead`), Radau IIA of order 5 goes on (`implicit`; volume II, section IV.8), with looser tolerances
and the same projection. Where instead the springs vibrate so fast that the steps left would be used up, and outputs
do not show it, the same method first damps the vibration (`stiffness.vibration`, `paces`).

Two examples, as they were computed at the default tolerances. A point mass on a bar of 1 m is let go 1 rad below
level. Steps grow 2.5-fold from 1 ms (errors of 3e-11 to 5e-7), then settle near 0.09 s:

      t (s)    tried (s)   error       then
    0.0254     0.0391      0.0008      0.0391 · 0.9 · 0.0008^(−1/8) = 0.0391 · 2.2 = 0.0860
    0.0644     0.0860      0.44        0.0860 · 0.997 = 0.0857
    0.3249     0.1146      0.71        0.1146 · 0.939 = 0.1076
    0.4395     0.1076      1.69        rejected: 0.1076 · 0.843 = 0.0907
    0.4395     0.0907      0.43        0.0907 again: no growth after a failure

18 attempts take it through one second. Two four-bars in a row, let go with −1 rad/s, pass the pose in which all bars
lie in a line at 0.7143 s:

    0.5782     0.0780      0.067       margin down to 0.068: 0.0780 · 1.26 = 0.0984
    0.6562     0.0984      9.6         margin 0.0011 at an evaluation, tip of the V at 0.71433 s:
                                       0.0984 · 0.679 = 0.0668, laid to end 0.4667 · 0.0668 = 0.0312 s before the tip
    0.6562     0.0270      8e-5        0.0668 as wanted
    0.6832     0.0668      0.54        across: least margin of the evaluations 0.011
    0.7500     0.0650      1.17        rejected, and on as usual
"""
