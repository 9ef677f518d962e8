"""Directions that facets of no known surface hold least, and most.

Facets have no axis that would suggest a motion, and they need not agree with one to better than `LOOSE_ANGLE`. Of the
directions that a plane or a ball leaves, one that is chosen by the axes of the world may by chance be within that of
what the facets leave, in one pose, and miss it in another. So theirs are asked for: the speeds along the normals of a
unit motion in a space of two or three directions are a quadratic form, whose principal axes turn with the bodies.

Where nothing is loose any directions that span the space serve: those of all patches, or of their samples, so that
they turn with the bodies too.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular, turning_frame
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.model.arrays import Array

MOST_LOOSE = 4
"""Patches of facets of no known surface, the largest first, each of which suggests directions in a plane. Chosen, not
measured."""


def slides_across(evidence: Evidence, normal: Array) -> list[Array]:
    """Unit directions (3,) across the unit normal of a plane that span what it leaves: those that loose patches hold
    least and most, all of them together first, then each of the largest; all patches together where none is loose."""
    u, v = perpendicular(normal)
    held = _loose_rows(evidence) or [np.sqrt(evidence.share)[:, None] * evidence.rows]
    across = [(of[:, 3:] @ u, of[:, 3:] @ v) for of in held]
    forms = [np.array([x @ x, x @ y, y @ y]) for x, y in across]
    out = []
    for xx, xy, yy in _with_sum(forms):
        # principal axes of a form in the plane (O. Mohr, 1882)
        angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
        most, least = math.cos(angle) * u + math.sin(angle) * v, math.cos(angle) * v - math.sin(angle) * u
        out += [least, most]
    return out


def turns_about(evidence: Evidence, centre: Array) -> list[Array]:
    """Unit axes (3,) through the centre (3,) m of a ball that span its turns: those about which loose patches hold it
    least and most, as of `slides_across`."""
    arm = (centre - evidence.frame.centre) / evidence.frame.length
    forms = []
    for of in _loose_rows(evidence):
        turns = of[:, :3] - cross(arm, of[:, 3:])
        forms.append(turns.T @ turns)
    if not forms:
        return list(turning_frame(evidence.rows[:, 3:]))
    return [axis for form in _with_sum(forms) for axis in np.linalg.eigh(form)[1].T]


def _loose_rows(evidence: Evidence) -> list[Array]:
    """Rows (n, 6) of each of the largest loose patches, weighted, as if each were of the same area."""
    loose = [k for k, item in enumerate(evidence.items) if item.loose]
    loose.sort(key=lambda k: (-evidence.items[k].area, k))
    out = []
    for k in loose[:MOST_LOOSE]:
        of = slice(evidence.start[k], evidence.start[k + 1])
        share = evidence.share[of]
        out.append(np.sqrt(share / share.sum())[:, None] * evidence.rows[of])
    return out


def _with_sum(forms: list[Array]) -> list[Array]:
    """The forms after the sum of all, which is that of the only one."""
    return forms if len(forms) == 1 else [sum(forms[1:], start=forms[0]), *forms]
