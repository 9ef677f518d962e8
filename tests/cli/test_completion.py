"""What a shell completes to after codes of rules, parts and joints."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from support.places import FIXTURES

from kinform import results
from kinform.consistency import RULES
from kinform_cli import completion


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


def test_no_name_is_offered_that_a_shell_would_obey(monkeypatch):
    names = ["base plate", "arm/a.1", "a$(id)", "a`id`", "a;id", "a\nid", "a\x1b[2J", "a'b", 'a"b', "a|b", "a*", "a\\b"]
    parts = tuple(SimpleNamespace(name=name) for name in names)
    design = SimpleNamespace(assembly=SimpleNamespace(parts=parts, groups=()), kinematics=None)
    monkeypatch.setattr(results, "read", lambda path: design)
    assert completion.parts(SimpleNamespace(params={"source": "a.h5"}, args=[]), "") == ["arm/a.1", "base plate"]
