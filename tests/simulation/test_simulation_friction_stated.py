"""Friction as a manifest states it: radii and materials from contact, names and signs, what is refused, the file."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import first
from support.sleds import sled
from support.solids import box, rod, save

import kinform
from kinform.behaviour import Friction, Model
from kinform.errors import InputError
from kinform.form import load
from kinform.kinematics import functional
from kinform.simulation import Course, port_model, simulate_system
from kinform.simulation.solver import stick_slip

G = 9.81

WHEEL = """
schema = 1
[assembly]
name = "wheel"
units = "mm"
ground = "housing"
[[part]]
name = "housing"
mesh = "housing.stl"
material = "steel"
[[part]]
name = "wheel"
mesh = "wheel.stl"
material = "bronze"
[[friction]]
materials = ["bronze", "steel"]
coefficient = 0.1
static = 0.14
[function]
[[function.joint]]
name = "hinge"
between = ["wheel", "housing"]
type = "revolute"
axis = [0, 0, -1]
point = [0, 0, 0]
[[function.drive]]
joint = "hinge"
kind = "friction"
[simulation]
duration = 0.2
step = 0.1
gravity = [-9.81, 0, GRAVITY]
[simulation.initial.hinge]
velocity = 2000
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    housing = box(-30, 30, -30, 30, 0, 40) - rod(10, -1, 41, 64)
    save(housing, folder / "housing.stl")
    save(rod(10, -5, 45, 64) + rod(20, -15, 0, 64) + rod(20, 40, 50, 64), folder / "wheel.stl")
    path = folder / "wheel.toml"
    path.write_text(WHEEL.replace("GRAVITY", "-5.0"))
    return kinform.run(path)


def test_radius_ring_and_materials_come_from_the_contact(wheel):
    run, mass = wheel.simulation, wheel.mass["wheel"].mass
    assert run.status == "done", run.reason
    ring = 2.0 / 3.0 * (0.02**3 - 0.01**3) / (0.02**2 - 0.01**2)
    expected = 0.1 * mass * (0.01 * G + ring * 5.0)
    np.testing.assert_allclose(np.abs(run.friction_effort[:, 0]), expected, rtol=5e-3)
    assert any(note.startswith("friction on hinge: 0.1 in motion, 0.14 at rest") for note in run.assumptions)


def test_results_keep_friction_in_the_designers_sense(wheel, tmp_path):
    import h5py

    path = tmp_path / "wheel.h5"
    wheel.save(path)
    with h5py.File(path) as file:
        group = file["simulation"]
        assert group["friction_joints"].asstr()[:].tolist() == ["hinge"]
        rates = group["joint_velocity"][:, 0]
        assert np.all(group["friction_effort"][:, 0] * rates < 0.0)
        assert not group["friction_sticks"][:].any()
    again = kinform.open(path)
    for name in ("friction_effort", "friction_limit", "friction_sticks"):
        np.testing.assert_array_equal(getattr(again.simulation, name), getattr(wheel.simulation, name))
    before, after = (
        next(c for c in one.behaviour.system.components if isinstance(c, Friction)) for one in (wheel, again)
    )
    for name, value in vars(before).items():
        np.testing.assert_array_equal(getattr(after, name), value)


STICKS = """
schema = 1
[assembly]
name = "sled"
units = "m"
ground = "bed"
[[part]]
name = "bed"
[[part]]
name = "sled"
mass = 2.0
centre_of_mass = [0, 0, 0]
inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]
[function]
[[function.joint]]
name = "slide"
between = ["sled", "bed"]
type = "prismatic"
axis = [1, 0, 0]
[[function.drive]]
joint = "slide"
kind = "friction"
FRICTION
[simulation]
duration = 0.1
step = 0.1
[simulation.initial.slide]
velocity = -1
"""


def _sled(tmp_path, friction):
    path = tmp_path / "sled.toml"
    path.write_text(STICKS.replace("FRICTION", friction))
    return path


def test_a_sled_of_sticks_is_braked_by_its_weight_and_its_seal(tmp_path):
    run = kinform.run(_sled(tmp_path, "coefficient = 0.1\nstatic = 0.2\neffort = 0.5\nstatic_effort = 1.0")).simulation
    np.testing.assert_allclose(np.abs(run.friction_effort), 0.2 * G + 0.5, rtol=1e-12)
    np.testing.assert_allclose(run.friction_limit, 0.4 * G + 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.abs(run.joint_velocity[-1, 0]), 1.0 - 0.1 * (0.1 * G + 0.25), rtol=1e-12)


