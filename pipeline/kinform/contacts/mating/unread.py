"""What the patches of a pair do not say: of which surfaces they are not, and which motions they leave."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts import constants
from kinform.contacts.search.pair_view import PairView
from kinform.foundation.algebra.screws import Frame, rows
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch


def unread_surfaces(pair: PairView, patches: Sequence[Patch], reach: float) -> Flags:
    """(s, t): near surfaces of a and b that come within `reach` (m), and that no patch is of, nor one of either and a
    neighbour of the other: a fillet beside a face says nothing that the face does not say."""
    flags = pair.overlap(reach)
    of_a, columns = ({k: row for row, k in enumerate(side.ids.tolist())} for side in pair.near)
    a, b = pair.parts
    for patch in patches:
        i, j = patch.surfaces
        if j in columns:
            about = a.index.neighbours(a.surfaces, i)
            flags[[row for k, row in of_a.items() if k == i or k in about], columns[j]] = False
        if i in of_a:
            about = b.index.neighbours(b.surfaces, j)
            flags[of_a[i], [column for k, column in columns.items() if k in about]] = False
    return flags


def motions_left(patches: Sequence[Patch], frame: Frame) -> Array:
    """(k, 6) orthonormal, scaled in the frame: the motions that patches leave, each of which counts alike."""
    shares = [np.sqrt(patch.weights / patch.weights.sum() / len(patches))[:, None] for patch in patches]
    held = np.concatenate(
        [share * rows(patch.points, patch.normals, frame) for patch, share in zip(patches, shares, strict=True)]
    )
    triangle = np.linalg.qr(held, mode="r") if len(held) > 6 else held
    _, values, right = np.linalg.svd(np.vstack([triangle, np.zeros((6, 6))]))
    return np.asarray(right[:6][values[:6] < constants.ENCLOSED_HELD])
