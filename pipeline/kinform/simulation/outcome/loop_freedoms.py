"""What could be added to the wrenches of joints round loops is made least, joint by joint.

Each direction of a wrench that nothing sees is of one loop, and acts on the joints of that loop alone. In a long row of
loops a joint bears few of all directions: products of those that meet in a joint are all that there is, and n loops
cost n of them, not n³.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Ints

FEW_MEET = 0.05
"""Share of all products of two directions in a joint up to which those that are not zero are summed one by one: a
choice."""


def least_wrenches(
    wrenches: Array, share: Array, loops: Ints, directions: Array, lever: Array
) -> tuple[Array, Array, Array] | None:
    """Wrenches (T, G, j, 6) on the joints of G systems without what of U directions makes them larger; how much a
    direction is of each at most (G, j, 6); and the directions on the joints at the first time (G, 6j, U).

    `share` (G, j, c) is what each joint has of the wrench of each loop, `directions` (T, G, U, 6) are wrenches of the
    `loops` (U,), about the centre, and `lever` (T, G, j, 3, 3) takes their forces' torques to the joints. None where
    many directions meet in the joints.
    """
    times, systems, joints, _ = wrenches.shape
    many = len(loops)
    system, joint, which = np.nonzero(share[:, :, loops])
    place = system * joints + joint
    counts = np.bincount(place, minlength=systems * joints)
    if float((counts**2).sum()) > FEW_MEET * len(counts) * many**2:
        return None
    on_joints = directions[:, system, which] * share[system, joint, loops[which]][:, None]
    on_joints[..., :3] -= (lever[:, system, joint] @ on_joints[..., 3:, None])[..., 0]
    one, other = _meeting(place, counts)
    cell = (system[one] * many + which[one]) * many + which[other]
    column = system * many + which
    inner, right = np.empty((times, systems * many**2)), np.empty((times, systems * many))
    for t, (added, borne) in enumerate(zip(on_joints, wrenches[:, system, joint], strict=True)):
        inner[t] = np.bincount(cell, (added[one] * added[other]).sum(axis=1), minlength=inner.shape[1])
        right[t] = np.bincount(column, (added * borne).sum(axis=1), minlength=right.shape[1])
    much = np.linalg.solve(inner.reshape(times, systems, many, many), right.reshape(times, systems, many, 1))[..., 0]
    first = np.flatnonzero(np.diff(place, prepend=-1))
    out, most = wrenches.reshape(times, -1, 6).copy(), np.zeros((systems * joints, 6))
    out[:, place[first]] -= np.add.reduceat(on_joints * much[:, system, which, None], first, axis=1)
    most[place[first]] = np.maximum.reduceat(np.abs(on_joints).max(axis=0), first, axis=0)
    at_first = np.zeros((systems, joints, 6, many))
    at_first[system, joint, :, which] = on_joints[0]
    return out.reshape(wrenches.shape), most.reshape(systems, joints, 6), at_first.reshape(systems, -1, many)


def _meeting(place: Ints, counts: Ints) -> tuple[Ints, Ints]:
    """All two entries, an entry and itself too, of one place: of ascending places, `counts` of each."""
    each = counts[place]
    first = np.cumsum(counts) - counts
    one = np.repeat(np.arange(len(place)), each)
    nth = np.arange(len(one)) - np.repeat(np.cumsum(each) - each, each)
    return one, np.repeat(first[place], each) + nth
