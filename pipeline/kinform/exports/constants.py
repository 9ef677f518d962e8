"""Numbers that decide what exports and the drawing of the kinematic graph look like."""

from __future__ import annotations

import math

# equations: loops of Modelica and VHDL-AMS

LEAST_MOTION = 1e-9
"""rad or m: what counts as motion of a joint along our run. Far above rounding; a choice, not a measurement."""
POSES_OF_RUN = 24
"""Poses of our run at which the free coordinates must be good; a choice: a turn is seen every 15°."""
CLOSE_CHOICE = 0.7
"""Choices within this factor of the best count as equal, and the first is taken: the same on all machines."""

# mjcf, sdf: masses and steps that programs accept

LEAST_MOMENT = 1e-14
"""kg·m²: below 1e-15 MuJoCo refuses a moment of inertia."""
GRAIN = 1e-9
"""kg and kg·m², of links and bodies whose mass is not known: small enough to change no motion."""
MOST_FACETS = 200_000
"""More than these MuJoCo does not read from STL."""
MOST_NESTED = 495
"""Bodies in a row, each in the one before, that MuJoCo 4.0 reads: its XML reader takes 499 elements in each other."""
STEP = 0.001
"""s, of RK4 without loops; a choice."""
STEP_OF_LOOPS = 0.0002
"""s, of RK4: loops are stiff springs to MuJoCo and need the shorter step (within 1e-5 of rigid ones in the tests)."""
BANDWIDTH = 2.0 * math.pi * 10.0
"""rad/s, of the position servos that stand for prescribed motions: 10 Hz, a choice."""
SHOWN_ASIDE = 1e-9
"""rad and m: a servo that is aimed aside by less is not said to be: that is rounding."""
LOCKED_SHARE = 1e-6
"""Share of what one rate opens loops by that the others may leave open: more, and the loops lock it. Axes that contact
made agree close loops to 1e-9 and better."""
LEAST_SKEW = 1e-9
"""Cosine between the axes of a universal joint below which they are square, as SDF has them; rounding leaves less."""

# urdf

UNLIMITED = 1e9
"""What stands for a limit that is not known, where the format must have one."""

# graph: the drawing (px; the size of its text is 13 px)

LETTER_WIDTH = 7.3
"""px, of a letter on average."""
LINE_HEIGHT = 18.0
"""px, of a line of the legend."""
MARGIN = 30.0
"""px, around the drawing."""
EDGE_LENGTH = 105.0
"""px, of a joint between two bodies: its symbol stands clear of both."""
SYMBOL_RADIUS = 10.5
"""px, of the circle with the letter of a joint."""
SYMBOL_PLACES = (0.5, 0.6, 0.4, 0.7, 0.3, 0.8, 0.2)
"""Shares of a joint's line at which its symbol may stand, the best first."""
CLEARANCE = 0.8
"""Share of its radius by which a symbol keeps clear of boxes."""
MOST_CLEARED = 600
"""Bodies up to which the symbols keep clear of boxes: the search takes bodies times joints."""
MOST_LOOPS = 40
"""Loops up to which they are numbered; more marks cannot be told apart."""
MOST_BODIES = 150
"""Bodies of the largest graph in a page: a larger one cannot be read there."""
LONGEST_NAME = 30
"""Letters of a name in a page."""
PANEL = (320.0, 470.0)
"""px, width and height of the room of the graph in a page."""

# graph: the layout

MOST_STRESSED = 250
"""Nodes of a component; larger ones stay in layers, as majorisation takes their square in memory."""
MOST_ROUNDS = 200
"""Steps of majorisation, and rounds of pushing boxes apart."""
STILL = 0.05
"""px: a step of majorisation that moves no node by more is the last."""
LEAST_OVERLAP = 0.5
"""px: boxes that are nearer to each other than they may be by less stay where they are."""
CROWDED = 9
"""Nodes with more neighbours are hubs, whose edges are longer."""
HUB_EXPONENT = 0.75
"""The edge of a hub grows with this power of its neighbours over CROWDED; tried on the fixtures."""
WIDTH_SHARE = 0.25
"""Share of both widths by which boxes beside each other are to be further apart than their edges say."""
GAP = 26.0
"""px, least space between two boxes."""
