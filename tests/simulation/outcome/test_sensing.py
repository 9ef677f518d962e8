"""What sensors read, against closed forms; and that it comes through the manifest into results, tables and the page."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from support.devices import Z, device, drive, joint, rod

import kinform
from kinform import results
from kinform.behaviour import Model, Ramp
from kinform.errors import InputError
from kinform.exports import export
from kinform.form import load
from kinform.model.function import Law
from kinform.model.sensors import Sensor
from kinform.reports.page.plots import plot_groups
from kinform.simulation import Course, Probe, simulate, simulate_system

SPIN, SPEED, START = 3.0, 0.4, 0.2
ROD, MASS = 0.8, 1.5


def _column(run, sensor, quantity):
    found = [k for k, r in enumerate(run.readings) if (r.sensor, r.quantity) == (sensor, quantity)]
    values = run.sensed[:, found]
    return values[:, 0] if values.shape[1] == 1 else values


def _record_player():
    """A disc that turns about z with a slider that goes outwards on it."""
    model = Model()
    model.ground("ground")
    model.body("disc", 1.0, (0, 0, 0), (0.1, 0.1, 0.2))
    model.body("slider", 0.3, (START, 0, 0), (0.01, 0.01, 0.01))
    model.joint("spindle", "ground", "disc", "revolute", axis=(0, 0, 1), point=(0, 0, 0))
    model.joint("groove", "disc", "slider", "prismatic", axis=(1, 0, 0))
    model.motion("turn", "spindle", Ramp(0.0, SPIN))
    model.motion("out", "groove", Ramp(0.0, SPEED))
    return model.system()


@pytest.fixture(scope="module", params=["kinematic", "dynamic"])
def played(request):
    """(level, run) of the record player, with sensors on it."""
    start = np.array([START, 0.0, 0.0])
    probes = (
        Probe("world", "point", "slider", point=start),
        Probe("on the disc", "point", "slider", point=start, frame="disc"),
        Probe("turning", "rotation", "slider"),
        Probe("itself", "rotation", "slider", frame="disc"),
        Probe("apart", "distance", "ground", "slider", point=np.zeros(3), other_point=start),
        Probe("turned", "angle", "ground", "slider", axis=np.array([0.0, 0.0, 1.0])),
        Probe("angle", "angle", "ground", "slider"),
    )
    # Outputs are four radians apart: further than half a turn.
    return request.param, simulate_system(
        _record_player(), Course(12.0, 4.0 / SPIN, level=request.param), probes=probes
    )


def test_a_point_moves_as_in_rotating_axes(played):
    _, run = played
    t, r = run.time, START + SPEED * run.time
    c, s, zero = np.cos(SPIN * t), np.sin(SPIN * t), np.zeros_like(t)
    out, across = np.column_stack([c, s, zero]), np.column_stack([-s, c, zero])
    velocity = SPEED * out + (r * SPIN)[:, None] * across
    acceleration = -(r * SPIN**2)[:, None] * out + 2.0 * SPEED * SPIN * across
    np.testing.assert_allclose(_column(run, "world", "position"), r[:, None] * out, atol=1e-12)
    np.testing.assert_allclose(_column(run, "world", "velocity"), velocity, atol=1e-11)
    np.testing.assert_allclose(_column(run, "world", "acceleration"), acceleration, atol=1e-10)


def test_seen_from_the_disc_it_goes_straight(played):
    _, run = played
    straight = np.outer(START + SPEED * run.time, [1.0, 0.0, 0.0])
    np.testing.assert_allclose(_column(run, "on the disc", "position"), straight, atol=1e-12)
    np.testing.assert_allclose(_column(run, "on the disc", "velocity") - [SPEED, 0.0, 0.0], 0.0, atol=1e-12)
    np.testing.assert_allclose(_column(run, "on the disc", "acceleration"), 0.0, atol=1e-10)
    np.testing.assert_allclose(_column(run, "turning", "angular velocity") - [0.0, 0.0, SPIN], 0.0, atol=1e-12)
    np.testing.assert_allclose(_column(run, "itself", "angular velocity"), 0.0, atol=1e-12)


def test_distances_and_angles_between_bodies(played):
    _, run = played
    np.testing.assert_allclose(_column(run, "apart", "distance"), START + SPEED * run.time, atol=1e-12)
    np.testing.assert_allclose(_column(run, "apart", "rate"), SPEED, atol=1e-12)
    np.testing.assert_allclose(_column(run, "turned", "angle"), SPIN * run.time, atol=1e-10)
    np.testing.assert_allclose(_column(run, "turned", "rate"), SPIN, atol=1e-12)
    folded = np.abs(np.mod(SPIN * run.time + np.pi, 2.0 * np.pi) - np.pi)
    np.testing.assert_allclose(_column(run, "angle", "angle"), folded, atol=1e-10)
    assert {r.sensor for r in run.readings} == {"world", "on the disc", "turning", "itself", "apart", "turned", "angle"}


def test_probes_on_what_is_not_there_are_refused():
    course = Course(0.1, 0.1)
    with pytest.raises(ValueError, match='"plate"'):
        simulate_system(_record_player(), course, probes=[Probe("p", "rotation", "plate")])
    with pytest.raises(ValueError, match='"hinge"'):
        simulate_system(_record_player(), course, probes=[Probe("p", "reaction", joint="hinge")])


def _pendulum(tmp_path, sensors):
    """A rod of sticks in a hinge that turns it at a constant rate, as a manifest in millimetres; it hangs at first."""
    inertia = MASS * ROD**2 / 12.0
    text = f"""
