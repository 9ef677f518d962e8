"""A slide or a screw goes as far as its guide: a range that is stated beyond it is told."""

from __future__ import annotations

import shutil

import pytest
from support.places import FIXTURES
from support.solids import block, save

from kinform import stages

LIMIT = 120.0
"""mm: half of the rail and half of the carriage."""


def judged(manifest):
    design = stages.joints(stages.contacts(stages.import_(manifest)))
    design = stages.check(stages.simulate(stages.mass(design), ranges=True))
    return design, [f for f in design.report.findings if f.code == "KF412"]


def slide(folder, rail, stated, *, turned=False, complete=False):
    """A carriage of 40 mm on a rail, with the range of its stroke."""
    save(rail, folder / "rail.stl")
    save(block(40, 40, 20).translate((0, 0, 10)), folder / "carriage.stl")
    between = ["carriage", "rail"] if turned else ["rail", "carriage"]
    (folder / "guide.toml").write_text(f"""schema = 1
[assembly]
name = "guide"
units = "mm"
ground = "rail"
[[part]]
name = "rail"
mesh = "rail.stl"
[[part]]
name = "carriage"
mesh = "carriage.stl"
[function]
{"complete = true" if complete else ""}
[[function.joint]]
name = "stroke"
between = {between}
type = "prismatic"
axis = [1, 0, 0]
range = {stated}
""")
    return judged(folder / "guide.toml")


def channel():
    """200 mm long."""
    walls = [block(200, 10, 40).translate((0, y, 0)) for y in (-25, 25)]
    return block(200, 60, 20).translate((0, 0, -10)) + walls[0] + walls[1]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("stated", "sides"),
    [
        ("[-110, 119]", []),
        ("[-110, 120.1]", []),  # a hair beyond is no finding, as of stops
        ("[-110, 130]", ["upper"]),
        ("[-500, 110]", ["lower"]),
        ("[-500, 500]", ["lower", "upper"]),
        ("[-110, inf]", []),  # asks for no end, and for no endless rail
    ],
)
def test_a_range_goes_no_further_than_the_guide(tmp_path, stated, sides, turned):
    design, found = slide(tmp_path, channel(), stated, turned=turned)
    assert [(joint.type, joint.status) for joint in design.kinematics.joints] == [("prismatic", "determined")]
    assert len(found) == len(sides)
    assert sorted(one.found.startswith("-") for one in found) == sorted(side == "lower" for side in sides)
    for one in found:
        assert one.severity == "error"
        assert one.found.lstrip("-") == f"{LIMIT:g} mm"


def test_a_slide_that_is_taken_as_stated_has_its_guide_in_no_mesh(tmp_path):
    """A block on a table: contact leaves it planar."""
    table = block(200, 200, 20).translate((0, 0, -10))
    design, found = slide(tmp_path, table, "[-500, 500]", complete=True)
    assert [(joint.type, joint.status) for joint in design.kinematics.joints] == [("prismatic", "stated")]
    assert not found


@pytest.mark.parametrize("turns", [2.0, 400.0])
def test_a_screw_goes_no_further_than_its_thread(tmp_path, turns):
    """A nut on a lead screw: the last key of its manifest is that of its joint."""
    shutil.copytree(FIXTURES / "pairs" / "screw_right", tmp_path / "screw")
    manifest = tmp_path / "screw" / "screw_right.toml"
    manifest.write_text(f"{manifest.read_text().rstrip()}\nrange = [-1, {360 * turns}]\n")
    design, found = judged(manifest)
    assert [(joint.type, joint.status) for joint in design.kinematics.joints] == [("screw", "determined")]
    assert bool(found) == (turns > 10)
