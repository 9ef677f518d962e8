"""Contacts only push: what would lift or tip is said with its time, what rests or is held is not."""

from __future__ import annotations

import numpy as np
import pytest
from support.numbers import numbers
from support.solids import block, centred_rod, save

from kinform import stages
from kinform.statics.carrying import pushes_at, uncarried

BLOCK = 0.04
"""m: edge of a cube that stands on a table; its mass is 0.5 kg."""
WEIGHT = 0.5 * 9.81


def stand(folder, extra):
    """A cube on a table, with loads and drives."""
    save(block(0.4, 0.4, 0.02).translate((0, 0, -0.01)), folder / "table.stl")
    save(block(BLOCK, BLOCK, BLOCK).translate((0, 0, BLOCK / 2)), folder / "cube.stl")
    text = f"""schema = 1
[assembly]
name = "stand"
units = "m"
ground = "table"
[[part]]
name = "table"
mesh = "table.stl"
density = 1000
[[part]]
name = "cube"
mesh = "cube.stl"
density = {0.5 / BLOCK**3}
[simulation]
duration = 0.05
step = 0.01
{extra}
"""
    (folder / "stand.toml").write_text(text)
    return run(folder / "stand.toml")


def run(manifest):
    design = stages.mass(stages.joints(stages.contacts(stages.import_(manifest))))
    return stages.check(stages.simulate(design))


def findings(design, code):
    return [finding for finding in design.report.findings if finding.code == code]


def outcome(design, code):
    (rule,) = (rule for rule in design.report.rules if rule.code == code)
    return rule.outcome


def load(force, point):
    return f"[function]\n[[function.load]]\npart = 'cube'\nforce = {list(force)}\npoint = {list(point)}\n"


def test_a_cube_that_stands_on_a_table_stays(tmp_path):
    design = stand(tmp_path, "")
    assert [joint.type for joint in design.kinematics.joints] == ["planar"]
    assert design.simulation.status == "done"
    assert outcome(design, "KF506") == "passed"


@pytest.mark.parametrize(("share", "lifts"), [(0.9, False), (1.1, True)])
def test_a_cube_lifts_off_when_it_is_pulled_with_more_than_its_weight(tmp_path, share, lifts):
    design = stand(tmp_path, load((0, 0, share * WEIGHT), (0, 0, BLOCK)))
    found = findings(design, "KF506")
    assert bool(found) == lifts
    if lifts:
        assert found[0].subject == ("cube~table",)


@pytest.mark.parametrize(("offset", "lifts"), [(0.9, False), (1.1, True)])
def test_a_cube_tips_when_its_weight_would_stand_beyond_its_edge(tmp_path, offset, lifts):
    # Pressed down beside its middle by ten weights: the resultant passes beyond the edge for offsets above one.
    edge = offset * BLOCK / 2 * 11.0 / 10.0
    design = stand(tmp_path, load((0, 0, -10 * WEIGHT), (edge, 0, BLOCK)))
    assert bool(findings(design, "KF506")) == lifts


def test_what_cannot_be_carried_is_told_whole():
    corners = np.array([[x, y, 0.0] for x in (-1, 1) for y in (-1, 1)])
    up = np.tile([0.0, 0, 1], (4, 1))
    pushes = pushes_at(corners, up, np.zeros(3), 1.0)
    none = np.zeros((0, 6))
    for wrench in ([0, 0, 0, 0, 0, 3.0], [2.9, 0, 0, 0, 0, 3.0], [1.4, -1.4, 0, 0, 0, 3.0]):
        assert np.linalg.norm(uncarried(pushes, none, np.array(wrench))) < 1e-12
    np.testing.assert_allclose(
        uncarried(pushes, none, np.array([0, 0, 0, 0, 0, -3.0])), [0, 0, 0, 0, 0, -3], atol=1e-12
    )
    sideways = np.array([0, 0, 0, 2.0, 0, 3.0])
    np.testing.assert_allclose(uncarried(pushes, none, sideways), [0, 0, 0, 2, 0, 0], atol=1e-12)
    given = np.array([[0, 0, 0, 1.0, 0, 0]])
    assert np.linalg.norm(uncarried(pushes, given, sideways)) < 1e-12


