"""Numbers that decide which parts are one body when the function names all joints. Prices have no unit: what counts is
their order. The first values are those of a trial on nine public robots (none of its numbers was tuned there)."""

from __future__ import annotations

import numpy as np

COAXIAL = np.radians(1.0)
"""rad: a surface of revolution whose axis differs by less from the joint's goes round it, however little of it
touches."""
COAXIAL_OFF = 0.1
"""The same of its distance, as a share of its radius."""
FASTENED = {"holes": 5000.0, "pocket": 1000.0, "spigot": 400.0, "pressed": 20.0}
"""Price of parting what is fastened, by what suggests it: screws that are not modelled, a pocket, holes that line up
round a journal (of a flange, or of a joint in the pose that is drawn), a press."""
BROKEN = 20000.0
"""Price of a contact between bodies that no joint of theirs may part: legs that cross are drawn touching, too."""
PARTED = 100.0
"""Price up to which contact is made to be parted: it does not say that two names stand for one body."""
TOUCH_WORTH = 0.5
"""Price of parting the pair that touches over the largest area of all, in proportion for others: what nothing else
tells apart goes with the part that it touches most."""
SAME_AXIS = np.radians(1.0)
"""rad: journals whose axes differ by less are on one axis."""
