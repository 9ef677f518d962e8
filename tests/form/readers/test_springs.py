"""Springs of a manifest: numbers with which no force can be had."""

import pytest

from kinform import form
from kinform.errors import InputError

MANIFEST = """schema = 1
[assembly]
name = "x"
units = "mm"
[[part]]
name = "a"
[[part]]
name = "b"
[[function.gas_spring]]
between = ["a", "b"]
points = [[0, 0, 0], [200, 0, 0]]
lengths = [300, 200]
forces = [{}, 150]
exponent = {}
"""


@pytest.mark.parametrize("force", ["100", "1e-320"])
@pytest.mark.parametrize("exponent", ["1e-9", "1e-320", "1e18"])
def test_an_exponent_that_leaves_no_column_of_gas_is_told(tmp_path, force, exponent):
    (tmp_path / "a.toml").write_text(MANIFEST.format(force, exponent))
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.toml")
    (problem,) = caught.value.problems
    assert problem.line and problem.remedy


@pytest.mark.parametrize("lengths", ["[2e-320, 1e-320]", "[1e-300, 1e-301]"])
@pytest.mark.parametrize("exponent", ["0", "1.2"])
def test_lengths_that_are_the_same_but_for_less_than_an_atom_are_told(tmp_path, lengths, exponent):
    (tmp_path / "a.toml").write_text(MANIFEST.format(100, exponent).replace("[300, 200]", lengths))
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.toml")
    (problem,) = caught.value.problems
    assert problem.line and problem.remedy


@pytest.mark.parametrize("exponent", [1.0, 1.4])
def test_the_column_of_gas_has_the_stated_force_at_both_lengths(tmp_path, exponent):
    (tmp_path / "a.toml").write_text(MANIFEST.format(100, exponent))
    (spring,) = form.load(tmp_path / "a.toml").function.springs
    column = spring.parameters["column"]
    assert 100 * (column / (column - 0.1)) ** exponent == pytest.approx(150)
