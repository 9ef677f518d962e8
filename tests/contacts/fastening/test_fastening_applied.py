"""`[fasteners] infer`: what follows from suggestions, what outweighs them, and how it is reported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import HERE, intended
from support.solids import box, rod
from support.suggestions import CORNERS, drilled, found, made_of

from kinform import contacts, kinematics, stages, surfaces
from kinform.consistency import check
from kinform.design import Design
from kinform.model.assembly import Assumption
from kinform.reuse.ledger import Ledger


def plates():
    return {"upper": drilled(0, 5, CORNERS), "lower": drilled(-5, 0, CORNERS)}


def horn_and_bracket():
    return {"horn": rod(12, 0, 4, 72) - rod(3, -1, 6), "bracket": box(-20, 20, -20, 20, -5, 0) - rod(4, -6, 1)}


SHAFT = np.array([0.0, 0.0, 1.0])


def assumed(kind):
    return Assumption(("lower", "upper"), kind, False, SHAFT, np.zeros(3), None, "seen on the bench", HERE)


def designed(**wanted):
    return stages.joints(stages.contacts(Design(made_of(np.eye(4), **wanted))))


def notes(design):
    """The subjects of what is said about suggestions."""
    done = stages.simulate(stages.mass(design))
    return [f.subject for f in check(done).findings if f.code == "KF906"]


@pytest.mark.parametrize("solids", [plates, horn_and_bracket])
def test_without_infer_suggestions_change_nothing(solids):
    made = made_of(np.eye(4), **solids())
    recovered = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, recovered)
    assert touching.suggestions
    results = [kinematics.derive(made, recovered, c) for c in (touching, replace(touching, suggestions=()))]
    states = [[(j.name, j.type, j.status, j.evidence, j.reason, j.twists.tobytes()) for j in k.joints] for k in results]
    assert states[0] == states[1]
    assert results[0].bodies == results[1].bodies


def test_a_joint_that_is_assumed_outweighs_a_suggestion():
    _, derived = found(np.eye(4), infer=True, assume=[assumed("revolute")], **plates())
    (joint,) = derived.joints
    assert (joint.type, joint.evidence) == ("revolute", ("assumption",))
    assert len(derived.bodies) == 2


def test_a_joint_that_the_function_states_outweighs_a_suggestion():
    _, derived = found(np.eye(4), infer=True, joints=[intended("swing", "lower", "upper")], **plates())
    assert [(joint.type, joint.status) for joint in derived.joints] == [("planar", "determined")]


def test_a_stated_joint_is_kept_even_if_suggestions_meet_round_a_third_part():
    strap = {"strap": box(19, 25, -15, 15, -5, 5) - box(19, 20, -15, 15, -5, 5)}
    plain = made_of(np.eye(4), **plates(), **strap)
    recovered = {p.mesh.digest: surfaces.recover(p.mesh, plain.tolerances) for p in plain.parts}
    touching = contacts.find(plain, recovered)
    (hint,) = touching.suggestions
    chain = tuple(replace(hint, parts=pair) for pair in (("lower", "strap"), ("strap", "upper")))
    made = replace(made_of(np.eye(4), infer=True, assume=[assumed("revolute")], **plates(), **strap))
    derived = kinematics.derive(made, recovered, replace(touching, suggestions=chain))
    assert "revolute" in [joint.type for joint in derived.joints]
    assert derived.body_of("lower") is not derived.body_of("upper")
    assert derived.body_of("strap").parts == ("strap",), "nothing tells which of the two it belongs to"


def test_a_stated_fixed_joint_needs_no_suggestion():
    _, derived = found(np.eye(4), infer=True, assume=[assumed("fixed")], **plates())
    (body,) = derived.bodies
    assert body.merged == ("assumed fixed: seen on the bench",)


def test_what_contact_holds_by_itself_is_not_called_inferred():
    block = box(-10, 10, -10, 10, -10, 10)
    shell = box(-14, 14, -14, 14, -14, 14) - block
    pins = [rod(1.5, -20, 20, 48).translate((x, 0, 0)) for x in (-6, 6)]
    for pin in pins:
        block, shell = block - pin, shell - pin
    tube = (rod(6, 14, 30, 48) - rod(4, 10, 40, 48)).translate((0, 40, 0))
    peg = rod(4, 12, 32, 48).translate((0, 40, 0))
    shell = shell + box(-4, 4, 13, 47, 10, 14) + tube - rod(4, 0, 50, 48).translate((0, 40, 0))
    solids = {"block": block, "shell": shell, "peg": peg}
    hints, plain = found(np.eye(4), **solids)
    assert "holes" in [hint.kind for hint in hints]
    _, derived = found(np.eye(4), infer=True, **solids)
    assert [body.merged for body in derived.bodies] == [body.merged for body in plain.bodies]
    assert [(j.name, j.type, j.status) for j in derived.joints] == [(j.name, j.type, j.status) for j in plain.joints]
    assert plain.joints[0].status == "determined"


def test_a_joint_that_follows_says_from_which_suggestion():
    lower = plates()["lower"] - rod(3, -4, 1, 48)
    _, derived = found(np.eye(4), infer=True, upper=plates()["upper"], lower=lower, pin=rod(3, -3.95, -0.05, 48))
    (joint,) = derived.joints
    assert joint.status == "inferred"
    assert "fasteners" in joint.evidence
    (body,) = (body for body in derived.bodies if len(body.parts) == 2)
    assert body.merged[0].startswith("inferred: lower~upper")


def test_a_suggestion_that_was_applied_is_reported():
    assert notes(designed(infer=False, **plates())) == []
    for solids, kind, confidence in ((plates(), "holes", "fair"), (horn_and_bracket(), "rim", "low")):
        design = designed(infer=True, **solids)
        (hint,) = design.contacts.suggestions
        assert (hint.kind, hint.confidence) == (kind, confidence)
        assert notes(design) == [hint.parts]


def test_what_a_stated_joint_outweighs_is_reported():
    design = designed(infer=True, assume=[assumed("revolute")], **plates())
    assert notes(design) == [("lower", "upper")]
    assert len(design.kinematics.bodies) == 2


def test_bolts_in_the_holes_change_the_suggestion_of_a_pair_that_is_reused():
    bolts = {f"bolt{k}": rod(1.8, -7, 7, 48).translate((x, y, 0)) for k, (x, y) in enumerate(CORNERS)}
    first = designed(**plates())
    ledger = Ledger(previous=first)
    again = stages.contacts(Design(made_of(np.eye(4), **plates(), **bolts)), ledger=ledger)
    fresh = stages.contacts(Design(made_of(np.eye(4), **plates(), **bolts)))
    assert "contacts of 1 pair of parts" in ledger.reused
    assert [h.kind for h in first.contacts.suggestions if h.parts == ("lower", "upper")] == ["holes"]
    assert [h.kind for h in again.contacts.suggestions if h.parts == ("lower", "upper")] == []
    assert [(h.parts, h.evidence) for h in again.contacts.suggestions] == [
        (h.parts, h.evidence) for h in fresh.contacts.suggestions
    ]


def test_asking_to_infer_recomputes_joints_and_no_contacts():
    first = designed(**plates())
    ledger = Ledger(previous=first)
    start = Design(made_of(np.eye(4), infer=True, **plates()))
    second = stages.joints(stages.contacts(start, ledger=ledger), ledger=ledger)
    assert second.contacts is first.contacts
    assert len(second.kinematics.bodies) == 1
