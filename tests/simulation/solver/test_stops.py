"""End stops against closed forms of sliders under constant and periodic forces, and what runs into them and cannot."""

import numpy as np
import pytest
from support.manifests import stated_joint, stated_part

import kinform
from kinform.behaviour import Constant, Model, Sine
from kinform.simulation import Course, SolverSettings, simulate_system

NOTHING = (0.0, 0.0, 0.0)


def sliders(masses, stops, efforts, axis=(1, 0, 0)):
    """Bodies that slide on each other along one line: j0 on the ground, j1 on the first body, …"""
    model = Model()
    model.ground("frame")
    before = "frame"
    for k, (mass, limits, effort) in enumerate(zip(masses, stops, efforts, strict=True)):
        model.body(f"b{k}", mass, NOTHING, (1e-3, 1e-3, 1e-3))
        model.joint(f"j{k}", before, f"b{k}", "prismatic", axis=axis, point=NOTHING)
        if limits is not None:
            model.stop(f"s{k}", f"j{k}", *limits)
        if effort is not None:
            model.effort(f"e{k}", f"j{k}", effort)
        before = f"b{k}"
    return model.system("sliders")


@pytest.mark.parametrize("method", ["explicit", "implicit"])
@pytest.mark.parametrize("share", [0.5, 0.99, 0.9999])
def test_a_stop_just_below_the_top_of_a_throw_is_met(method, share):
    """The whole throw is one step: its end is below the stop again."""
    speed, g = 5.0, 9.81
    limit = share * speed**2 / (2 * g)
    system = sliders([1.0], [(-10.0, limit)], [None], axis=(0, 0, 1))
    run = simulate_system(
        system, Course(1.0, 0.001), initial={"j0": (0.0, speed)}, settings=SolverSettings(method=method)
    )
    met = (speed - np.sqrt(speed**2 - 2 * g * limit)) / g
    t = run.time
    expected = np.where(t < met, speed * t - g * t**2 / 2, limit - g * np.maximum(t - met, 0.0) ** 2 / 2)
    np.testing.assert_allclose(run.joint_position[:, 0], expected, atol=1e-7)


def test_an_impact_on_one_stop_lifts_a_joint_off_another():
    """A bead runs to the end of its track on a cart pressed on a wall: cart and bead go on with half its speed."""
    system = sliders([1.0, 1.0], [(0.0, np.inf), (-1.0, 0.2)], [Constant(-0.5), None])
    run = simulate_system(system, Course(3.0, 0.05, NOTHING), initial={"j0": (0.0, 0.0), "j1": (0.0, 1.0)})
    t = np.maximum(run.time - 0.2, 0.0)
    np.testing.assert_allclose(run.joint_position[:, 0], 0.5 * t - 0.125 * t**2, atol=1e-9)
    np.testing.assert_allclose(run.joint_position[:, 1], np.minimum(run.time, 0.2), atol=1e-9)


def test_ever_smaller_leaps_between_two_stops_come_to_an_end():
    """A bead between two stops of a cart, pressed by forces on its own stop and with the cart on that of the ground."""
    masses, efforts = (1.96, 0.948), (0.5466, -0.9393)
    system = sliders(masses, [(-0.2256, 0.3341), (-0.4567, 0.2885)], [Constant(f) for f in efforts])
    run = simulate_system(system, Course(6.0, 0.5, NOTHING), initial={"j0": (0.0, 0.4139), "j1": (0.0, -0.2515)})
    assert run.status == "done"
    np.testing.assert_allclose(run.joint_position[-1], [0.3341, -0.4567], atol=1e-9)
    np.testing.assert_allclose(run.joint_velocity[-1], 0.0, atol=1e-9)
    # At rest the stops carry all that presses on them.
    np.testing.assert_allclose(run.joint_effort[-1], 0.0, atol=1e-9)


@pytest.mark.parametrize("method", ["explicit", "implicit"])
def test_a_stop_lets_go_in_every_period_of_a_fast_law(method):
    """A slider at rest on its stop allows any step; the law pulls it off for a moment seven times a second."""
    speed, level, amplitude = 2 * np.pi * 7.0, -1.0, 1.5
    model = Model()
    model.ground("frame")
    model.body("b", 2.0, NOTHING, (1e-3, 1e-3, 1e-3))
    model.joint("j0", "frame", "b", "prismatic", axis=(1, 0, 0), point=NOTHING)
    model.stop("s", "j0", 0.0, np.inf)
    model.effort("e", "j0", Sine(level, amplitude, speed, 0.0))
    system = model.system("slider")
    run = simulate_system(
        system, Course(0.5, 0.002, NOTHING), initial={"j0": (0.0, 0.0)}, settings=SolverSettings(method=method)
    )
    off = np.arcsin(-level / amplitude) / speed

    def free(t):
        """Position after it left at `off`, at rest."""
        s = t - off
        swing = amplitude / speed * (np.cos(speed * off) * s - (np.sin(speed * t) - np.sin(speed * off)) / speed)
        return (level * s**2 / 2 + swing) / 2.0

    phase = run.time % (1.0 / 7.0)
    fine = np.linspace(off + 1e-4, 1.0 / 7.0 + off, 200_001)
    back = fine[np.flatnonzero(free(fine) < 0.0)[0]]
    assert back < 1.0 / 7.0
    expected = np.where((phase > off) & (phase < back), free(np.maximum(phase, off)), 0.0)
    np.testing.assert_allclose(run.joint_position[:, 0], expected, atol=1e-7)


def test_a_start_beyond_a_stop_is_refused_by_the_name_of_the_joint():
    run = simulate_system(sliders([1.0], [(0.1, 0.2)], [None]), Course(1.0, 0.1))
    assert run.status == "refused"
    assert [name for name, _ in run.failures] == ["j0"]


