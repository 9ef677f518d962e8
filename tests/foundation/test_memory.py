"""Memory goes back to the system, where the C library keeps it."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import weakref

import numpy as np
import pytest
from manifold3d import Manifold

from kinform.foundation.memory import give_back, uncollected
from kinform.foundation.meshes import fcl_adapter

KEPT = """
import ctypes, sys
sys.path[:0] = {path!r}
import numpy as np
from kinform.foundation.memory import give_back
def held():
    return int(open("/proc/self/statm").read().split()[1]) * 4096
np.ones(4_000_000)  # from here on arrays of this size come from the heap
rows = [np.ones(1_000_000) for _ in range(40)]
last = np.ones(1000)
full = held()
del rows
kept = held()
give_back()
print(full - kept, kept - held())
"""


def test_what_was_freed_is_given_back():
    if not sys.platform.startswith("linux"):
        pytest.skip("only Linux tells how much a process holds")
    give_back()
    code = KEPT.format(path=[path for path in sys.path if path])
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    freed, given = map(int, ran.stdout.split())
    assert freed + given > 200e6


COMES_AND_GOES = """
import resource, sys
sys.path[:0] = {path!r}
import numpy as np
from kinform.foundation.memory import keep_heap
if {keeps}:
    keep_heap()
def asked():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
before = asked()
for n in range(30):  # each larger than all that glibc has seen come and go
    rows = np.ones(50_000 + 15_000 * n)
    del rows
print(asked() - before)
"""


def test_pages_of_what_comes_and_goes_are_asked_for_once():
    if not sys.platform.startswith("linux"):
        pytest.skip("only Linux with glibc gives pages back so")
    pages = []
    for keeps in (False, True):
        code = COMES_AND_GOES.format(path=[path for path in sys.path if path], keeps=keeps)
        # Dask sets how glibc gives memory back, for its workers and whoever else is started
        plain = {name: value for name, value in os.environ.items() if not name.startswith("MALLOC_")}
        ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=plain)
        pages.append(int(ran.stdout))
    if pages[0] < 8_000:
        pytest.skip("this C library keeps them anyway")
    assert pages[1] < pages[0] / 4


def test_large_models_are_what_small_ones_are(monkeypatch):
    monkeypatch.setattr(fcl_adapter, "MANY_FACETS", 0)
    asked = []
    monkeypatch.setattr(fcl_adapter, "give_back", lambda: asked.append(True))
    mesh = Manifold.sphere(1.0, 16).to_mesh()
    points, faces = np.asarray(mesh.vert_properties, float), np.asarray(mesh.tri_verts, np.int64)
    assert fcl_adapter.fcl_model(points, faces).num_tries_() == len(faces)
    assert asked


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
        with pytest.raises(ValueError) as caught:  # noqa: PT011
            failing(count)
        assert caught.value.args == (count,)
        assert gc.isenabled() == before


def test_what_is_in_no_cycle_goes_at_once():
    with uncollected():
        thing = Held()
        watched = weakref.ref(thing)
        del thing
        assert watched() is None