def carriage(folder, amplitude):
    """A carriage of 40 mm in the channel of a rail of 200 mm, driven along it."""
    rail = block(0.2, 0.06, 0.02).translate((0, 0, -0.01))
    walls = [block(0.2, 0.01, 0.04).translate((0, y, 0.0)) for y in (-0.025, 0.025)]
    save(rail + walls[0] + walls[1], folder / "rail.stl")
    box = block(0.04, 0.04, 0.02).translate((0, 0, 0.01))
    save(box, folder / "carriage.stl")
    text = f"""schema = 1
[assembly]
name = "guide"
units = "m"
ground = "rail"
[[part]]
name = "rail"
mesh = "rail.stl"
density = 1000
[[part]]
name = "carriage"
mesh = "carriage.stl"
density = 1000
[[function.joint]]
name = "stroke"
between = ["rail", "carriage"]
type = "prismatic"
axis = [1, 0, 0]
[[function.drive]]
joint = "stroke"
kind = "motion"
law = {{type = "sine", amplitude = {amplitude}, frequency = 1}}
[simulation]
duration = 0.3
step = 0.01
"""
    (folder / "guide.toml").write_text(text)
    return run(folder / "guide.toml")


@pytest.mark.parametrize(("amplitude", "leaves"), [(0.119, False), (0.15, True)])
def test_a_carriage_disengages_beyond_the_end_of_its_rail(tmp_path, amplitude, leaves):
    design = carriage(tmp_path, amplitude)
    assert [joint.type for joint in design.kinematics.joints] == ["prismatic"]
    assert design.simulation.status == "done"
    found = findings(design, "KF507")
    assert bool(found) == leaves
    if leaves:
        # 120 mm is where the middles of rail and carriage are half of both lengths apart.
        assert 120.0 in map(abs, numbers(found[0].intended))


def bar_in_two_guides(folder, stroke):
    """A square bar along x through a plate of the base and through one of a sledge, which slides along the base and is
    driven not to: the bar leaves the first 25 mm on, the second 65 mm on."""
    hole = block(0.4, 0.01, 0.01).translate((0, 0, 0.03))
    groove = block(0.3, 0.02, 0.01).translate((0, 0, -0.015)) + block(0.3, 0.012, 0.03).translate((0, 0, -0.005))
    plate = block(0.02, 0.04, 0.05).translate((0, 0, 0.025))
    base = block(0.2, 0.04, 0.04).translate((0, 0, -0.02)) - groove + (plate - hole)
    runner = block(0.02, 0.02, 0.01).translate((0, 0, -0.015)) + block(0.02, 0.012, 0.02).translate((0, 0, -0.005))
    sledge = (runner + plate).translate((0.04, 0, 0)) - hole
    save(base, folder / "base.stl")
    save(sledge, folder / "sledge.stl")
    save(block(0.085, 0.01, 0.01).translate((0.0275, 0, 0.03)), folder / "bar.stl")
    text = '[assembly]\nname = "guides"\nunits = "m"\nground = "base"\n'
    for name in ("base", "sledge", "bar"):
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 1000\n'
    for name, part, amplitude in (("still", "sledge", 0.0), ("stroke", "bar", stroke)):
        text += f'''[[function.joint]]
name = "{name}"
between = ["base", "{part}"]
type = "prismatic"
axis = [1, 0, 0]
[[function.drive]]
joint = "{name}"
kind = "motion"
law = {{type = "ramp", rate = {amplitude}}}
'''
    (folder / "guides.toml").write_text(f"schema = 1\n{text}[simulation]\nduration = 1.0\nstep = 0.02\n")
    return run(folder / "guides.toml")


@pytest.mark.parametrize(("stroke", "leaves"), [(0.02, []), (0.05, []), (0.08, ["bar~sledge"])])
def test_a_bar_disengages_with_the_last_of_the_guides_that_hold_it_alike(tmp_path, stroke, leaves):
    design = bar_in_two_guides(tmp_path, stroke)
    assert [joint.type for joint in design.kinematics.joints] == ["prismatic"] * 3
    assert design.simulation.status == "done"
    assert [finding.subject for finding in findings(design, "KF507")] == [(name,) for name in leaves]