def test_a_prescribed_motion_through_a_stop_ends_there_and_says_so():
    model = Model()
    model.ground("frame")
    model.body("b", 1.0, NOTHING, (1e-3, 1e-3, 1e-3))
    model.joint("j", "frame", "b", "prismatic", axis=(1, 0, 0), point=NOTHING)
    model.stop("s", "j", -0.1, 0.1)
    model.motion("m", "j", Sine(0.0, 0.3, 5.0, 0.0))
    run = simulate_system(model.system("driven"), Course(1.0, 0.01))
    assert run.status == "stopped"
    assert run.time[-1] == pytest.approx(np.arcsin(1 / 3) / 5, abs=0.01)


@pytest.mark.parametrize(
    ("duration", "step", "gravity"),
    [(np.nan, 0.1, NOTHING), (-1.0, 0.1, NOTHING), (1.0, 0.0, NOTHING), (1.0, 0.1, (0, 0, np.nan))],
)
def test_a_course_of_impossible_numbers_is_refused(duration, step, gravity):
    with pytest.raises(ValueError, match=r"duration|step|gravity"):
        Course(duration, step, gravity)


def test_a_bouncing_body_leaps_as_high_as_restitution_says_and_comes_to_rest():
    height, e, g = 0.5, 0.6, 9.81
    system = sliders([2.0], [(0.0, np.inf, e)], [None], axis=(0, 0, 1))
    run = simulate_system(system, Course(2.0, 0.001), initial={"j0": (height, 0.0)})
    assert run.status == "done"
    begin, leap = np.sqrt(2.0 * height / g), np.sqrt(2.0 * g * height) * e
    expected = np.where(run.time < begin, height - 0.5 * g * run.time**2, 0.0)
    for _ in range(200):
        t = run.time - begin
        expected = np.where((t >= 0.0) & (t < 2.0 * leap / g), leap * t - 0.5 * g * t**2, expected)
        begin, leap = begin + 2.0 * leap / g, e * leap
    np.testing.assert_allclose(run.joint_position[:, 0], expected, atol=1e-7)
    # Half of the energy that is lost is lost at the first impact, by e².
    lost = -run.energy[-1] @ [1.0, 1.0, -1.0] + run.energy[0] @ [1.0, 1.0, -1.0]
    assert abs(lost) < 1e-9 and run.energy[-1, 2] == pytest.approx(-2.0 * g * height, rel=1e-8)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_bead_that_strikes_the_end_of_its_track_shares_its_momentum(e):
    """Two free bodies: momentum stays, and they part at a share of the pace at which they met."""
    first, second = 2.0, 0.5
    system = sliders([first, second], [None, (-1.0, 0.2, e)], [None, None])
    run = simulate_system(system, Course(0.5, 0.01, NOTHING), initial={"j0": (0.0, 0.0), "j1": (0.0, 1.0)})
    cart = second * (1.0 + e) / (first + second)
    t = np.maximum(run.time - 0.2, 0.0)
    np.testing.assert_allclose(run.joint_position[:, 0], cart * t, atol=1e-10)
    np.testing.assert_allclose(run.joint_position[:, 1], np.minimum(run.time, 0.2) - e * t, atol=1e-10)


def test_a_restitution_that_is_no_share_is_refused():
    run = simulate_system(sliders([1.0], [(0.0, 1.0, 1.5)], [None]), Course(0.1, 0.05, NOTHING))
    assert run.status == "refused" and len(run.failures) == 1


@pytest.mark.parametrize(("named", "axis"), [(("rail", "block"), 1.0), (("block", "rail"), -1.0)])
def test_a_manifest_has_stops_at_the_ends_of_stated_ranges(named, axis, tmp_path):
    """A block thrown along its rail, with the axis and the order of the bodies as the designer likes."""
    path = tmp_path / "rail.toml"
    path.write_text(
        'schema = 1\n[assembly]\nname = "rail"\nunits = "mm"\nground = "rail"\n[[part]]\nname = "rail"\n'
        + stated_part("block", 1.0)
        + stated_joint("way", named, "prismatic", (axis, 0.0, 0.0))
        + "range = [-1000, 30]\n"
        + '[simulation]\nduration = 1.0\ngravity = [0, 0, 0]\nstops = "range"\nrestitution = 0.5\n'
        + "[simulation.initial.way]\nvelocity = 100\n"
    )
    run = kinform.run(path).simulation
    expected = np.where(run.time < 0.3, 0.1 * run.time, 0.03 - 0.05 * (run.time - 0.3))
    np.testing.assert_allclose(np.abs(run.joint_position[:, 0]), np.abs(expected), atol=1e-9)
    assert [use.kind for use in run.drives] == ["stop"]


def _railed(tmp_path, kind, more):
    path = tmp_path / "rail.toml"
    path.write_text(
        'schema = 1\n[assembly]\nname = "rail"\nunits = "mm"\nground = "rail"\n[[part]]\nname = "rail"\n'
        + stated_part("block", 1.0)
        + stated_part("cart", 1.0)
        + stated_joint("way", ("rail", "cart"), "prismatic", (1.0, 0.0, 0.0))
        + "range = [-1000, 30]\n"
        + stated_joint("aside", ("cart", "block"), kind, (0.0, 1.0, 0.0))
        + more
    )
    return kinform.run(path).simulation.assumptions


def test_joints_that_are_asked_to_stop_and_have_no_stop_are_named(tmp_path):
    asked = '[simulation]\nstops = "range"\nduration = 0.1\n'
    more = {"prismatic": asked, "planar": "range = [-1, 1]\n" + asked + "gravity = [0, 0, 0]\n"}
    for kind, text in more.items():
        assert any("block~cart" in note for note in _railed(tmp_path, kind, text))
