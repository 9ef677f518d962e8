"""xacro: what it expands to is read as the URDF that says the same; what is wrong is told at its line."""

from __future__ import annotations

import numpy as np
import pytest

from kinform import form
from kinform.errors import InputError
from kinform.form.readers.assembly import load_with_contents
from kinform.form.sources import Reading

pytest.importorskip("xacrodoc", reason="xacrodoc expands xacro: pip install 'kinform[xacro]'")

PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="half" value="${0.5 * 0.04}"/>
<xacro:macro name="bar" params="name length mass:=0">
<link name="${name}"><visual><origin xyz="0 0 ${length / 2}"/><geometry><box size="0.04 ${2 * half} ${length}"/>
</geometry></visual><xacro:if value="${mass > 0}"><inertial><mass value="${mass}"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></xacro:if></link>
</xacro:macro>
</robot>
"""
ARM = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:include filename="{include}"/>
<xacro:arg name="reach" default="0.3"/>
<xacro:bar name="base" length="0.1" mass="{mass}"/>
<xacro:bar name="arm" length="$(arg reach)"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="{child}"/><origin xyz="0 0 0.1"/>
<axis xyz="0 0 1"/><limit lower="${{radians(-60)}}" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""
INCLUDES = ("parts.xacro", "../urdf/parts.xacro", "$(find arm_description)/urdf/parts.xacro")


def write(folder, include="parts.xacro", child="arm", mass="${2 * 1.5}"):
    """A package with the file in its folder `urdf`."""
    home = folder / "somewhere"
    (home / "urdf").mkdir(parents=True, exist_ok=True)
    (home / "package.xml").write_text("<package><name>arm_description</name></package>")
    (home / "urdf" / "parts.xacro").write_text(PARTS)
    path = home / "urdf" / "arm.urdf.xacro"
    path.write_text(ARM.format(include=include, child=child, mass=mass))
    return path


@pytest.mark.parametrize("include", INCLUDES)
def test_macros_properties_arguments_and_includes_are_expanded(tmp_path, include):
    assembly = form.load(write(tmp_path, include))
    low, high = assembly.part("arm box").mesh.placed_box(assembly.part("arm box").X_WP)
    assert np.allclose(np.r_[low, high], [-0.02, -0.02, 0.1, 0.02, 0.02, 0.4])
    assert next(g.override.mass for g in assembly.groups if g.name == "base") == 3.0
    (joint,) = assembly.function.joints
    assert joint.range == pytest.approx((-np.pi / 3, 1.0)) and joint.line == 6
    assert "parts.xacro" in {name.rsplit("/", 1)[-1] for name in assembly.files}


def test_packages_are_found_where_the_user_says_and_not_where_another_robot_had_them(tmp_path):
    other = write(tmp_path / "other")
    path = write(tmp_path, "$(find bars)/urdf/parts.xacro")
    with pytest.raises(InputError) as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert (problem.line, problem.remedy.split(",")[0]) == (2, "add --package bars=FOLDER")
    for factor, folder in ((1.0, other.parent.parent), (2.0, other.parent.parent.with_name("changed"))):
        (folder / "urdf").mkdir(parents=True, exist_ok=True)
        (folder / "urdf" / "parts.xacro").write_text(PARTS.replace("0.5 * 0.04", f"{factor} * 0.5 * 0.04"))
        assembly = form.load(path, reading=Reading(packages=(("bars", str(folder)),)))
        assert np.ptp(assembly.part("base box").mesh.vertices[:, 1]) == pytest.approx(0.04 * factor)


BAD = {
    "a name that is none": ({"mass": "${nothing}"}, "arm.urdf.xacro", 4),
    "no file": ({"include": "gone.xacro"}, "arm.urdf.xacro", 2),
    "no variable": ({"mass": "$(env NO_SUCH_VARIABLE)"}, "arm.urdf.xacro", 4),
    "no argument": ({"mass": "$(arg none)"}, "arm.urdf.xacro", 4),
    "no macro": ({"mass": '1"/><xacro:bor name="'}, "arm.urdf.xacro", 4),
    "itself": ({"include": "arm.urdf.xacro"}, "arm.urdf.xacro", 1),
    "no link": ({"child": "amr"}, "arm.urdf.xacro", 6),
    "no number": ({"mass": "1e999"}, "arm.urdf.xacro", 4),
    "the system": ({"mass": "${__import__('os').getpid()}"}, "arm.urdf.xacro", 4),
    "files": ({"mass": "${open('/etc/hostname').read()}"}, "arm.urdf.xacro", 4),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_told_with_file_line_and_remedy(tmp_path, case):
    changed, file, line = BAD[case]
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, **changed))
    problem = caught.value.problems[0]
    assert problem.remedy
    assert (problem.file, problem.line) == (file, line)
    form.load(write(tmp_path))  # nothing of it is left behind


CODE = (
    "${(lambda: [c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0]"
    ".__init__.__globals__['system']('touch MARK'))()}"
)


def test_code_runs_only_where_the_user_allows_it(tmp_path):
    path, mark = write(tmp_path), tmp_path / "mark"
    path.write_text(path.read_text().replace("$(arg reach)", CODE.replace("MARK", str(mark))))
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert caught.value.problems[0].line == 5 and "--allow-xacro" in caught.value.problems[0].remedy
    assert not mark.exists()
    with pytest.raises(InputError):  # a bar of length 0
        form.load(path, reading=Reading(allow_xacro=True))
    assert mark.exists()


def test_the_command_runs_code_of_xacro_only_with_its_flag(command, tmp_path):
    path, mark = write(tmp_path), tmp_path / "mark"
    path.write_text(path.read_text().replace("$(arg reach)", CODE.replace("MARK", str(mark))))
    refused = command("run", path)
    assert refused.returncode == 2 and "--allow-xacro" in refused.stderr and not mark.exists()
    allowed = command("run", path, "--allow-xacro")  # a bar of length 0
    assert allowed.returncode == 2 and "internal error" not in allowed.stderr and mark.exists()


@pytest.mark.parametrize("said", ["$(env SECRET)", "$(optenv SECRET)[::-1]", "$(optenv NONE 1)", "$(eval optenv)"])
def test_the_environment_is_read_only_where_the_user_allows_it(tmp_path, monkeypatch, said):
    monkeypatch.setenv("SECRET", "12345")
    path = write(tmp_path, mass=said)
    with pytest.raises(InputError) as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert problem.line == 4 and "--allow-xacro" in problem.remedy and "12345" not in str(problem)
    if said == "$(env SECRET)":
        assembly = form.load(path, reading=Reading(allow_xacro=True))
        assert next(g.override.mass for g in assembly.groups if g.name == "base") == 12345


def test_entities_are_refused_before_anything_is_expanded(tmp_path):
    path = write(tmp_path)
    path.write_text(
        '<?xml version="1.0"?>\n<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/hostname">]>\n' + path.read_text()
    )
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert [problem.line for problem in caught.value.problems] == [2]


def test_what_is_wrong_in_an_included_file_is_told_there(tmp_path):
    path = write(tmp_path)
    parts = path.with_name("parts.xacro")
    parts.write_text(parts.read_text().replace("</robot>", ""))
    with pytest.raises(InputError) as caught:
        form.load(path)
    assert caught.value.problems[0].file == "parts.xacro"


def doubling(deep):
    """Macros of which each calls the one before twice."""
    calls = "".join(
        f'<xacro:macro name="m{k}" params="n">\n<xacro:m{k - 1} n="${{n}}a"/>\n<xacro:m{k - 1} n="${{n}}b"/>'
        "</xacro:macro>\n"
        for k in range(1, deep + 1)
    )
    first = '<xacro:macro name="m0" params="n"><link name="l${n}"/></xacro:macro>\n'
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    return f'<robot name="r" {space}>\n{first}{calls}<xacro:m{deep} n=""/></robot>'


@pytest.mark.parametrize(
    "text",
    [
        doubling(30),
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a${9**9**9}"/></robot>',
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${\'a\'*10**10}"/></robot>',
        doubling(1).replace("xacro:m0 n=", "xacro:m1 n="),
    ],
    ids=["doubling", "power", "text", "itself"],
)
def test_what_has_no_end_is_refused_in_bounded_time_and_memory(tmp_path, monkeypatch, text):
    monkeypatch.setattr("kinform.formats.urdf.reading.xacro.XACRO_SECONDS", 1)
    path = tmp_path / "r.urdf.xacro"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        form.load(path)
    (problem,) = caught.value.problems
    assert problem.file == path.name and problem.line and problem.remedy


@pytest.mark.parametrize(
    ("include", "settled"),
    [("parts.xacro", True), ("$(find arm_description)/urdf/parts.xacro", True), ("part?.xacro", False),
     ('absent.xacro" optional="true"/><xacro:include filename="parts.xacro', False)],
)  # fmt: skip
def test_what_hangs_on_which_files_there_are_is_never_taken_for_unchanged(tmp_path, include, settled):
    _, contents = load_with_contents(write(tmp_path, include))
    assert bool(contents) == settled


def test_a_pattern_that_fits_files_outside_tells_no_name_of_them(tmp_path):
    outside, folder = tmp_path / "outside", tmp_path / "design"
    outside.mkdir()
    folder.mkdir()
    (outside / "private.xacro").write_text("<robot/>")
    (folder / "link").symlink_to(outside)
    path = folder / "r.urdf.xacro"
    path.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="li*/p*"/></robot>'
    )
    with pytest.raises(InputError) as caught:
        load_with_contents(path)
    assert "private" not in str(caught.value)
