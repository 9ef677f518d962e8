"""The body that holds most of some parts."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kinform.changes.matching import Holders

PARTS = st.sets(st.sampled_from("abcdefgh"), max_size=6).map(lambda chosen: tuple(sorted(chosen)))


@given(st.dictionaries(st.sampled_from(["p", "q", "r", "s"]), PARTS), PARTS)
def test_it_is_the_first_of_those_that_share_most(bodies, parts):
    shared = {name: len(set(parts) & set(held)) for name, held in bodies.items()}
    most = max(shared.values(), default=0)
    wanted = min((name for name, count in shared.items() if count == most), default=None) if most else None
    assert Holders(bodies).of(parts) == wanted
