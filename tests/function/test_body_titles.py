"""Bodies are called by the part that the function names, else by their largest."""

from __future__ import annotations

from dataclasses import replace

from support.places import FIXTURES

from kinform.function.body_titles import body_titles
from kinform.kinematics.joints.bodies.extents import part_volumes
from kinform.model.names import BodyName


def test_a_body_is_called_by_the_part_that_the_function_names_else_by_its_largest(derive_design):
    design = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    bare = replace(design.assembly, groups=())
    kinematics = design.kinematics
    volume = part_volumes(bare)
    outer = next(body for body in kinematics.bodies if body.name == "outer")
    largest = max(outer.parts, key=lambda name: volume[name])
    smallest = min(outer.parts, key=lambda name: volume[name])
    joints = tuple(replace(joint, between=("base", smallest)) for joint in bare.function.joints[:1])
    without = replace(bare, function=replace(bare.function, joints=()))
    assert body_titles(without, kinematics)["outer"] == f"body of {largest}"
    assert body_titles(replace(bare, function=replace(bare.function, joints=joints)), kinematics)["outer"] == (
        f"body of {smallest}"
    )
    called = tuple(replace(body, name=BodyName(largest)) if body is outer else body for body in kinematics.bodies)
    assert largest not in body_titles(without, replace(kinematics, bodies=called))
    assert body_titles(design.assembly, kinematics) == {}  # groups were named by the designer
