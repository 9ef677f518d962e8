"""Numbers by which statics decides, by the module that uses them."""

from __future__ import annotations

# --- carrying ---------------------------------------------------------------------------------------------------------

BOTH_WAYS = 1e-9
"""Relative singular value below which wrenches given both ways depend on each other."""

# --- separating -------------------------------------------------------------------------------------------------------

APART = 1e-2
"""Share of a wrench that contacts cannot carry, beyond which no tessellation of their borders explains it."""
CLOSE = 1e-3
"""Share below which it is rounding; in between nobody knows."""
NO_WRENCH = 1e-6
"""Share of the greatest wrench of the run in any joint below which a wrench is none."""
LOOKS = 200
"""Output times at which loads that redundant constraints share are looked at, besides those before a finding."""

# --- sharing ----------------------------------------------------------------------------------------------------------

DEPENDENT = 1e-7
"""Relative singular value below which a balance depends on the others, as in the count of freedoms."""
MOST_JOINTS = 60
"""Joints up to which all wrenches are looked for."""

# --- driving ----------------------------------------------------------------------------------------------------------

SHARES_LOAD = 1e-6
"""Share of a motion (rad, or lengths) below which a joint takes no part in it."""
MOVES_AT_REST = 1e-6
"""Share of gravity over the mechanism's length by which what is held may accelerate: rounding stays far below."""
STAYS = 1e-12
"""Share of the load that may be missing to hold it: rounding, of friction that just holds."""
