"""Overlaps that are judged slight at once are those of which no piece counts."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from support.diagonal import first
from support.solids import box, random_pose, recovered, rod

from kinform import contacts
from kinform.contacts.overlap import interference, slight


def solids():
    """Shafts in bores, with collars, of other tessellations, pressed by less and by more than chords explain."""
    for play, segments, phase in product((0.0, -0.01, -0.06, -0.3), (24, 37), (0.0, 0.4)):
        block = box(-8, 8, -8, 8, -5, 5) - rod(3.0 + play, -6, 6, 32)
        yield {"block": block, "shaft": rod(3.0, -5, 9, segments, phase) + rod(4.5, 5 + min(play, 0.0), 6, segments)}
    yield {"block": box(-8, 8, -8, 8, -5, 5), "buried": rod(2.0, -1, 1, 24)}
    yield {"block": box(-8, 8, -8, 8, -5, 5), "corner": box(7.8, 9, 7.8, 9, 4.8, 6)}


def told_of(made):
    return [(i.parts, i.depth, i.volume, i.place.tolist(), i.mated, i.method) for i in made.interferences]


@pytest.mark.parametrize("seed", first(1, range(2)))
def test_what_is_slight_has_no_piece_that_counts(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    asked = [recovered(random_pose(rng), **every) for every in solids()]
    seen, within = [], []
    judged, near = slight.is_slight, slight._is_within

    def watched(*args):
        seen.append(judged(*args))
        return seen[-1]

    def near_enough(*args):
        within.append(near(*args))
        return within[-1]

    monkeypatch.setattr(interference, "is_slight", watched)
    monkeypatch.setattr(slight, "_is_within", near_enough)
    found = [told_of(contacts.find(*made)) for made in asked]
    assert set(seen) == set(within) == {True, False}
    monkeypatch.setattr(slight, "_is_within", lambda *_: False)
    assert [told_of(contacts.find(*made)) for made in asked] == found
    monkeypatch.setattr(interference, "is_slight", lambda *_: False)
    assert [told_of(contacts.find(*made)) for made in asked] == found
    monkeypatch.setattr("kinform.contacts.overlap.interference.CUT_FEW", 0)
    assert [told_of(contacts.find(*made)) for made in asked] == found
