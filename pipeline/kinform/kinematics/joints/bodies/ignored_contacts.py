"""Contact that constrains nothing: the function states all joints, and moves the two bodies by others.

A leg crosses a leg, the first link lies on the third, a duct on one link goes round another. The stated joints may move
the bodies along that contact or against it. Joints that coincide with the motion, as those of a third bar on the pin of
two, are repetitions and are not reported. Flat and irregular contact is reported in any case, as it rubs.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.kinematics.joints.bodies.joints_in_force import leaves_free
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, IgnoredContact, Joint, Mobility


def ignored_contacts(
    beside: Sequence[Joint], patches: Sequence[Patch], bodies: Sequence[Body], mobility: Mobility
) -> tuple[IgnoredContact, ...]:
    """The ignored contacts to report, of the joints `beside` that contact would give; sorted by their bodies.

    `mobility` is that of the bodies under the joints in force. Where it has too many freedoms to keep them, no contact
    is known to lie where the motion is.
    """
    freedoms = mobility.freedoms
    known = len(freedoms) == mobility.instantaneous
    number = {body.name: k for k, body in enumerate(bodies)}
    out = []
    for joint in sorted(beside, key=lambda joint: joint.bodies):
        first, second = (number[name] for name in joint.bodies)
        along = known and _goes_along(joint, freedoms[:, second] - freedoms[:, first], patches)
        aside = _aside(joint, patches, along)
        if aside.loose or not along:
            out.append(aside)
    return tuple(out)


def _goes_along(joint: Joint, motions: Array, patches: Sequence[Patch]) -> bool:
    """Whether relative motions (k, 6) of the two bodies are free by contact."""
    corners = np.concatenate([patches[k].points for k in joint.patches])
    reach = norm(np.ptp(corners, axis=0)) or 1.0
    return leaves_free(joint.twists, motions, corners.mean(axis=0), reach)


def _aside(joint: Joint, patches: Sequence[Patch], along: bool) -> IgnoredContact:
    area = float(sum(patches[k].area for k in joint.patches))
    words = f"the function, which states all joints, moves them {'along this contact' if along else 'otherwise'}"
    return IgnoredContact(joint.name, joint.bodies, joint.type, joint.freedoms, joint.status, area, joint.axis, words)
