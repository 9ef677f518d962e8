"""The assembly's constraint matrix J with the provenance of each row.

A row says n·(velocity of b − velocity of a) at one contact sample; J V ≥ 0 is the paper's
non-penetration condition, J V = 0 keeps the contact. Only the extreme samples of a patch matter
(a linear condition holds on a patch when it holds on its hull), so few rows stand for each.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.screws import Frame, perpendicular, rows, scaled
from kinform.model.contacts import Patch
from kinform.model.kinematics import Body, ConstraintMatrix, Joint

__all__ = ["assemble", "extreme_samples"]

Array = NDArray[np.float64]

RIM = 16
"""Extreme samples are looked for in this many directions in the plane of a patch."""


def extreme_samples(patch: Patch) -> NDArray[np.int64]:
    """Indices of the samples that bound the patch, ascending."""
    points = patch.points
    if len(points) <= 2 * RIM:
        return np.arange(len(points), dtype=np.int64)
    chosen: set[int] = set()
    if patch.kind == "plane":
        u, v = perpendicular(patch.axis)
        angle = 2.0 * np.pi * np.arange(RIM) / RIM
        height = points @ (np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)).T
        chosen.update(int(k) for k in height.argmax(axis=0))
    else:
        # on a curved patch the normals differ: keep the extremes in each sector of normals
        u, v = perpendicular(patch.axis) if np.any(patch.axis) else (np.eye(3)[0], np.eye(3)[1])
        w = np.cross(u, v)
        sector = np.floor(np.arctan2(patch.normals @ v, patch.normals @ u) / (2.0 * np.pi / RIM)).astype(int)
        height = points @ w
        for s in np.unique(sector):
            members = np.flatnonzero(sector == s)
            chosen.update((int(members[height[members].argmin()]), int(members[height[members].argmax()])))
    return np.array(sorted(chosen), dtype=np.int64)


def assemble(bodies: Sequence[Body], joints: Sequence[Joint], patches: Sequence[Patch]) -> ConstraintMatrix:
    """J of all patches between different bodies; the rows that carry a joint are made exactly
    consistent with its snapped freedoms."""
    column = {part: k for k, body in enumerate(bodies) for part in body.parts}
    owner = {index: joint for joint in joints for index in joint.patches}
    used = [k for k, p in enumerate(patches) if column[p.parts[0]] != column[p.parts[1]] and len(p.points)]
    world = Frame.of(np.concatenate([patches[k].points for k in used])) if used else Frame(np.zeros(3), 1.0)
    data, indices, provenance, samples = [], [], [], []
    for k in used:
        patch = patches[k]
        chosen = extreme_samples(patch)
        own = rows(patch.points[chosen], patch.normals[chosen], world)
        if k in owner:
            free, _ = np.linalg.qr(scaled(owner[k].twists.T, world))
            own = own - (own @ free) @ free.T
        first, second = column[patch.parts[0]], column[patch.parts[1]]
        low = first < second
        data.append(np.hstack([-own, own] if low else [own, -own]))
        six = np.arange(6)
        index = np.concatenate([6 * min(first, second) + six, 6 * max(first, second) + six])
        indices.append(np.tile(index, (len(chosen), 1)))
        provenance.append(np.full(len(chosen), k))
        samples.append(chosen)
    count = sum(len(s) for s in samples)

    def joined(arrays: list[NDArray[np.int64]]) -> NDArray[np.int64]:
        return np.concatenate(arrays).ravel().astype(np.int64) if arrays else np.zeros(0, np.int64)

    return ConstraintMatrix(
        bodies=tuple(body.name for body in bodies),
        data=np.concatenate(data).ravel() if data else np.zeros(0),
        indices=joined(indices),
        indptr=12 * np.arange(count + 1, dtype=np.int64),
        patch=joined(provenance),
        sample=joined(samples),
        centre=world.centre,
        length=world.length,
    )
