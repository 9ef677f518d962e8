"""The table of all rules: for each an assembly on which it fires, and one like it on which it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.devices import body, intended, joint, sine
from support.mistakes import UNDECIDED, WRONG, changed_function, changed_joint, ignore, with_function
from support.places import FIXTURES, ROOT
from support.requirements import (
    CODES,
    ORIGIN,
    X,
    Y,
    Z,
    arm,
    bar,
    circle,
    design,
    gimbal,
    requiring,
    rubbing_arm,
    thin_wall,
    wall,
    wheel,
)

from kinform.consistency import RULES, check
from kinform.mass import compile_mass
from kinform.model.assembly import Assumption, MassOverride, Source, Subassembly
from kinform.model.checks import CheckSettings
from kinform.model.contacts import Suggestion
from kinform.model.function import Function, InitialValue, SimulationRequest
from kinform.model.kinematics import FiniteCertificate
from kinform.model.simulation import Damping
from kinform.simulation import simulate

HERE = Source("m.toml", 7)


@pytest.fixture
def hinge(derive_design):
    found = derive_design(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    own = found.kinematics.joints[0]
    stated = intended("swing", *own.bodies, "revolute", own.axis, own.point)
    return with_function(found, Function(mobility=1, mobility_line=19, joints=(stated,)))


def of_part(made, name, **changes):
    parts = tuple(replace(p, **changes) if p.name == name else p for p in made.assembly.parts)
    return replace(made, assembly=replace(made.assembly, parts=parts))


def of_assembly(made, **changes):
    return replace(made, assembly=replace(made.assembly, **changes))


def of_mobility(made, **changes):
    kinematics = made.kinematics
    return replace(made, kinematics=replace(kinematics, mobility=replace(kinematics.mobility, **changes)))


def of_mass(made, **changes):
    first, *rest = made.mass.parts
    return replace(made, mass=replace(made.mass, parts=(replace(first, **changes), *rest)))


def of_run(made, **changes):
    return replace(made, simulation=replace(made.simulation, **changes))


def far_away(made):
    X_WP = made.assembly.parts[0].X_WP.copy()
    X_WP[0, 3] = 1e6
    return of_part(made, made.assembly.parts[0].name, X_WP=X_WP)


def weightless(made):
    asked = of_assembly(made, simulation=SimulationRequest("dynamic", file="m.toml", line=50))
    parts = tuple(replace(p, density=None) for p in made.assembly.parts)
    asked = of_assembly(asked, parts=parts)
    mass = compile_mass(asked.assembly, made.kinematics)
    return replace(asked, mass=mass, simulation=simulate(asked.assembly, made.kinematics, mass))


def certified(made, **values):
    name = made.kinematics.joints[0].name
    found = FiniteCertificate((name,), 1, 1, moves=(name,), statement="special", **values)
    return of_mobility(made, certificates=(found,))


def threaded(made, pitch):
    own = made.kinematics.joints[0]
    made = changed_joint(made, type="screw", pitch=0.002)
    return changed_function(made, joints=(intended("swing", *own.bodies, "screw", own.axis, own.point, pitch=pitch),))


def triangle(kind=None):
    """Three bodies in a row, and perhaps a third joint that nobody wants."""
    joints = [joint("base", "one", "revolute", Y, ORIGIN), joint("one", "two", "revolute", Y, X)]
    wanted = [intended("a", "base", "one", "revolute", Y, ORIGIN), intended("b", "one", "two", "revolute", Y, X)]
    more = [] if kind is None else [joint("base", "two", kind, Y, (2.0, 0, 0))]
    return design([body("one"), body("two")], [*joints, *more], wanted=wanted)


def started(made, name):
    request = SimulationRequest(initial=(InitialValue(name, 1.0, 0.0, 1.0, "m.toml", 9),), file="m.toml", line=8)
    return of_assembly(made, simulation=request)


def hinted(made, infer):
    hint = Suggestion(("block", "shaft"), "holes", "4 aligned empty holes", np.array(Z), np.zeros(3))
    made = replace(made, contacts=replace(made.contacts, suggestions=(hint,)))
    return of_assembly(made, infer_fasteners=infer)


def of_step(made, share):
    """The shaft of a file whose numbers go in steps of this share of its size."""
    mesh = next(part.mesh for part in made.assembly.parts if part.name == "shaft")
    return of_part(made, "shaft", mesh=replace(mesh, resolution=share * mesh.diagonal))


def reacting(made, force):
    wrench = np.zeros((len(made.simulation.time), 1, 6))
    wrench[3, 0, 3] = force
    return of_run(made, F_A=wrench, undetermined=np.zeros((1, 6), dtype=bool))


def fixture(folder, name):
    return lambda derive: derive(FIXTURES / folder / name / f"{name}.toml")


def apart(derive):
    made = fixture("pairs", "free_apart")(derive)
    first, second = (p.name for p in made.assembly.parts)
    return with_function(made, Function(joints=(intended("j", first, second, "revolute", Z, ORIGIN),)))


def ranging(reach):
    """A disc that is driven to 30°, with a stated range."""
    made = wheel(RUN)
    (stated,) = made.assembly.function.joints
    return changed_function(made, joints=(replace(stated, range=(-np.radians(reach), np.radians(reach))),))


RUN = sine(30.0, 0.5)
POINT = {"part": "disc", "point": [0.1, 0, 0], "path": "p.csv", "tolerance": 1e-3}
STOCK = MassOverride(1.0, np.zeros(3), np.eye(3))

OF_A_HINGE = {
    "KF110": (far_away, None),
    "KF111": (lambda d: of_step(d, 1e-3), lambda d: of_step(d, 1e-5)),
    "KF120": (weightless, None),
    "KF121": (lambda d: of_mass(d, principal_moments=np.array([1.0, 1.0, 3.0])), None),
    "KF122": (lambda d: of_part(d, "shaft", override=STOCK), None),
    "KF207": (
        lambda d: of_assembly(
            d, assumptions=(Assumption(("block", "shaft"), "fixed", False, None, None, None, "glue", HERE),)
        ),
        None,
    ),
    "KF302": (
        lambda d: of_assembly(d, subassemblies=(Subassembly("x", "x.toml", 3, HERE),)),
        lambda d: of_assembly(d, subassemblies=(Subassembly("x", "x.toml", 0, HERE),)),
    ),
    "KF303": (lambda d: of_mobility(d, redundant=2), None),
    "KF304": (lambda d: of_mobility(d, idle_bodies=("shaft",)), None),
    "KF305": (lambda d: certified(d, infinitesimal=1), lambda d: certified(d)),
    "KF306": (lambda d: certified(d, singular=True, branches=(1, 1)), lambda d: certified(d)),
    "KF405": (lambda d: threaded(d, 0.003), lambda d: threaded(d, 0.002)),
    "KF410": (lambda d: started(d, "wing"), lambda d: started(d, "swing")),
    "KF440": (
        lambda d: of_assembly(d, check=CheckSettings(ignore=(ignore("KF201"),), file="m.toml", line=3)),
        lambda d: of_assembly(d, check=CheckSettings(select=("KF",), file="m.toml", line=3)),
    ),
    "KF906": (lambda d: hinted(d, True), lambda d: hinted(d, False)),
}
"""Code → what makes a sound hinge fire, and what nearly does (None: the hinge itself)."""

OF_THEIR_OWN = {
    "KF203": (fixture("pairs", "free_apart"), fixture("pairs", "revolute_collars")),
    "KF401": (apart, fixture("pairs", "revolute_collars")),
    "KF406": (lambda _: triangle("revolute"), lambda _: triangle("planar")),
    "KF407": (lambda _: triangle("planar"), lambda _: triangle("revolute")),
    "KF408": (lambda _: design([body("one")], [joint("base", "one", "revolute", Z, ORIGIN)],
                               wanted=[intended("a", "base", "base", "fixed")]), lambda _: triangle()),
    "KF413": (lambda _: ranging(29.0), lambda _: ranging(30.0)),
    "KF421": (
        lambda _: requiring(gimbal(), "reach", part="inner", direction=[1.0, 0, 0],
                            region={"type": "poses", "directions": [[0, 0, 1.0]]}),
        lambda _: requiring(gimbal(), "reach", part="inner", direction=[1.0, 0, 0],
                            region={"type": "poses", "directions": [[1.0, 0, 0]]}),
    ),
    "KF422": (lambda _: requiring(wheel(RUN), "follow", rows=circle(shift=0.002), **POINT),
              lambda _: requiring(wheel(RUN), "follow", rows=circle(shift=0.0005), **POINT)),
    "KF423": (lambda _: requiring(bar(thin_wall(), reach=60), "clear", between=["bar", "base"], over="ranges"),
              lambda _: requiring(bar(wall(), reach=30), "clear", between=["bar", "base"], over="ranges")),
    "KF434": (lambda _: requiring(rubbing_arm(), "efficiency", joint="shoulder", minimum=0.999),
              lambda _: requiring(rubbing_arm(), "efficiency", joint="shoulder", minimum=0.5)),
    "KF435": (lambda _: requiring(rubbing_arm(), "self_locking", joint="shoulder"),
              lambda _: requiring(rubbing_arm(1e3), "self_locking", joint="shoulder")),
    "KF436": (lambda _: requiring(wheel(RUN), "torque_speed", joint="spin", speeds=[0.0, 9.0], efforts=[1e-3, 0.0]),
              lambda _: requiring(wheel(RUN), "torque_speed", joint="spin", speeds=[0.0, 9.0], efforts=[1.0, 0.0])),
    "KF424": (lambda _: requiring(arm(), "hold", joint="shoulder", limit=1.0),
              lambda _: requiring(arm(), "hold", joint="shoulder", limit=10.0)),
    "KF425": (lambda _: requiring(wheel(RUN), "torque", joint="spin", limit=1e-3),
              lambda _: requiring(wheel(RUN), "torque", joint="spin", limit=1.0)),
    "KF426": (lambda _: requiring(wheel(RUN), "speed", joint="spin", limit=1.0),
              lambda _: requiring(wheel(RUN), "speed", joint="spin", limit=2.0)),
    "KF427": (lambda _: requiring(reacting(wheel(RUN), 5.0), "reaction", joint="spin", force=4.0),
              lambda _: requiring(reacting(wheel(RUN), 5.0), "reaction", joint="spin", force=6.0)),
    "KF428": (lambda _: requiring(arm(), "mass", of="upper", maximum=0.5),
              lambda _: requiring(arm(), "mass", of="upper", maximum=1.5)),
    "KF429": (lambda _: requiring(arm(), "centre_of_mass", of="upper", point=[0, 0, 0], tolerance=0.1),
              lambda _: requiring(arm(), "centre_of_mass", of="upper", point=[0, 0, 0], tolerance=0.2)),
    "KF430": (lambda _: requiring(arm(), "inertia", of="upper", axis=list(Y), maximum=1e-3),
              lambda _: requiring(arm(), "inertia", of="upper", axis=list(Y), maximum=1.0)),
    "KF431": (lambda _: requiring(arm(), "balance", of="upper", joint="shoulder", limit=0.1),
              lambda _: requiring(arm(), "balance", of="upper", joint="shoulder", limit=0.2)),
    "KF432": (lambda derive: requiring(fixture("pairs", "planar_block")(derive), "retained", part="block"),
              lambda derive: requiring(fixture("pairs", "revolute_collars")(derive), "retained", part="shaft")),
    "KF433": (
        lambda derive: requiring(fixture("pairs", "cylindrical_gap_015")(derive), "fit", between=["block", "shaft"],
                                 maximum=1e-4),
        lambda derive: requiring(fixture("pairs", "cylindrical_gap_015")(derive), "fit", between=["block", "shaft"],
                                 maximum=2e-4),
    ),
    "KF501": (lambda _: of_run(wheel(RUN), status="refused", reason="no ground"), lambda _: wheel(RUN)),
    "KF502": (lambda _: of_run(wheel(RUN), status="stopped", reason="singular"), lambda _: wheel(RUN)),
    "KF503": (lambda _: of_run(wheel(RUN), residual=np.full(101, 1e-3)), lambda _: wheel(RUN)),
    "KF508": (lambda _: of_run(wheel(RUN), dampings=(Damping(0.0, 1e4, 5.0),)), lambda _: wheel(RUN)),
    "KF509": (
        lambda _: of_run(wheel(RUN), level="kinematic", not_dynamic=(("disc", "its mass is not known"),)),
        lambda _: of_run(wheel(RUN, level="kinematic"), level="kinematic"),
    ),
    "KF504": (lambda _: of_run(wheel(RUN), energy=np.linspace(0, 1, 303).reshape(101, 3)), lambda _: wheel(RUN)),
}  # fmt: skip
"""Code → a design on which the rule fires, and one on which it does not."""


WHOLE = {"KF110", "KF301", "KF302", "KF303", "KF440", "KF501", "KF502", "KF503", "KF504", "KF508", "KF509"}
"""Rules about the assembly, a run or the settings as a whole: they have no place in space."""
ELSEWHERE_IN_SPACE = {"KF409", "KF410", "KF421", "KF432", "KF902"}
"""Rules whose place is that of something that may not be there, or a direction."""


def fired(made):
    """Codes of the findings, each of which says what was found and intended, where, and what to do."""
    report = check(made)
    for finding in report.findings:
        stated = (finding.subject, finding.message, finding.found, finding.intended, finding.remedy, finding.file)
        assert all(stated), finding
        assert finding.line is not None, finding
        assert finding.place is not None or finding.code in WHOLE | ELSEWHERE_IN_SPACE, finding
    return {finding.code for finding in report.findings}


@pytest.mark.parametrize("code", OF_A_HINGE)
def test_a_rule_fires_on_a_wrong_hinge_and_not_on_one_like_it(hinge, code):
    wrong, right = OF_A_HINGE[code]
    assert code in fired(wrong(hinge))
    assert code not in fired(hinge if right is None else right(hinge))


@pytest.mark.parametrize("code", OF_THEIR_OWN)
def test_a_rule_fires_on_a_wrong_design_and_not_on_one_like_it(derive_design, code):
    wrong, right = OF_THEIR_OWN[code]
    assert code in fired(wrong(derive_design))
    made = right(derive_design)
    assert code not in fired(made)
    if code in CODES.values():
        outcome = next(rule for rule in check(made).rules if rule.code == code)
        assert outcome.outcome == "passed", outcome


ELSEWHERE = (
    "KF209", "KF211", "KF123", "KF124", "KF125", "KF130", "KF131", "KF132", "KF133", "KF411", "KF412", "KF415", "KF417",
    "KF418", "KF419", "KF450", "KF505", "KF506", "KF507",
)  # fmt: skip
"""Rules with assemblies of their own in other files."""


@pytest.mark.parametrize("code", ELSEWHERE)
def test_a_rule_that_is_tried_elsewhere_is_named_there(code):
    others = (path for path in (ROOT / "tests").rglob("test_*.py") if path != Path(__file__))
    assert any(f'"{code}"' in path.read_text(encoding="utf-8") for path in others)


def test_every_rule_is_in_the_table():
    tables = (WRONG, UNDECIDED, OF_A_HINGE, OF_THEIR_OWN)
    listed = [code for table in tables for code in table]
    assert sorted([*listed, *ELSEWHERE]) == [rule.code for rule in RULES]


def test_a_mobility_that_two_ways_to_count_give_differently_is_not_decided(hinge):
    for stated in (1, 2):
        made = of_mobility(
            changed_function(hinge, mobility=stated), on_edge=True, finite_reason="a rank is on the edge"
        )
        (rule,) = (rule for rule in check(made).rules if rule.code == "KF301")
        assert (rule.outcome, rule.reason) == ("inconclusive", "a rank is on the edge")


@pytest.mark.parametrize("status", ["determined", "ambiguous"])
def test_an_unintended_joint_that_is_ambiguous_is_no_error(status):
    made = triangle("revolute")
    *others, last = made.kinematics.joints
    last = replace(last, status=status)
    report = check(replace(made, kinematics=replace(made.kinematics, joints=(*others, last))))
    (rule,) = (rule for rule in report.rules if rule.code == "KF406")
    assert rule.outcome == ("failed" if status == "determined" else "inconclusive")
    assert any(f.code == "KF406" for f in report.findings) == (status == "determined")
