"""Numbers that decide which parts are one body when the function names all joints. Prices have no unit: what counts is
their order. The first values are those of a trial on nine public robots (none of its numbers was tuned there)."""

from __future__ import annotations

import numpy as np

COAXIAL_OFF = 0.1
"""Distance between axes, as a share of the radius, up to which a surface of revolution goes round the axis of a joint;
and the same of the middle of a part's surface, as a share of its spread. Chosen, not measured."""
FASTENED = {"holes": 5000.0, "pocket": 1000.0, "spigot": 400.0, "pressed": 20.0}
"""Price of parting what is fastened, by what suggests it: screws that are not modelled, a pocket, holes that line up
round a journal (of a flange, or of a joint in the pose that is drawn), a press."""
BROKEN = 20000.0
"""Price of a contact between bodies that no joint of theirs may part: legs that cross are drawn touching, too. More
than what suggests any fastening."""
PARTED = 100.0
"""Price of separating serrations about the axis: those of a servo's output turn with what they drive. Up to this price
contact is made to be separated: it does not say that two names stand for one body. Chosen, not measured."""
TOUCH_WORTH = 0.5
"""Price of parting the pair that touches over the largest area of all, in proportion for others: what nothing else
tells apart goes with the part that it touches most. Less than any other price."""
SAME_AXIS = np.radians(1.0)
"""rad: journals whose axes differ by less are on one axis, and a surface of revolution whose axis differs by less from
a joint's goes round it, however little of it touches. Five times the default alignment tolerance: stated axes are
written with few digits. Chosen, not measured."""
