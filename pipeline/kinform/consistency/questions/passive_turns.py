"""Bodies that turn about the line of their ball joints and move nothing else, as the coupler of an RSSR linkage does.

Textbooks leave such passive freedoms out of the mobility. Here they count wherever somebody could see them (`mobility.
idle`), so that a stated mobility which leaves them out is neither right nor wrong.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.model.kinematics import Body, Joint
from kinform.model.names import BodyName


def passive_turns(bodies: Iterable[Body], joints: Sequence[Joint], idle: Iterable[BodyName]) -> tuple[BodyName, ...]:
    """Names of the bodies, without ground and those that turn idly, all of whose joints are balls in one line, two at
    least."""
    around: dict[BodyName, list[Joint]] = defaultdict(list)
    for joint in joints:
        for name in joint.bodies:
            around[name].append(joint)
    known = set(idle)
    return tuple(b.name for b in bodies if not b.ground and b.name not in known and _in_line(around[b.name]))


def _in_line(joints: Sequence[Joint]) -> bool:
    centres = [joint.point for joint in joints if joint.type == "spherical" and joint.point is not None]
    if len(joints) < 2 or len(centres) < len(joints):
        return False
    arms = np.array(centres) - centres[0]
    longest = arms[int(np.argmax(np.linalg.norm(arms, axis=1)))]
    away = norm(longest)
    return away > 0.0 and bool((np.linalg.norm(cross(arms, longest), axis=1) <= SAME_DIRECTION * away**2).all())
