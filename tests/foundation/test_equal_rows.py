"""Which rows are alike is a matter of their words, whatever slots their hashes send them to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from kinform.foundation import equal_rows
from kinform.foundation.equal_rows import first_equal_rows, number_equal_rows
from kinform.foundation.meshes.edges import edge_table, unsorted_edge_table


def _by_comparison(rows: np.ndarray) -> list[int]:
    seen: dict[tuple[int, ...], int] = {}
    return [seen.setdefault(tuple(row), k) for k, row in enumerate(rows.tolist())]


def _words(rows: np.ndarray) -> list[np.ndarray]:
    return [np.ascontiguousarray(column) for column in rows.T]


@pytest.mark.parametrize("word", [np.uint32, np.uint64])
@pytest.mark.parametrize("width", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 7, 5000])
def test_each_row_is_led_by_the_first_that_equals_it(word: type, width: int, count: int) -> None:
    rng = np.random.default_rng(count)
    rows = rng.integers(0, np.iinfo(word).max, (count // 3 + 1, width), dtype=word)[
        rng.integers(0, count // 3 + 1, count)
    ]
    assert first_equal_rows(_words(rows)).tolist() == _by_comparison(rows)


@given(arrays.arrays(np.uint32, st.tuples(st.integers(0, 60), st.just(2)), elements=st.integers(0, 4)))
def test_kinds_are_numbered_as_they_first_occur(rows: np.ndarray) -> None:
    first, kind = number_equal_rows(_words(rows))
    expected = _by_comparison(rows)
    assert first.tolist() == sorted(set(expected))
    assert first[kind].tolist() == expected


@pytest.mark.parametrize("slots", [1, 2, 50])
def test_rows_of_one_slot_are_told_apart(slots: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(slots)
    rows = rng.integers(0, 12, (600, 3), dtype=np.uint32)
    monkeypatch.setattr(equal_rows, "_slots", lambda words, turn: (words[0] % slots).astype(np.int64))
    assert first_equal_rows(_words(rows)).tolist() == _by_comparison(rows)


@pytest.mark.parametrize("dense", [False, True])
def test_edges_without_a_sort_are_the_same_edges(dense: bool) -> None:
    rng = np.random.default_rng(3)
    vertices = 9 if dense else 400
    faces = np.array([rng.choice(vertices, 3, replace=False) for _ in range(300)])
    by_key, as_they_come = edge_table(faces, vertices), unsorted_edge_table(faces, vertices)

    def edges(table) -> list[tuple[tuple[int, ...], int]]:
        pieces = np.split(table.half_edges, table.starts[1:])
        return list(zip(map(tuple, map(np.ndarray.tolist, pieces)), table.balance.tolist(), strict=True))

    assert sorted(edges(as_they_come)) == sorted(edges(by_key))
    leads = as_they_come.half_edges[as_they_come.starts]
    assert leads.tolist() == sorted(leads.tolist())
    assert sorted(map(tuple, as_they_come.pairs.T.tolist())) == sorted(map(tuple, by_key.pairs.T.tolist()))
    assert (as_they_come.open, as_they_come.overused) == (by_key.open, by_key.overused)
