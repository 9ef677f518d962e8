"""Friction of materials holds in the file that states it, and in what that includes."""

from __future__ import annotations

import pytest
from support.solids import box, rod, save

from kinform import results, stages
from kinform.behaviour.sliding import sliding_joints

HOUSING = '[[part]]\nname = "housing"\nmesh = "housing.stl"\nmaterial = "steel"\n'
WHEEL = '[[part]]\nname = "wheel"\nmesh = "wheel.stl"\nmaterial = "bronze"\n'
HINGE = """[[function.joint]]
name = "hinge"
between = ["housing", "wheel"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.drive]]
joint = "hinge"
kind = "friction"
"""
BRONZE = "[materials.bronze]\ndensity = 8800\n"
UNKNOWN = "not known"


@pytest.fixture
def folder(tmp_path):
    save(box(-30, 30, -30, 30, 0, 40) - rod(10, -1, 41, 64), tmp_path / "housing.stl")
    save(rod(10, -5, 45, 64) + rod(20, -15, 0, 64) + rod(20, 40, 50, 64), tmp_path / "wheel.stl")
    return tmp_path


def stated(coefficient):
    pair = '["bronze", "steel"]'
    return "" if coefficient is None else f"[[friction]]\nmaterials = {pair}\ncoefficient = {coefficient}\n"


def included(name, file, x=0):
    return f'[[subassembly]]\nname = "{name}"\nfile = "{file}.toml"\nposition = [{x}, 0, 0]\n'


def write(folder, name, *tables):
    path = folder / f"{name}.toml"
    path.write_text("".join([f'schema = 1\n[assembly]\nname = "{name}"\nunits = "mm"\n', BRONZE, *tables]))
    return path


def rubbing(path):
    """By joint what its materials have in motion, of the design as results keep it."""
    derived = stages.joints(stages.contacts(stages.import_(path)))
    results.write(derived, path.with_suffix(".h5"))
    design = results.read(path.with_suffix(".h5"))
    found = sliding_joints(design.assembly, design.kinematics, design.contacts, design.surfaces)
    out = {}
    for name, sliding in found.items():
        try:
            out[name] = sliding.coefficients()[0]
        except ValueError as error:
            assert "bronze" in str(error) and "steel" in str(error)
            out[name] = UNKNOWN
    return out


@pytest.mark.parametrize("above", [0.3, None])
@pytest.mark.parametrize("order", [1, -1])
def test_what_a_sub_assembly_states_holds_in_it_alone(folder, above, order):
    write(folder, "oiled", stated(0.05), HOUSING, WHEEL, HINGE)
    write(folder, "dry", HOUSING, WHEEL, HINGE)
    both = [included("a", "oiled"), included("b", "dry", 100)][::order]
    found = rubbing(write(folder, "top", *both, stated(above)))
    assert found == {"a/housing~a/wheel": 0.05, "b/housing~b/wheel": UNKNOWN if above is None else above}


@pytest.mark.parametrize("above", [0.3, None])
def test_parts_of_different_files_rub_as_the_file_about_both_says(folder, above):
    write(folder, "rotor", stated(0.05), WHEEL)
    hinge = HINGE.replace('"wheel"', '"rotor/wheel"')
    found = rubbing(write(folder, "top", HOUSING, included("rotor", "rotor"), stated(above), hinge))
    assert found == {"housing~rotor/wheel": UNKNOWN if above is None else above}


@pytest.mark.parametrize(("inner", "middle", "outer", "found"), [
    (0.1, 0.2, 0.3, 0.1), (None, 0.2, 0.3, 0.2), (None, None, 0.3, 0.3), (0.1, None, None, 0.1),
])  # fmt: skip
def test_the_innermost_file_that_states_it_counts(folder, inner, middle, outer, found):
    write(folder, "inner", stated(inner), HOUSING, WHEEL, HINGE)
    write(folder, "middle", stated(middle), included("m", "inner"))
    assert rubbing(write(folder, "top", stated(outer), included("t", "middle"))) == {"t/m/housing~t/m/wheel": found}


def test_names_that_begin_alike_are_no_sub_assemblies_of_each_other(folder):
    write(folder, "oiled", stated(0.05), HOUSING, WHEEL, HINGE)
    write(folder, "dry", HOUSING, WHEEL, HINGE)
    found = rubbing(write(folder, "top", included("a", "oiled"), included("ab", "dry", 100)))
    assert found == {"a/housing~a/wheel": 0.05, "ab/housing~ab/wheel": UNKNOWN}
