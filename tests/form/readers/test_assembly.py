"""The manifest: poses, units, names, function in SI, and every error with its line."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.errors import InputError
from kinform.form import load, schema
from kinform.form.readers.toml_text import MANIFEST_DEPTH

HEAD = 'schema = 1\n[assembly]\nname = "x"\nunits = "mm"\n'
TWO = HEAD + '[[part]]\nname = "a"\n[[part]]\nname = "b"\n'


def read(folder, text, name="m.toml"):
    (folder / name).write_text(text)
    return load(folder / name)


def problems(folder, text):
    with pytest.raises(InputError) as caught:
        read(folder, text)
    assert all(p.remedy and p.file and p.line for p in caught.value.problems)
    return [(p.line, p.message) for p in caught.value.problems]


@pytest.mark.parametrize(("mesh", "missing"), [("gone/../a.stl", "gone"), ("there/gone/in/a.stl", "gone")])
def test_the_folder_that_is_missing_is_named(tmp_path, mesh, missing):
    (tmp_path / "there").mkdir()
    with pytest.raises(InputError) as caught:
        read(tmp_path, HEAD + f'[[part]]\nname = "a"\nmesh = "{mesh}"\n')
    (problem,) = caught.value.problems
    assert problem.line == 7 and problem.remedy.split()[-1] == missing


@pytest.mark.parametrize("mesh", ["there", "there.stl", "there/"])
def test_a_folder_in_the_place_of_a_mesh_is_told_with_the_meshes_in_it(tmp_path, mesh):
    for folder in ("there", "there.stl"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "in_it.stl").write_text("")
    with pytest.raises(
        InputError,
    ) as caught:
        read(tmp_path, HEAD + f'[[part]]\nname = "a"\nmesh = "{mesh}"\n')
    (problem,) = caught.value.problems
    assert problem.line == 7 and problem.remedy.endswith("in_it.stl")


def test_poses_and_units_of_sub_assemblies_compose(tmp_path):
    read(
        tmp_path,
        'schema = 1\n[assembly]\nname = "s"\nunits = "in"\n[[part]]\nname = "rotor"\nposition = [1, 0, 0]\n'
        '[[part]]\nname = "stator"\n[function]\nmobility = 1\n[[function.joint]]\nname = "spin"\n'
        'between = ["stator", "rotor"]\ntype = "revolute"\naxis = [1, 0, 0]\npoint = [2, 0, 0]\n',
        "sub.toml",
    )
    assembly = read(
        tmp_path,
        HEAD + '[[part]]\nname = "base"\n[[subassembly]]\nname = "motor"\nfile = "sub.toml"\n'
        "position = [0, 0, 10]\nrpy = [0, 0, 90]\n",
    )
    assert [p.name for p in assembly.parts] == ["base", "motor/rotor", "motor/stator"]
    assert assembly.part("motor/rotor").X_WP[:3, 3] == pytest.approx([0, 0.0254, 0.01], abs=1e-15)
    joint = assembly.function.joints[0]
    assert (joint.name, joint.between) == ("motor/spin", ("motor/stator", "motor/rotor"))
    assert joint.axis == pytest.approx([0, 1, 0], abs=1e-15)
    assert joint.point == pytest.approx([0, 0.0508, 0.01], abs=1e-15)
    assert assembly.subassemblies[0].mobility == 1


def test_ranges_pitches_and_requirements_come_in_si(tmp_path):
    joint = (
        '[[function.joint]]\nname = "j{n}"\nbetween = ["a", "b"]\ntype = "{t}"\naxis = [0, 0, 2]\npoint = [1, 2, 3]\n'
    )
    assembly = read(
        tmp_path,
        TWO
        + joint.format(n=1, t="revolute") + "range = [-90, inf]\n"
        + joint.format(n=2, t="prismatic") + "range = [-5, 10]\n"
        + joint.format(n=3, t="screw") + "pitch = 2\n"
        + '[[function.require]]\nname = "q"\nkind = "speed"\njoint = "j2"\nlimit = 100\n',
    )  # fmt: skip
    first, second, third = assembly.function.joints
    assert first.range == (pytest.approx(-np.pi / 2), np.inf)
    assert first.axis.tolist() == [0, 0, 1]
    assert second.range == pytest.approx((-0.005, 0.01))
    assert third.pitch == pytest.approx(0.002)
    assert assembly.function.requirements[0].values["limit"] == pytest.approx(0.1)


def test_paths_regions_and_poses_of_requirements_come_in_si_and_the_world(tmp_path):
    (tmp_path / "p.csv").write_text("t,x,y,z,qw,qx,qy,qz\n0,1000,0,0,1,0,0,0\n\n2,0,1000,0,0,0,0,2\n")
    text = (
        TWO
        + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "prismatic"\naxis = [0, 0, 1]\n'
        + '[[function.require]]\nname = "f"\nkind = "follow"\npart = "b"\npoint = [1, 2, 3]\npath = "p.csv"\n'
        + "tolerance = 0.5\n"
        + '[[function.require]]\nname = "r"\nkind = "reach"\npart = "b"\npoint = [0, 0, 5]\n'
        + 'region = {type = "box", lower = [0, 0, 0], upper = [10, 20, 30]}\n'
        + '[[function.require]]\nname = "h"\nkind = "hold"\njoint = "j"\nlimit = 3\nposes = [{j = 7}]\n'
        + '[[function.require]]\nname = "k"\nkind = "retained"\npart = "b"\n'
    )
    follow, reach, hold, retained = read(tmp_path, text).function.requirements
    assert follow.values["rows"] == [
        pytest.approx([0, 1, 0, 0, 1, 0, 0, 0], abs=1e-15), pytest.approx([2, 0, 1, 0, 0, 0, 0, 1], abs=1e-15),
    ]  # fmt: skip
    assert (follow.values["path"], follow.values["tolerance"]) == ("p.csv", 0.0005)
    assert reach.values["region"]["upper"] == pytest.approx([0.01, 0.02, 0.03])
    assert reach.values["region"]["X_WF"] == np.eye(4).tolist()
    assert hold.values["poses"] == [{"j": pytest.approx(0.007)}]
    assert retained.values["directions"] == []
    (tmp_path / "p.csv").write_text("0,1,0,0\n1,2\n1,x,0,0\n0,1,1,1\n")
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert [(p.file, p.line) for p in caught.value.problems] == [("p.csv", 2), ("p.csv", 3), ("p.csv", 4)]


def test_a_table_law_is_read_and_its_faults_have_lines(tmp_path):
    joint = (
        '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "revolute"\naxis = [0, 0, 1]\npoint = [0, 0, 0]\n'
    )
    drive = '[[function.drive]]\njoint = "j"\nkind = "motion"\nlaw = {type = "table", file = "t.csv"}\n'
    (tmp_path / "t.csv").write_text("time,value\n0,0\n1,10\n")
    law = read(tmp_path, TWO + joint + drive).function.drives[0].law
    assert (law.times, law.values) == ((0.0, 1.0), (0.0, 10.0))
    (tmp_path / "t.csv").write_text("time,value\n0,0\n1,x\n0,3\n")
    with pytest.raises(InputError) as caught:
        read(tmp_path, TWO + joint + drive)
    assert [(p.file, p.line) for p in caught.value.problems] == [("t.csv", 3), ("t.csv", 4)]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ('schema = 1\n[assembly]\nname = "x\n', (3, 10)),
        ("schema = 1\n  a b = 2\n", (2, 5)),
        ("schema = 1\r\nx = [1, 2\r\n", (3, 1)),
        ("schema = 1\n" + "x = " + 200 * "[", (2, 5 + MANIFEST_DEPTH)),
    ],
)
def test_what_is_no_toml_is_shown_by_line_and_column(tmp_path, text, place):
    (tmp_path / "m.toml").write_bytes(text.encode())
    with pytest.raises(InputError) as caught:
        load(tmp_path / "m.toml")
    (problem,) = caught.value.problems
    assert (problem.line, problem.column) == place


SLIDE = (
    TWO + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "{type}"\naxis = [0, 0, 1]\npoint = [0, 0, 0]\n'
    '[[function.drive]]\njoint = "j"\nkind = "friction"\n'
)
"""Keys of the friction follow on line 18."""


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("prismatic", "coefficient = 0.1\nradius = 1"),
        ("prismatic", "static = 0.1\nthrust_radius = 0"),
        ("prismatic", "length = 3\nflank = 1"),
        ("revolute", "coefficient = 0.1\nflank = 1"),
        ("cylindrical", "length = 3\nflank = 1"),
        ("cylindrical", 'freedom = "slide"\nradius = 1'),
        ("planar", "coefficient = 0.1\nlength = 1"),
        ("revolute", "effort = 0.1\nradius = 1"),
        ("revolute", "effort = 0.1\nleast_reactions = true"),
    ],
)
def test_keys_of_friction_that_cannot_act_are_errors(tmp_path, kind, keys):
    ((line, _),) = problems(tmp_path, SLIDE.format(type=kind) + keys + "\n")
    assert line == 19


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("prismatic", "coefficient = 0.1\nlength = 1"),
        ("prismatic", "effort = 1.0"),
        ("revolute", "radius = 1\nthrust_radius = 0\nlength = 0"),
        ("revolute", "effort = 1.0\ncoefficient = 0.1\nradius = 1\nleast_reactions = true"),
        ("cylindrical", "radius = 1\nthrust_radius = 2\nlength = 3"),
        ("cylindrical", 'freedom = "slide"\nlength = 1'),
    ],
)
def test_keys_of_friction_that_act_are_none(tmp_path, kind, keys):
    (drive,) = read(tmp_path, SLIDE.format(type=kind) + keys + "\n").function.drives
    assert set(drive.parameters) == {line.split()[0] for line in keys.splitlines()} - {"freedom"}


def test_geometry_that_a_type_of_joint_does_not_have_is_an_error(tmp_path):
    text = SLIDE.format(type="revolute").partition("[[function.drive]]")[0] + "pitch = 2\naxis2 = [1, 0, 0]\n"
    found = problems(tmp_path, text)
    assert [line for line, _ in found] == [15, 16]


RANGED = SLIDE.partition("[[function.drive]]")[0]


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ("[simulation]\nrestitution = 0.5\n", 16),
        ('[simulation]\nstops = "range"\n', 16),
        ('range = [-inf, inf]\n[simulation]\nstops = "range"\n', 17),
        ('[simulation]\nstops = "found"\nrestitution = 0.5\n', None),
        ('range = [-inf, 3]\n[simulation]\nstops = "range"\nrestitution = 0.5\n', None),
    ],
)
def test_stops_that_nothing_says_are_errors(tmp_path, more, line):
    text = RANGED.format(type="revolute") + more
    if line is None:
        assert read(tmp_path, text).simulation.restitution == 0.5
    else:
        assert [at for at, _ in problems(tmp_path, text)] == [line]


@pytest.mark.parametrize("at", [0.1, 0.2])
def test_friction_of_one_pair_in_two_files_is_one_of_each(tmp_path, at):
    stated = "[[friction]]\nmaterials = {}\ncoefficient = {}\n"
    (tmp_path / "sub.toml").write_text(HEAD + '[[part]]\nname = "a"\n' + stated.format('["steel", "brass"]', at))
    places = "".join(f'[[subassembly]]\nname = "{name}"\nfile = "sub.toml"\n' for name in ("one", "two"))
    text = TWO + places + stated.format('["brass", "steel"]', 0.1)
    found = {one.prefix: (one.coefficient, one.file) for one in read(tmp_path, text).function.frictions}
    assert found == {"": (0.1, "m.toml"), "one/": (at, "sub.toml"), "two/": (at, "sub.toml")}


WRONG = {
    "unknown key": (TWO + "[tolerances]\ncontakt = 1\n", 10),
    "unit missing": ('schema = 1\n[assembly]\nname = "x"\n[[part]]\nname = "a"\n', 2),
    "other schema": (TWO.replace("schema = 1", "schema = 2"), 1),
    "syntax": (TWO + "[[part]\n", 9),
    "slash in a name": (HEAD + '[[part]]\nname = "a/b"\n', 6),
    "same name": (HEAD + '[[part]]\nname = "a"\n[[part]]\nname = "a"\n', 8),
    "group of an unknown part": (TWO + '[[group]]\nname = "g"\nparts = ["a", "c"]\n', 11),
    "part in two groups": (
        TWO + '[[group]]\nname = "g"\nparts = ["a"]\n[[group]]\nname = "h"\nparts = ["a"]\n', 14,
    ),
    "unknown material": (HEAD + '[[part]]\nname = "a"\nmaterial = "unobtainium"\n', 7),
    "negative density": (HEAD + '[[part]]\nname = "a"\ndensity = -1\n', 7),
    "infinite position": (HEAD + '[[part]]\nname = "a"\nposition = [0, inf, 0]\n', 7),
    "quaternion": (HEAD + '[[part]]\nname = "a"\nquaternion = [1, 1, 0, 0]\n', 7),
    "unknown ground": (TWO.replace('units = "mm"', 'units = "mm"\nground = "c"'), 5),
    "joint without axis": (
        TWO + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "prismatic"\n', 9,
    ),
    "zero axis": (
        TWO + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\ntype = "planar"\naxis = [0, 0, 0]\n', 13,
    ),
    "reversed range": (
        TWO + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\n'
        'type = "prismatic"\naxis = [0, 0, 1]\n'
        "range = [2, 1]\n",
        14,
    ),
    **{
        f"range of {said}": (
            TWO + '[[function.joint]]\nname = "j"\nbetween = ["a", "b"]\n'
            f'type = "prismatic"\naxis = [0, 0, 1]\nrange = {said}\n',
            14,
        )
        for said in ("[nan, 90]", "[0, nan]", '"nan 90"', "[5, 5]")
    },
    "drive on nothing": (
        TWO + '[[function.drive]]\njoint = "j"\nkind = "effort"\nlaw = {type = "constant", value = 1}\n', 10,
    ),
    "mass without inertia": (HEAD + '[[part]]\nname = "a"\nmass = 1\n', 5),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_an_error_has_its_line(tmp_path, case):
    text, line = WRONG[case]
    found = problems(tmp_path, text)
    assert [entry[0] for entry in found] == [line]


def test_the_schema_describes_every_table():
    described = schema()
    assert {"assembly", "part", "group", "subassembly", "assume", "function", "simulation"} <= set(
        described["properties"]
    )
    assert described["additionalProperties"] is False


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ('[[function.require]]\nname = "r"\nkind = "speed"\njoint = "a~b"\nlimit = 100\n', 11),
        ('[[function.require]]\nname = "r"\nkind = "hold"\njoint = "a~b"\nlimit = 1\nposes = [{"a~b" = 5}]\n', 12),
        ('[[function.coupling]]\njoints = ["a~b", "b~c"]\nratio = 2\n', 8),
    ],
    ids=["speed", "hold", "coupling"],
)
def test_a_value_of_a_joint_that_is_not_stated_has_no_unit_and_is_refused(tmp_path, table, line):
    found = problems(tmp_path, HEAD + '[[part]]\nname = "a"\n' + table)
    assert line in [at for at, _ in found]


def test_an_initial_position_may_be_solved_for(tmp_path):
    motion = '[simulation.initial."a~b"]\nposition = {}\nvelocity = 3\n'
    (value,) = read(tmp_path, TWO + motion.format('"closest"')).simulation.initial
    assert (value.solved, value.position, value.velocity) == (True, 0.0, 3.0)
    (value,) = read(tmp_path, TWO + motion.format("20")).simulation.initial
    assert (value.solved, value.position) == (False, 20.0)
    ((line, _),) = problems(tmp_path, TWO + motion.format('"nearest"'))
    assert line == 10
