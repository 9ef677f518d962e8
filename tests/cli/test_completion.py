"""What a shell completes to after codes of rules, parts and joints."""

from __future__ import annotations

import pytest
from support.places import FIXTURES

from kinform import results
from kinform.consistency import RULES


@pytest.fixture(scope="module")
def file(derive_design, tmp_path_factory):
    """Results of the two-axis seeker."""
    path = tmp_path_factory.mktemp("completion") / "a.h5"
    results.write(derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml"), path)
    return path


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("explain KF41", {rule.code for rule in RULES if rule.code.startswith("KF41")}),
        pytest.param("query FILE ho", {"housing"}, marks=pytest.mark.sweep),
        pytest.param("query FILE housing outer", {"outer", "outer_gimbal"}, marks=pytest.mark.sweep),
        ("show FILE joints --joint ya", {"yaw", "yaw_motor/spin"}),
        pytest.param("show FILE joints --joint base~", {"base~outer"}, marks=pytest.mark.sweep),
        pytest.param("query no.h5 ho", set(), marks=pytest.mark.sweep),
    ],
)
def test_a_shell_is_offered_names(kinform, file, line, offered):
    words = f"kinform {line}".replace("FILE", str(file))
    ran = kinform(_KINFORM_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(words.split()) - 1))
    assert set(ran.stdout.split()) == offered, ran.stderr
    assert ran.stderr == ""
