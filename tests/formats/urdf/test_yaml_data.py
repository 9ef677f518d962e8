"""YAML for xacro is plain data, and does not grow."""

from __future__ import annotations

import math

import pytest

yaml = pytest.importorskip("yaml")

from kinform.formats.urdf.reading.expressions import Budget, Language, NotAllowed  # noqa: E402
from kinform.formats.urdf.reading.yaml_data import BYTES, load_plain  # noqa: E402

UNITS = {"!degrees": math.pi / 180}


def load(text):
    return load_plain(text.encode(), UNITS, lambda said: 2 * float(said))


def test_data_and_units_are_read():
    assert load("a: [1, 2.5, x, true]\nb: &b {c: 1}\nd: *b\ne: {<<: *b, f: !degrees 45}\n") == {
        "a": [1, 2.5, "x", True], "b": {"c": 1}, "d": {"c": 1}, "e": {"c": 1, "f": math.pi / 2},
    }  # fmt: skip
    assert "!degrees" not in yaml.SafeLoader.yaml_constructors


@pytest.mark.parametrize("text", ["a: !!python/object/apply:os.getpid []", "a: !!python/name:os.system", "a: !mine 1"])
def test_tags_of_python_are_refused(text):
    with pytest.raises(yaml.YAMLError):
        load(text)


def test_what_grows_is_refused():
    merged = "a0: &a0 {k: v}\n" + "".join(f"a{k}: &a{k} {{<<: [*a{k - 1}, *a{k - 1}]}}\n" for k in range(1, 40))
    for text in (merged, "a: " + "[" * 5000, "#" * (BYTES + 1)):
        with pytest.raises(NotAllowed):
            load(text)
    laughs = "a0: &a0 [x, x]\n" + "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 40))
    for text in (laughs, "a: &a [*a]"):
        with pytest.raises(NotAllowed):
            Language().checked(load(text), Budget())
