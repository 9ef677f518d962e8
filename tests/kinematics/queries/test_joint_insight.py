"""The evidence of a joint, and queries answered with contacts that only push."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.assemblies import assembly, contacts, part
from support.patches import Z, cylinder, plane, ring

from kinform.design import Design
from kinform.kinematics import derive, insight

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def design(model, *patches):
    touching = contacts(*patches)
    return Design(model, contacts=touching, kinematics=derive(model, {}, touching))


def hinge():
    return cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)


@cache
def two_parts():
    return assembly(part("a"), part("b"), ground="a")


def test_a_collared_shaft_is_cylindrical_without_both_collars_and_planar_without_its_journal():
    made = design(two_parts(), *hinge())
    found = insight(made, "a~b")
    kinds = {k: p.kind for k, p in enumerate(made.contacts.patches)}
    others = {tuple(sorted(kinds[k] for k in item.without)): item for item in found.alternatives}
    assert {kinds: item.type for kinds, item in others.items()} == {
        ("cylinder",): "planar",
        ("plane", "plane"): "cylindrical",
    }
    assert others[("plane", "plane")].frees
    # what is claimed is so: derived without those patches
    for item in found.alternatives:
        rest = [p for k, p in enumerate(made.contacts.patches) if k not in item.without]
        (joint,) = derive(two_parts(), {}, contacts(*rest)).joints
        assert (joint.type, joint.freedoms, joint.status) == (item.type, item.freedoms, item.status)


def test_the_gap_behind_the_decision_is_that_of_the_singular_values():
    found = insight(design(two_parts(), *hinge()), "a~b")
    assert found.last_free < found.free < found.held < found.first_held
    assert np.isclose(found.first_held, found.joint.singular_values[1])
    assert {item.role for item in found.patches} == {"carries"}
    assert sum(item.share for item in found.patches) == pytest.approx(1.0)
    assert found.rows == len(design(two_parts(), *hinge()).kinematics.matrix.patch)


def test_a_joint_at_its_stop_names_the_patch_that_ends_it():
    stop = plane((0.02, 0, 0), Y, (0.002, 0.002), area=2e-5)
    made = design(two_parts(), *hinge(), stop)
    found = insight(made, "a~b")
    roles = {made.contacts.patches[item.index].area: item.role for item in found.patches}
    assert roles[2e-5] == "ends"
    (joint,) = made.kinematics.joints
    assert [made.contacts.patches[one.patch].area for one in joint.at_stop] == [2e-5]


def test_an_unknown_joint_is_an_error():
    with pytest.raises(KeyError):
        insight(design(two_parts(), *hinge()), "b~a")
