"""How much larger than its bore a shaft may be: what can be pressed, and what is a mistake of the model.

A press fit stretches the bore by its overlap, and what is stretched beyond its yield strain holds nothing. Threads that
are drawn plain, screws in their pilot holes and shafts in the wrong place overlap by many times as much.
"""

from __future__ import annotations

from kinform.model.contacts import Patch

PRESS_SHARE = 0.03
"""Share of its radius by which a shaft can be larger than its bore, beyond chord errors and uncertainty. A press
stretches the bore by that share: plastics (bushes, rings, printed parts) yield at 2 to 4 %, steel at 0.4 %, and the
heaviest fits of ISO 286 that are pressed, H7/z6, reach 1.07 % at a diameter of 3 mm. Judged on 75 nominal overlaps of
round surfaces of 38 public robots: the 4 within it, bearings in their seats (0.6 %) and a printed holder (3.4 % of a
coarse mesh), are all inside one body; of the 71 beyond it, from 9.6 % on, 61 are screws in pilot holes and rings inside
one body, and 10 are across a joint. No corpus chose the number, and between 3.5 and 9.5 % none would differ."""


ROUND = ("cylinder", "sphere")
"""Kinds of patches whose gap is a difference of radii."""


def press_limit(patch: Patch) -> float:
    """Greatest difference of radii (m) that can be a press fit at a round patch, as far as its surfaces are known."""
    return PRESS_SHARE * min(patch.radii) + patch.chord + patch.uncertainty[1]


def beyond_press(patch: Patch) -> bool:
    """Whether a shaft or ball is larger than its seat by more than can be pressed."""
    return patch.kind in ROUND and not patch.one_sided and -patch.gap > press_limit(patch)