schema = 1
[assembly]
name = "pendulum"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "rod"
mass = {MASS}
centre_of_mass = [0, 0, {-500.0 * ROD}]
inertia = [[{inertia}, 0, 0], [0, {inertia}, 0], [0, 0, 0]]
[[function.joint]]
name = "hinge"
between = ["rod", "frame"]
type = "revolute"
axis = [0, 1, 0]
point = [0, 0, 0]
[[function.drive]]
joint = "hinge"
kind = "motion"
law = {{type = "ramp", rate = {float(np.degrees(SPIN))!r}}}
[simulation]
duration = 1.0
step = 0.05
{sensors}"""
    path = tmp_path / "pendulum.toml"
    path.write_text(text)
    return path


SENSORS = """
[[simulation.sensor]]
name = "pin"
kind = "reaction"
joint = "hinge"
part = "rod"
frame = "rod"
[[simulation.sensor]]
name = "pin on the frame"
kind = "reaction"
joint = "hinge"
[[simulation.sensor]]
name = "tip"
kind = "point"
part = "rod"
point = [0, 0, -800]
[[simulation.sensor]]
name = "middle"
kind = "point"
part = "rod"
"""


@pytest.fixture(scope="module")
def swung(tmp_path_factory):
    """The pendulum's results, with all sensors."""
    return kinform.run(_pendulum(tmp_path_factory.mktemp("swung"), SENSORS))


def test_the_reaction_of_a_turning_pendulum(swung):
    run = swung.simulation
    # The values of the joint are of the frame relative to the rod: the rod turns the other way about y.
    angle = -SPIN * run.time
    s, c, g = np.sin(angle), np.cos(angle), 9.81
    # In the rod's axes gravity is (g s, 0, -g c), and its middle is drawn in to the pin, along z.
    inner = MASS * np.column_stack([-g * s, 0.0 * s, g * c + SPIN**2 * ROD / 2.0])
    np.testing.assert_allclose(_column(run, "pin", "force"), inner, atol=1e-9)
    world = MASS * np.column_stack([SPIN**2 * ROD / 2.0 * s, 0.0 * s, g + SPIN**2 * ROD / 2.0 * c])
    np.testing.assert_allclose(_column(run, "pin on the frame", "force"), -world, atol=1e-9)
    place = ROD * np.column_stack([-s, 0.0 * s, -c])
    np.testing.assert_allclose(_column(run, "tip", "position"), place, atol=1e-12)
    np.testing.assert_allclose(_column(run, "middle", "acceleration"), -(SPIN**2) * place / 2.0, atol=1e-10)


