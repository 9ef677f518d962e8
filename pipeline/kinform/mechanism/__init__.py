"""The mechanism that joints make of bodies: its graph, its coordinates, and the closure of its loops.

How a loop is closed
====================

Bodies are the nodes of a graph, joints its edges. Along a tree of joints every joint moves as it likes. Where joints
make a loop, walking round it must come back to where it began, and that ties their motions.

Graph. Loops that share a joint are decided together, others apart. So the graph is cut into its biconnected blocks
(Hopcroft and Tarjan 1973; `foundation.graphs.graph.blocks`). A block of one joint is a bridge: it closes nothing, and
all its freedoms stay. In a block of e joints and n bodies there are e − n + 1 independent loops, and short ones are
chosen (`foundation.graphs.cycles`), for people read about them, and rows of short loops are small.

Rates. Joint k has a basis of twists S (ω; v at the world's origin), and moves its second body relative to its first
by Sθ̇. Of a loop the sum of all relative twists, each in the sense in which it is walked through, is zero: six
equations a loop in the joint rates (Davies 1981). Twists are scaled about the middle of the block's axes, so that
turns and slides compare, and each column is divided by its length. What the null space has, moves at first order: its
dimension is the block's part of the mobility. Up to 160 rates all equations are solved at once by singular values,
where values below 1e-7 of the largest are zero; larger blocks are reduced loop by loop (`block_rates`). The
solutions are readable: each is driven by one joint at rate 1 while the other drivers rest, and joints near ground are
rather chosen. `first_order` puts the blocks together, and adds six freedoms for each tree that hangs on nothing.

Redundancy. Six equations a loop seldom are independent. Those that depend on the others are what the joints hold more
than once: stress that assembly may lock in.

Configurations. Rates that close the loops at this pose need not be the beginning of a motion. `loop_system` has
the same loops in joint coordinates q: a product of exponentials exp(S q) round a loop must be the identity (Brockett
1984). It gives the residual and the Jacobian (the equations above, at q) of its closure
equations, and their curvature. `linkage` adds the bodies that hang on the loops, and values of joints: it is the one
model of a mechanism for the page, the ranges, reach and mobility, as `spanning_tree` is the one graph.

Closing. `closing.close` finds the configuration near a given one at which all loops close, by Gauss and Newton. Its
parts are arguments: how many equations are independent (`rank`), the least change that meets these (`least_change`),
how far a step may go, and when to end. `pose` has the freedoms of first order at a closed configuration.

A four-bar
----------

Hinges along z at A (0, 0), B (0, 100), C (300, 200) and D (400, 0) mm; A and D on the base. The joints are
base–crank, crank–coupler, coupler–rocker and, walked backwards, base–rocker. The middle of the axes is (200, 100) mm,
L = 223.6 mm. The matrix of the one loop, columns A, B, C, D:

    ω_x         0        0        0        0
    ω_y         0        0        0        0
    ω_z     0.707    0.745    0.845   −0.707
    v_x    −0.316    0        0.378    0.316
    v_y     0.632    0.667   −0.378    0.632
    v_z         0        0        0        0

Singular values 1.52, 1.17, 0.56 and 1e-16: rank 3, so 4 − 3 = 1 freedom, and 6 − 3 = 3 equations too many, as of
every planar loop: ω_x, ω_y and v_z are held by each hinge. Where the crank turns by 7, the hinge B turns by −8, C by
4 and the rocker by 3. Grübler's count alone would be 4 − 6 = −2.

Tilt the axis at D by 1e-6 rad, the rounding of a mesh file, and the fourth value is 2e-7: no freedom, a rigid
structure. That is why axes that agree within their uncertainties are made exactly parallel before
(`kinematics.joints.axes.snapping`).

First order and distance. Stepped 0.05 rad along its freedom and closed again, the four-bar keeps 0.99999 of the step:
the freedom is a motion. Stretch it: hinges in one line at x = 0, 100, 300 and 400 mm, where the links of 100, 200 and
100 mm just reach. Now v_x says nothing, the values are 1.61, 1.18, 0, 0: two freedoms at first order. Of a step 2e-6
is left, the loop pulls it back: finite mobility 0, shaky. Fold it: A, B, C, D at x = 0, 100, 400 and 300 mm. Two
freedoms again, steps along two directions are kept in full, and beside the pose each way has one freedom: finite
mobility 1 at a bifurcation.

Sources: Davies, Kirchhoff's circulation law applied to multi-loop kinematic chains, 1981; Hunt, Kinematic geometry of
mechanisms, 1978; Hopcroft and Tarjan, Algorithm 447, 1973; Horton 1987 (cycles); Brockett, Robotic manipulators and the
product of exponentials formula, 1984.
"""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 2
"""Bumped when results of stages that use this package change for the same input."""
