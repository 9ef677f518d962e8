"""Texts are read again from the files of the design, and from nothing else."""

from __future__ import annotations

import math

import pytest

from kinform.foundation.boundary import Boundary
from kinform.model.assembly import Source
from kinform.model.findings import stated
from kinform.replays.files import Files
from kinform.replays.outcome import NotReplayed
from kinform.replays.textual import replay

MANIFEST = """[[part]]
name = "arm"
inertia = [
 [1, 0, 0],
 [0, 1e-3, 0],
]
density = 1200 # kg/m³
[materials.pla]
mass = 3
"""
URDF = """<robot name="r">
<joint name="j" type="revolute">
<limit lower="-1.57"
 upper="0.5"/>
</joint>
<joint name="k" type="revolute"/>
</robot>
"""


@pytest.fixture
def files(tmp_path):
    inside = tmp_path / "design"
    (inside / ".git").mkdir(parents=True)
    (inside / ".git" / "config").write_text("secret = 1\n")
    (inside / "m.toml").write_text(MANIFEST)
    (inside / "r.urdf").write_text(URDF)
    (inside / "d.urdf").write_text('<limit upper="90"/>\n')
    (inside / "x.xacro").write_text('<limit upper="${pi}"/>\n')
    (inside / "binary").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "outside.toml").write_text("secret = 1\n")
    (inside / "link.toml").symlink_to(tmp_path / "outside.toml")
    return Files(inside, Boundary(inside / "m.toml"))


def outcome(files, name, line, *states, **more):
    return replay(stated(Source(name, line), *states, **more), files).state


@pytest.mark.parametrize(
    ("name", "line", "states", "lacks", "state"),
    [
        ("m.toml", 1, ("arm", "0.001", "1200.0"), (), "holds"),
        ("m.toml", 1, ("arm",), ("mass",), "holds"),  # of the next table
        ("m.toml", 1, ("arm",), ("density",), "does not hold"),
        ("m.toml", 1, ("0.002",), (), "does not hold"),
        ("m.toml", 7, ("1200",), (), "holds"),
        ("r.urdf", 2, ("j", "-1.57", "0.5"), (), "holds"),
        ("r.urdf", 2, ("j", "1.57"), (), "does not hold"),
        ("r.urdf", 6, ("k",), ("limit",), "holds"),
        ("r.urdf", 2, ("j",), ("limit",), "does not hold"),
        ("r.urdf", 2, ("revolut",), (), "does not hold"),
        ("d.urdf", 1, (repr(math.radians(90.0)),), (), "holds"),
        ("r.urdf", 99, ("j",), (), "does not hold"),
        ("r.urdf", -1, ("j",), (), "does not hold"),
    ],
)
def test_an_element_a_table_or_a_line_is_read_again(files, name, line, states, lacks, state):
    assert outcome(files, name, line, *states, lacks=lacks) == state


def test_a_file_that_is_there_is_not_missing(files):
    assert outcome(files, "r.urdf", 2, missing="gone.stl") == "holds"
    assert outcome(files, "r.urdf", 2, missing="m.toml") == "does not hold"


@pytest.mark.parametrize(
    "name", ["../outside.toml", "link.toml", ".git/config", "/etc/hostname", "a\0b", "", ".", "gone.toml", "binary"]
)
def test_nothing_outside_of_the_design_is_read(files, name):
    with pytest.raises(NotReplayed) as why:
        outcome(files, name, 1, "secret = 1")
    assert "secret" not in str(why.value)


def test_whether_a_file_is_outside_is_not_told(files):
    told = set()
    for name in ("../outside.toml", "../nothing.toml"):
        with pytest.raises(NotReplayed) as why:
            outcome(files, "r.urdf", 2, missing=name)
        told.add(str(why.value).replace(name, ""))
    assert len(told) == 1


def test_a_file_is_read_up_to_a_limit(files, monkeypatch):
    monkeypatch.setattr("kinform.replays.textual.TEXT_BYTES", 10)
    with pytest.raises(NotReplayed):
        outcome(files, "m.toml", 1, "arm")


def test_an_expression_is_not_evaluated(files):
    with pytest.raises(NotReplayed):
        outcome(files, "x.xacro", 1, "3.14159")