def test_what_the_drive_must_do_is_that_of_the_pendulum(swung):
    run, use = swung.simulation, swung.simulation.drives[0]
    torque = MASS * 9.81 * ROD / 2.0 * np.sin(SPIN * run.time)
    np.testing.assert_allclose(np.abs(run.drive_effort[:, 0]), np.abs(torque), atol=1e-9)
    np.testing.assert_allclose(run.drive_effort[:, 0] * run.drive_speed[:, 0], SPIN * torque, atol=1e-8)
    assert use.peak_speed == pytest.approx(SPIN, abs=1e-12)
    assert use.rms_power == pytest.approx(SPIN * use.rms, rel=1e-12)


def test_tables_have_what_sensors_drives_and_joints_say(swung, tmp_path):
    files = export(swung.design, "csv").files
    header, *rows = csv.reader(io.StringIO(files["sensors.csv"].decode()))
    assert header[:5] == ["time", "pin.force.x", "pin.force.y", "pin.force.z", "pin.torque.x"]
    np.testing.assert_array_equal(np.array(rows, dtype=float)[:, 1:], swung.simulation.sensed)
    header, *rows = csv.reader(io.StringIO(files["reactions.csv"].decode()))
    second = header.index("hinge on rod.force.x")
    found = np.array(rows, dtype=float)[:, second : second + 3]
    np.testing.assert_allclose(found, -_column(swung.simulation, "pin on the frame", "force"), atol=1e-12)
    header, *rows = csv.reader(io.StringIO(files["drives.csv"].decode()))
    assert header == ["time", *(f"1 hinge motion.{what}" for what in ("effort", "speed", "power"))]
    # The designer's value of the hinge grows.
    np.testing.assert_allclose(np.array(rows, dtype=float)[:, 2], SPIN, atol=1e-12)


def test_results_keep_them_and_the_page_draws_them(swung, tmp_path):
    results.write(swung.design, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5").simulation
    assert again.readings == swung.simulation.readings
    for name in ("sensed", "drive_effort", "drive_speed"):
        np.testing.assert_array_equal(getattr(again, name), getattr(swung.simulation, name))
    groups = {heading: drawn for heading, drawn, _ in plot_groups(swung.design)}
    assert sum("tip: acceleration" in svg for svg in groups["Sensors"]) == 1
    assert "mm/s²" in next(svg for svg in groups["Sensors"] if "tip: acceleration" in svg)
    (sized,) = groups["Effort over speed of the drives"]
    assert "28.65 1/min" in sized  # 3 rad/s
    values = swung.summary("simulation")["sensors"]
    assert next(v for v in values if (v["sensor"], v["component"]) == ("tip", "z"))["start"] == pytest.approx(-ROD)


@pytest.mark.parametrize(
    ("sensors", "named"),
    [
        ('[[simulation.sensor]]\nname = "a"\nkind = "point"\npart = "rot"', '"rot"'),
        ('[[simulation.sensor]]\nname = "a"\nkind = "reaction"\njoint = "pin"', '"pin"'),
        (
            2 * '[[simulation.sensor]]\nname = "a"\nkind = "rotation"\npart = "rod"\n',
            '"a"',
        ),
        (
            '[[simulation.sensor]]\nname = "a"\nkind = "angle"\nbetween = ["rod", "frame"]\naxis = [0, 0, 0]',
            "axis",
        ),
    ],
)
def test_wrong_sensors_are_told_with_their_line(tmp_path, sensors, named):
    with pytest.raises(InputError) as error:
        load(_pendulum(tmp_path, sensors))
    problem = error.value.problems[0]
    assert named in problem.message and problem.line >= 29


def test_a_sensor_that_reads_nothing_is_named():
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), rod("tip", (1, 0, 0), (2, 0, 0))]
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0)), joint("arm", "tip", "fixed", Z, (1, 0, 0))]
    push = drive("arm~base", "motion", Law("constant", value=0.0))
    sensors = (
        Sensor("a", "angle", "arm", "nowhere"),
        Sensor("b", "reaction", joint="arm~base"),
    )
    made = device(parts, joints, drives=[push], duration=0.1, step=0.1, level="kinematic", sensors=sensors)
    run = simulate(*made)
    assert run.readings == () and run.status == "done"
    silent = [note for note in run.assumptions if "sensor" in note]
    assert [name for note in silent for name in ("a", "b") if f'"{name}"' in note] == ["a", "b"]
