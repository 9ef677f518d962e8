"""Every number that decides what is shown, and how finely; the units of all are those of the results."""

from __future__ import annotations

# supervision

GRACE = 1.5
"""Seconds after Ctrl-C in which the work may end by itself, with its own words; the promise is two."""

AGAIN = 0.01
"""Seconds after which Ctrl-C is heard that came while a native module was imported; a choice."""

# console

WIDTH = 80
"""Columns where there is no terminal: what a pager or a log shows without cutting. `COLUMNS` asks for others."""

LEAST_WIDTH = 40
"""Columns below which sentences are not broken further; a choice."""

# tables

GAP = 3
"""Blanks between two facts on one line of a block; a choice."""

INDENT = 4
"""Blanks before the facts of a block; a choice."""

LEAST_NAME = 16
"""Characters to which a name is shortened at most: of the two bodies of a joint seven each. A choice."""

LEAST_TEXT = 24
"""Columns below which a text is not wrapped in a table: about four words a line. A choice."""

MOST_LINES = 4
"""Lines that a text takes in a table at most; a row of which one takes more becomes a block. A choice."""

# overview

MOST_OF_TOPIC = 60
"""Lines of a topic in the overview of a large design; a choice: a screen or two, after which one looks at the
topic alone. A fifth more is shown whole."""

# text

FINE = 1e-5
"""Places are written to this share of the largest part; the JSON has every digit."""

NO_LENGTH = 1e-9
"""Metres below which a length is written as zero: nobody makes a billionth of a metre."""

ROUNDING = 1e-7
"""Share of the largest part below which a length is rounding, and is written as zero: what single precision, in which
meshes are stored, leaves of a coordinate."""

NO_VALUE = 1e-9
"""Below it a singular value, of scaled rows, is written as zero: it is rounding."""

FEW, MANY = 0.01, 1e4
"""A quantity is written in thousandths of its unit below, in thousands from there on: else it has leading zeros, or
five digits before the point."""

# views/evidence

NO_TURN = 1e-7
"""rad below which the uncertainty of an axis is not told: meshes in single precision do not say so much."""

# views/mass

HEAVY = 1.0
"""kg: where something in a table weighs as much, masses are in kg, else in g."""

# progress

DELAY = 1.0
"""Seconds after which a bar appears: shorter work needs none."""

PERIOD = 0.1
"""Seconds between two drawings of the bar; a choice."""

# views/series, views/simulation

SPARK_WIDTH = 20
"""Characters of a line of blocks: with the extremes it fits in 80 columns where names are short."""

REST = 1e-9
"""Share of the greatest position, effort, energy or work below which a series or a sum is nothing but rounding."""

SAME_PEAK = 1e-6
"""Share of the span of a series within which two of its peaks are equally high: the first is named."""

BALANCED = 1e-8
"""Share of the largest energy below which the balance is as exact as the integration is asked to be."""

# views/joints

MOST_WAYS = 3
"""Ways to leave that are listed for each joint; `--joint` lists all. A choice."""

# serving

KEEP_ALIVE = 15.0
"""s after which a browser that follows a page is told again what it knows: so connections that are gone are noticed."""

# views/mobility

MOST_NAMES = 8
"""Bodies or joints that are listed for a freedom; the JSON has them all. A choice."""

NO_ANGLE = 1e-7
"""Radians below which a misfit of directions is none: single precision tells no less of a direction."""

NO_SHIFT = 1e-12
"""Share of the largest part below which a misfit of places is none: rounding."""

SHOWN_SHIFT = 1e-6
"""Share of the largest part from which on the shift of a joint is listed: below are the roundings of mesh files."""

SHOWN_TURN = 1e-5
"""Radians from which on its turn is: noise, and no rounding. A choice."""

MOST_MOVES = 12
"""Joints that were moved that are listed; the JSON has them all. A choice."""
INSET = 2
"""Blanks before the columns that stand below what heads them; a choice."""
NAMED_PAIRS = 3
"""Pairs of parts that are named where all have one reason."""

# text

LARGE = 10.0
"""m: diagonal of a part from which on places are told in m; a choice."""
