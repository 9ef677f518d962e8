"""How much larger than its bore a shaft may be: what can be pressed, and what is a mistake of the model.

A press fit stretches the bore by its overlap, and what is stretched beyond its yield strain holds nothing. Threads that
are drawn plain, screws in their pilot holes and shafts in the wrong place overlap by many times as much.
"""

from __future__ import annotations

from kinform.contacts import constants
from kinform.model.contacts import Patch

ROUND = ("cylinder", "sphere")
"""Kinds of patches whose gap is a difference of radii."""


def press_limit(patch: Patch) -> float:
    """Greatest difference of radii (m) that can be a press fit at a round patch, as far as its surfaces are known."""
    return constants.PRESS_SHARE * min(patch.radii) + patch.chord + patch.uncertainty[1]


def beyond_press(patch: Patch) -> bool:
    """Whether a shaft or ball is larger than its seat by more than can be pressed."""
    return patch.kind in ROUND and not patch.one_sided and -patch.gap > press_limit(patch)