def test_friction_that_is_not_known_keeps_the_level_from_being_dynamic_and_says_why(tmp_path):
    run = kinform.run(_sled(tmp_path, "")).simulation
    why = "state its coefficient or its effort"
    assert run.level != "dynamic"
    assert any(why in told for _, told in run.not_dynamic)


@pytest.mark.parametrize(
    ("friction", "line"),
    [("coefficient = 0.3\nstatic = 0.2", "static = 0.2"), ("effort = 3.0\nstatic_effort = 1.0", "static_effort = 1.0")],
)
def test_friction_at_rest_below_that_in_motion_is_refused_with_its_line(tmp_path, friction, line):
    path = _sled(tmp_path, friction)
    number = path.read_text().splitlines().index(line) + 1
    with pytest.raises(InputError) as error:
        load(path)
    assert [(problem.file, problem.line) for problem in error.value.problems] == [("sled.toml", number)]


def test_friction_of_materials_that_do_not_exist_is_refused_and_the_nearest_named(tmp_path):
    path = _sled(tmp_path, "coefficient = 0.3")
    path.write_text(path.read_text() + '[[friction]]\nmaterials = ["steel", "bronse"]\ncoefficient = 0.3\n')
    with pytest.raises(InputError, match=r'"bronse"[\s\S]*"bronze"'):
        load(path)


@pytest.mark.parametrize("turned", [False, True])
def test_friction_of_a_pair_of_materials_that_is_stated_twice_is_refused(tmp_path, turned):
    path = _sled(tmp_path, "coefficient = 0.3")
    second = '["pla", "steel"]' if turned else '["steel", "pla"]'
    text = path.read_text() + '[[friction]]\nmaterials = ["steel", "pla"]\ncoefficient = 0.3\n'
    path.write_text(text + f"[[friction]]\nmaterials = {second}\ncoefficient = 0.1\n")
    with pytest.raises(InputError, match='"pla" and "steel"'):
        load(path)


GUIDE = '[[function.drive]]\njoint = "slide"\nkind = "friction"\ncoefficient = 0.2\nlength = 80\n'


def _rail(tmp_path, first, second, **more):
    path = tmp_path / f"{first}.toml"
    path.write_text(sled(first, second, GUIDE, **more))
    return kinform.run(path).simulation


@pytest.mark.parametrize("turned", [False, True])
def test_names_do_not_decide_with_which_side_a_stated_length_goes_along(tmp_path, turned):
    """With the carriage, the second of `between`, its weight stays in the middle; on a bed it comes to the end of what
    carries, and presses there."""
    one, other = _rail(tmp_path, "rail", "carriage", turned=turned), _rail(tmp_path, "bed", "sled", turned=turned)
    places = [float(np.abs(run.joint_position[-1, 0])) for run in (one, other)]
    assert places[0] == pytest.approx(places[1], rel=1e-9)
    if turned:
        assert places[0] < 0.2
    else:
        assert places[0] == pytest.approx(1.0 / (2.0 * 0.2 * G), rel=1e-9)


@pytest.mark.parametrize("mass", first(2, [1e-3, 1e9, 1.0, 1e6]))
def test_how_heavy_it_is_changes_nothing(tmp_path, mass, monkeypatch):
    """Neither the motion nor the steps that it takes."""
    steps = []
    slope = stick_slip._Driver._slope
    monkeypatch.setattr(stick_slip._Driver, "_slope", lambda self, t, y: steps.append(t) or slope(self, t, y))
    run = _rail(tmp_path, "rail", "carriage", mass=mass)
    assert run.status == "done"
    assert float(np.abs(run.joint_position[-1, 0])) == pytest.approx(1.0 / (2.0 * 0.2 * G), rel=1e-8)
    assert 0 < len(steps) < 2000


def test_static_friction_below_that_in_motion_is_refused_with_its_line(tmp_path):
    path = _sled(tmp_path, "coefficient = 0.3")
    path.write_text(path.read_text() + '[[friction]]\nmaterials = ["steel", "pla"]\ncoefficient = 0.3\nstatic = 0.1\n')
    with pytest.raises(InputError):
        load(path)


