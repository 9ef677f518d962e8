"""Bodies within bodies of MJCF: thousands of them, and as deep as MuJoCo reads."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinform.exports.exported import ExportError
from kinform.formats.mjcf.writing.writer import MOST_NESTED, _nested


def body(name, *children):
    return SimpleNamespace(name=name, children=list(children))


def written(node, depth=1):
    """As a recursion has it."""
    inner = [row for child in node.children for row in written(child, depth + 1)]
    return [(node.name, depth, False), *inner, *([(node.name, depth, True)] if depth > 1 else [])]


@given(st.recursive(st.builds(body, st.integers()), lambda of: st.builds(body, st.integers(), of, of), max_leaves=20))
def test_bodies_begin_and_end_as_they_are_nested(root):
    assert [(one.name, depth, ends) for one, depth, ends in _nested(root)] == written(root)


@pytest.mark.parametrize(("count", "read"), [(MOST_NESTED, True), (MOST_NESTED + 1, False), (5000, False)])
def test_of_more_in_a_row_than_are_read_it_is_told(count, read):
    root = body("world")
    for k in range(count):
        root.children, inner = [body(k)], root.children
        root.children[0].children = inner
    if read:
        assert len(list(_nested(root))) == 2 * count + 1
    else:
        with pytest.raises(ExportError, match="ground"):
            list(_nested(root))
