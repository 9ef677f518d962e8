"""The assembly's constraint matrix J with the provenance of each row.

A row says n·(velocity of b − velocity of a) at one contact sample; J V ≥ 0 is the paper's
non-penetration condition, J V = 0 keeps the contact. Only the extreme samples of a patch matter
(a linear condition holds on a patch when it holds on its hull), so few rows stand for each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, rows, scaled
from kinform.kinematics.joints.pair.extremes import extreme_samples
from kinform.model.arrays import Array, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Joint
from kinform.model.names import JointName


def constraint_matrix(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    patches: Sequence[Patch],
    extremes: Mapping[int, Ints] | None = None,
) -> ConstraintMatrix:
    """J of all patches between different bodies; the rows that carry a joint are made exactly
    consistent with its snapped freedoms. `extremes`: of patches, by index, whose extreme samples are known."""
    column = {part: k for k, body in enumerate(bodies) for part in body.parts}
    owner = {index: joint for joint in joints for index in joint.patches}
    used = [k for k, p in enumerate(patches) if column[p.parts[0]] != column[p.parts[1]] and len(p.points)]
    world = Frame.of(np.concatenate([patches[k].points for k in used])) if used else Frame(np.zeros(3), 1.0)
    looked_for = dict(extremes or {})
    new = [k for k in used if k not in looked_for]
    looked_for |= zip(new, extreme_samples([patches[k] for k in new]), strict=True)
    samples = [looked_for[k] for k in used]
    bounds = np.cumsum([0, *map(len, samples)])
    none = np.zeros((0, 3))
    points = [patches[k].points.take(chosen, axis=0) for k, chosen in zip(used, samples, strict=True)]
    normals = [patches[k].normals.take(chosen, axis=0) for k, chosen in zip(used, samples, strict=True)]
    relative = rows(np.concatenate([none, *points]), np.concatenate([none, *normals]), world)
    free = _bases([joint for joint in joints if joint.patches], world)
    for k, start, end in zip(used, bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        if k in owner:
            basis, of_patch = free[owner[k].name], relative[start:end]
            of_patch -= (of_patch @ basis) @ basis.T
    counts = np.diff(bounds)
    ends = np.array([[column[part] for part in patches[k].parts] for k in used], dtype=np.int64).reshape(-1, 2)
    sign = np.repeat(np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0), counts)[:, None]
    index = 6 * np.sort(ends, axis=1)[:, :, None] + np.arange(6)
    return ConstraintMatrix(
        bodies=tuple(body.name for body in bodies),
        data=np.hstack([-sign * relative, sign * relative]).ravel(),
        indices=np.repeat(index.reshape(-1, 12), counts, axis=0).ravel(),
        indptr=12 * np.arange(bounds[-1] + 1, dtype=np.int64),
        patch=np.repeat(np.array(used, dtype=np.int64), counts),
        sample=np.concatenate([np.zeros(0, np.int64), *samples]),
        centre=world.centre,
        length=world.length,
    )


def _bases(joints: Sequence[Joint], frame: Frame) -> dict[JointName, Array]:
    """(6, f) orthonormal: the freedoms of each joint, scaled in the frame."""
    out: dict[JointName, Array] = {}
    for freedoms in {len(joint.twists) for joint in joints}:
        alike = [joint for joint in joints if len(joint.twists) == freedoms]
        twists = scaled(np.concatenate([joint.twists for joint in alike]).T, frame).T
        bases = np.linalg.qr(np.swapaxes(twists.reshape(len(alike), freedoms, 6), 1, 2))[0]
        out |= {joint.name: basis for joint, basis in zip(alike, bases, strict=True)}
    return out
