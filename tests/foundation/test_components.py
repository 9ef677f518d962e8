"""Connected components are those of scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinform.foundation.graphs.components import components


def _links(kind: str, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    if kind == "random":
        return rng.integers(0, count, count // 2), rng.integers(0, count, count // 2)
    if kind == "path":
        order = rng.permutation(count)
        keep = rng.random(count - 1) < 0.99
        return order[:-1][keep], order[1:][keep]
    hub = rng.integers(0, count, 5)
    return rng.choice(hub, count), rng.integers(0, count, count)


@pytest.mark.parametrize("kind", ["random", "path", "hubs"])
@pytest.mark.parametrize("count", [1, 2, 50, 3000])
def test_components_are_those_of_scipy_numbered_by_their_first_node(kind: str, count: int) -> None:
    a, b = _links(kind, count, np.random.default_rng(count))
    expected = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(count, count)), directed=False)[1]
    found = components(a, b, count)
    assert np.array_equal(found, expected)
    first = [int(np.flatnonzero(found == k)[0]) for k in range(found.max() + 1)]
    assert first == sorted(first)


def test_without_links_every_node_is_alone() -> None:
    none = np.zeros(0, dtype=np.int64)
    assert components(none, none, 4).tolist() == [0, 1, 2, 3]
    assert components(none, none, 0).tolist() == []