def test_friction_alone_asks_for_no_simulation(tmp_path):
    path = _sled(tmp_path, "coefficient = 0.3")
    path.write_text(path.read_text().split("[simulation]")[0])
    assert kinform.run(path).simulation.status == "not requested"


def test_built_in_pairs_are_sorted_and_at_rest_not_less_than_in_motion():
    from kinform.behaviour.sliding import MATERIAL_PAIRS

    assert all(pair == tuple(sorted(pair)) and low <= high for pair, (low, high) in MATERIAL_PAIRS.items())


def test_a_screw_of_sticks_takes_the_radius_and_the_flank_that_are_stated(tmp_path):
    text = STICKS.replace("FRICTION", "coefficient = 0.1\nradius = 0.01\nflank = 15")
    text = text.replace('type = "prismatic"', 'type = "screw"\npoint = [0, 0, 0]\npitch = 0.005')
    path = tmp_path / "screw.toml"
    path.write_text(text)
    assembly = load(path)
    (friction,) = (
        c for c in port_model(assembly, functional(assembly), None).system.components if isinstance(c, Friction)
    )
    slope = 0.005 / (2.0 * np.pi * 0.01)
    cosine = 1.0 / np.sqrt(1.0 + np.tan(np.radians(15.0)) ** 2 / (1.0 + slope**2))
    np.testing.assert_allclose((friction.axial, friction.torsion), (0.01 / cosine, -slope / cosine), rtol=1e-12)


@pytest.mark.parametrize(("kind", "both"), [("planar", (1, 2)), ("cylindrical", (0, 1))])
def test_a_friction_for_each_direction_of_a_surface_is_refused_and_one_alone_is_not(kind, both):
    """Coulomb friction opposes the velocity of what slides; one along either direction would hold them apart."""
    runs = []
    for freedoms in (both[1:], both):
        model = Model()
        model.ground("ground")
        model.body("block", 2.0, (0, 0, 0), (0.01, 0.01, 0.01))
        model.joint("joint", "ground", "block", kind, axis=(0, 0, 1), point=(0, 0, 0))
        for freedom in freedoms:
            model.friction(f"friction {freedom}", "joint", effort=3.0, freedom=freedom)
        runs.append(simulate_system(model.system(), Course(1.0, 0.5, np.array([3.0, 1.0, -9.81]))))
    alone, crossed = runs
    assert alone.status == "done"
    assert crossed.status == "refused" and [subject for subject, _ in crossed.failures] == ["joint"]


def test_a_radius_that_cannot_act_keeps_the_run_from_being_dynamic_where_only_geometry_shows_it(tmp_path):
    """The manifest names the joint as kinform does, and does not say that it slides."""
    path = _sled(tmp_path, "coefficient = 0.1\nradius = 0.01")
    path.write_text(path.read_text().replace('joint = "slide"', 'joint = "bed~sled"'))
    run = kinform.run(path).simulation
    assert run.level != "dynamic"
    assert [subject for subject, _ in run.not_dynamic] == ["bed~sled"]


@pytest.mark.parametrize(("radius", "thrust", "known"), [(10, None, False), (None, 14, False), (10, 14, True)])
def test_a_stated_ring_does_not_stand_for_journals_that_differ(tmp_path, radius, thrust, known):
    """A shaft in two bores of different radii, with two rings of different radii: each is stated for itself."""
    housing = box(-40, 40, -40, 40, 0, 40) - rod(10, -1, 20, 64) - rod(14, 20, 41, 64)
    save(housing, tmp_path / "housing.stl")
    save(rod(10, -5, 20, 64) + rod(14, 20, 45, 64) + rod(22, -15, 0, 64) + rod(30, 40, 50, 64), tmp_path / "wheel.stl")
    stated = "".join(f"{key} = {value}\n" for key, value in (("radius", radius), ("thrust_radius", thrust)) if value)
    text = WHEEL.replace("GRAVITY", "-5.0").replace('kind = "friction"\n', 'kind = "friction"\n' + stated)
    (tmp_path / "wheel.toml").write_text(text)
    run = kinform.run(tmp_path / "wheel.toml").simulation
    if known:
        assert run.level == "dynamic"
    else:
        ((_, why),) = run.not_dynamic
        assert ("thrust_radius" in why) == bool(radius)