def test_a_carriage_overhanging_its_rail_tips_once_its_middle_is_beyond_the_end(tmp_path):
    """Contact that does not enclose: on the overlap that is left, the weight stands until 100 mm."""
    assert not findings(carriage(tmp_path, 0.095), "KF506")
    assert len(findings(carriage(tmp_path, 0.115), "KF506")) == 1


def bridge(folder, weight_at):
    """A beam of 200 mm on two cubes that stand on a table; a load of 100 N pushes it down at `weight_at` (m)."""
    save(block(0.6, 0.4, 0.02).translate((0, 0, -0.01)), folder / "table.stl")
    for name, x in (("left", -0.06), ("right", 0.06)):
        save(block(BLOCK, BLOCK, BLOCK).translate((x, 0, BLOCK / 2)), folder / f"{name}.stl")
    beam = block(0.24, BLOCK, 0.02).translate((0, 0, BLOCK + 0.01))
    save(beam, folder / "beam.stl")
    parts = "".join(
        f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 1000\n'
        for name in ("table", "left", "right", "beam")
    )
    x, y = weight_at
    text = f"""schema = 1
[assembly]
name = "bridge"
units = "m"
ground = "table"
{parts}
[function]
[[function.load]]
part = "beam"
force = [0, 0, -100]
point = [{x}, {y}, 0.06]
[simulation]
duration = 0.02
step = 0.01
"""
    (folder / "bridge.toml").write_text(text)
    return run(folder / "bridge.toml")


@pytest.mark.parametrize(
    ("place", "lifts"), [((0.0, 0.0), False), ((0.07, 0.015), False), ((0.09, 0.0), True), ((0.0, 0.025), True)]
)
def test_however_a_load_is_shared_by_redundant_supports_it_must_be_between_them(tmp_path, place, lifts):
    """The supports end at x = ±80 mm and y = ±20 mm: their own weights, 0.63 N each, count little beside 100 N."""
    design = bridge(tmp_path, place)
    assert design.simulation.status == "done"
    assert design.kinematics.mobility.redundant == 3
    assert design.simulation.undetermined.any()
    found = findings(design, "KF506")
    assert bool(found) == lifts
    for finding in found:
        assert finding.severity == "warning"
        assert set(finding.subject) == {"beam~left", "beam~right", "left~table", "right~table"}


def clevis(folder, force):
    """A pin with a head at y = 20 mm, without a clip, through a fork and an arm; a force (N) along y pushes it."""
    rod = lambda radius, length, at: round_block(radius, length).translate((0, at, 0))
    bore = rod(0.00503, 0.08, 0.0)
    cheeks = [block(0.024, 0.01, 0.024).translate((0, y, 0)) for y in (-0.015, 0.015)]
    save(cheeks[0] + cheeks[1] + block(0.024, 0.04, 0.008).translate((0, 0, -0.016)) - bore, folder / "fork.stl")
    save(block(0.02, 0.0199, 0.02) - bore, folder / "arm.stl")
    save(rod(0.005, 0.049, -0.0005) + rod(0.008, 0.004, 0.022), folder / "pin.stl")
    text = 'schema = 1\n[assembly]\nname = "clevis"\nunits = "m"\nground = "fork"\n'
    for name in ("fork", "arm", "pin"):
        text += f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 1000\n'
    text += f"[[function.load]]\npart = 'pin'\nforce = [0, {force}, 0]\npoint = [0, 0, 0]\n"
    (folder / "clevis.toml").write_text(text + "[simulation]\nduration = 0.02\nstep = 0.01\n")
    return run(folder / "clevis.toml")


def round_block(radius, length):
    """A rod along y about the origin."""
    return centred_rod(radius, length, 48).rotate((-90, 0, 0))


@pytest.mark.parametrize(("force", "leaves"), [(-5.0, False), (5.0, True)])
def test_a_pin_is_pushed_out_past_the_side_where_it_has_no_head(tmp_path, force, leaves):
    design = clevis(tmp_path, force)
    assert design.simulation.status == "done"
    found = findings(design, "KF506")
    assert [finding.subject for finding in found if finding.severity == "warning"] == [("fork~pin",)] * leaves
    assert leaves or outcome(design, "KF506") == "passed"
