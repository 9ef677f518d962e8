"""A part can leave the assembly in a direction that is not listed.

Contact of the whole assembly says where a part can go, alone or together with what it pushes: contact opens along the
direction (`kinform show F.h5 joints` lists these directions), or the part slides along it. The meshes say whether it
gets out: the parts are moved along the edges and middles of the cone of directions, and along their own flat faces,
until nothing is in their way or something stops them. Loose parts in the way are pushed along. A free way is an error.
The requirement is met where contact leaves no direction, where everything stops within 5 % of the size of what moves,
and where a part on a single line stops before it leaves its guide: a drawer with stops, a pin with end play. What stops
later, or lifts off before it stops, is tried sideways from there. Where none of this decides, the requirement is
inconclusive (KF902), and so it is for a slide of unknown range that moves other parts along, for a part that can only
tip out, and where contact does not say whether parts are held. Turns on the way out are not tried.

Friction holds nothing: a press fit that slides is inconclusive. A turn that leaves some contact closed is no way out: a
door leaves its jamb and stays on its pin. What can only be unscrewed is held. Ground is held, but not what contact
alone makes one body with it; parts of a `[[group]]` stay together. Directions agree within 1°; what is
between listed directions is listed.

Why it matters: what can fall out does.

What to do: add a shoulder, a clip, a lid or a screw; or list the direction, if assembly needs it.

Example: `kind = "retained"`, `part = "pin"` for a clevis pin with a head on one side and no clip on the other.
"""

from __future__ import annotations

from kinform.consistency.requirements import requirement_rule

RULE = requirement_rule("KF432", "not-retained", "retained", __doc__)
