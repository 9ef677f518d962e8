"""Which stated motions contact admits: it pushes and does not pull, so that it may admit a motion in one sense alone.

A sample of contact stands against a motion where this takes it into the other body. What is little beside the greatest
speed of the contact is none: then the bodies go at least ten times as far as the gap there before they meet, as a door
does whose edge swings by the post at a small distance. Flanks of threads lean little, and what they lean is a fact.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.names import PartName

ADMITTED = 0.1
"""Speed along the normal, over the greatest speed of the contact, up to which a sample stands against nothing. Chosen:
what stands against less is proven by a finite step (KF402), not by this."""


def admitted_senses(patches: Sequence[Patch], motion: Array, first: Collection[PartName]) -> tuple[bool, bool]:
    """Whether contact lets the second body move by the twist (6,) (ω; v at the world's origin), and by its reverse.

    `first`: the parts of the first body.
    """
    along, share, pace = [], [], 0.0
    for patch in patches:
        side = 1.0 if patch.parts[0] in first else -1.0
        speeds = motion[3:] + cross(motion[:3], patch.points)
        along.append(side * np.einsum("ni,ni->n", speeds, patch.normals))
        share.append(np.full(len(speeds), SAME_DIRECTION if patch.kind == "helicoid" else ADMITTED))
        pace = max(pace, float(np.linalg.norm(speeds, axis=1).max(initial=0.0)))
    across = np.concatenate(along) if along else np.zeros(0)
    large = pace * (np.concatenate(share) if share else 1.0)
    return bool((across >= -large).all()), bool((across <= large).all())


def admits(patches: Sequence[Patch], motions: Array, first: Collection[PartName]) -> bool:
    """Whether contact admits each of these motions (k, 6), one at least, in one sense or the other."""
    return len(motions) > 0 and all(any(admitted_senses(patches, motion, first)) for motion in motions)
