"""Where nothing is searched for garbage, and that it is searched for again afterwards."""

from __future__ import annotations

import gc
import weakref

import pytest

from kinform.foundation.memory import uncollected


class Held:
    """Something that can be watched."""


@pytest.fixture(params=[True, False], ids=["on", "off"])
def before(request):
    was = gc.isenabled()
    (gc.enable if request.param else gc.disable)()
    yield request.param
    (gc.enable if was else gc.disable)()


def test_the_search_is_off_within_and_as_before_afterwards(before):
    with uncollected():
        assert not gc.isenabled()
        with uncollected():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled() == before


def test_the_search_is_as_before_after_an_error_and_after_each_call(before):
    @uncollected()
    def failing(count):
        assert not gc.isenabled()
        raise ValueError(count)

    for count in range(2):
        with pytest.raises(ValueError, match=str(count)):
            failing(count)
        assert gc.isenabled() == before


def test_what_is_in_no_cycle_goes_at_once():
    with uncollected():
        thing = Held()
        watched = weakref.ref(thing)
        del thing
        assert watched() is None
