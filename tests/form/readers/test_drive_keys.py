"""Shares of power that drives and couplings state."""

import pytest

from kinform import form
from kinform.errors import InputError

COUPLING = """schema = 1
[assembly]
name = "x"
units = "mm"
[[part]]
name = "a"
[[part]]
name = "b"
[[part]]
name = "c"
[[function.joint]]
name = "j"
between = ["a", "b"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.joint]]
name = "k"
between = ["a", "c"]
type = "revolute"
axis = [0, 0, 1]
point = [5, 0, 0]
[[function.coupling]]
joints = ["j", "k"]
ratio = 2
efficiency = {}
"""


@pytest.mark.parametrize("efficiency", ["0", "1e-320", "1e-12", "1.5"])
def test_an_efficiency_without_a_finite_one_back_is_told(tmp_path, efficiency):
    (tmp_path / "a.toml").write_text(COUPLING.format(efficiency))
    with pytest.raises(InputError) as caught:
        form.load(tmp_path / "a.toml")
    assert any("efficiency" in problem.message for problem in caught.value.problems)


def test_an_efficiency_back_follows_from_teeth_that_rub_alike(tmp_path):
    (tmp_path / "a.toml").write_text(COUPLING.format(0.8))
    (coupling,) = form.load(tmp_path / "a.toml").function.couplings
    assert coupling.efficiency_back == pytest.approx(0.75)
