"""What a stranger's design names outside its folder is refused in every format, whether it is there or not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from kinform import form
from kinform.errors import InputError, Problem
from kinform.form.sources import Reading
from kinform.study import read_plan

BOX = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + (
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
)
HEAD = 'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n'
PART = '[[part]]\nname = "p"\nmesh = "b.obj"\n'
LINK = '<link name="l"><{0}><geometry><mesh filename="{{0}}"/></geometry></{0}></link>'
URDF = f'<robot name="r">{LINK}</robot>'
SOLID = '<link name="s"><visual><geometry><box size="1 1 1"/></geometry></visual>'
SDF = '<sdf version="1.9"><model name="m"><link name="l"><visual name="v"><geometry>{0}</geometry></visual></link>'
DRAWN = "<box><size>1 1 1</size></box>"
GEOM = '<worldbody><body><geom type="mesh" mesh="m"/></body></worldbody>'

DESIGNS = {
    "mesh": ("m.toml", HEAD + '[[part]]\nname = "p"\nmesh = "{0}"\n', "b.obj"),
    "source": ("m.toml", HEAD.replace('"a"', '"a"\nfrom = "{0}"'), "r.urdf"),
    "sub-assembly": ("m.toml", HEAD + PART + '[[subassembly]]\nname = "s"\nfile = "{0}"\n', "s.toml"),
    "urdf visual": ("r.urdf", URDF.format("visual"), "b.obj"),
    "urdf collision": (
        "r.urdf", f'<robot name="r">{SOLID}{LINK.format("collision")[15:]}</robot>', "b.obj",
    ),
    "urdf file": ("r.urdf", URDF.format("visual").replace("{0}", "file://{0}"), "b.obj"),
    "sdf mesh": ("r.sdf", SDF.replace("{0}", "<mesh><uri>{0}</uri></mesh>") + "</model></sdf>", "b.obj"),
    "sdf include": (
        "r.sdf", SDF.replace("{0}", DRAWN) + "<include><uri>{0}</uri></include></model></sdf>", "s.sdf",
    ),
    "mjcf mesh": ("r.xml", '<mujoco><asset><mesh name="m" file="{0}"/></asset>' + GEOM + "</mujoco>", "b.obj"),
    "mjcf meshdir": (
        "r.xml", '<mujoco><compiler meshdir="{folder}"/><asset><mesh name="m" file="b.obj"/></asset>'
        + GEOM + "</mujoco>", "b.obj",
    ),
    "mjcf fit": (
        "r.xml", '<mujoco><asset><mesh name="m" file="{0}"/></asset>' + GEOM.replace('"mesh" ', '"box" ') + "</mujoco>",
        "b.obj",
    ),
    "mjcf include": ("r.xml", '<mujoco><include file="{0}"/></mujoco>', "s.xml"),
    "mjcf model": (
        "r.xml", '<mujoco><asset><model name="n" file="{0}"/></asset><worldbody><body><geom size="1"/>'
        '<attach model="n" prefix="p_"/></body></worldbody></mujoco>', "s.xml",
    ),
}  # fmt: skip
"""By what names it: the design, its text with the path, and the file that is named."""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A design's folder, with files beside it, of which none is inside."""
    (tmp_path / "design").mkdir()
    out = tmp_path / "out"
    out.mkdir()
    (out / "b.obj").write_text(BOX)
    (out / "r.urdf").write_text(URDF.format("visual").format("b.obj"))
    (out / "s.toml").write_text(HEAD + PART)
    (out / "s.sdf").write_text(SDF.format(DRAWN).replace('"m"', '"n"') + "</model></sdf>")
    (out / "s.xml").write_text("<mujoco><worldbody><body><geom size='1'/></body></worldbody></mujoco>")
    return tmp_path / "design"


def problems(read: Callable[[], object]) -> tuple[Problem, ...]:
    with pytest.raises(InputError) as caught:
        read()
    return caught.value.problems


def design(place: Path, case: str, way: str) -> Path:
    """The design, which names the file in this way."""
    name, text, file = DESIGNS[case]
    stated = {"up": "../out", "absolute": str(place.parent / "out"), "a link": "link"}[way]
    if case != "mesh" and not (place / "b.obj").exists():
        (place / "b.obj").write_text(BOX)
    (place / name).write_text(text.replace("{0}", f"{stated}/{file}").replace("{folder}", stated))
    return place / name


@pytest.mark.parametrize("way", ["up", "absolute", "a link"])
@pytest.mark.parametrize("case", DESIGNS)
def test_files_outside_are_refused_with_the_line_and_alike_if_they_are_not_there(place: Path, case: str, way: str):
    (place / "link").symlink_to("../out")
    path = design(place, case, way)
    there = problems(lambda: form.load(path))
    for file in (place.parent / "out").iterdir():
        file.unlink()
    gone = problems(lambda: form.load(path))
    assert there == gone
    assert any(problem.line and "--allow-outside" in problem.remedy for problem in there)


@pytest.mark.parametrize("case", DESIGNS)
def test_in_one_repository_or_with_leave_they_are_read(place: Path, case: str):
    path = design(place, case, "up")

    def refused_as_outside(**leave: bool) -> bool:
        try:
            form.load(path, **leave)
        except InputError as error:
            return any("--allow-outside" in problem.remedy for problem in error.problems)
        return False

    assert refused_as_outside() and not refused_as_outside(allow_outside=True)
    (place.parent / ".git").mkdir()
    assert not refused_as_outside()


def test_a_folder_above_is_no_package_unless_it_says_so_and_lies_in_the_repository(place: Path):
    path = place / "r.urdf"
    path.write_text(URDF.format("visual").format("package://out/b.obj"))
    assert "--package out=FOLDER" in problems(lambda: form.load(path))[0].remedy
    (place.parent / "out" / "package.xml").write_text("<package><name>out</name></package>")
    assert "--package out=FOLDER" in problems(lambda: form.load(path))[0].remedy
    assert form.load(path, reading=Reading(packages=(("out", str(place.parent / "out")),))).parts
    (place / "package.xml").write_text("<package><name>design</name></package>")
    (place.parent / ".git").mkdir()
    assert form.load(path).parts
    (place.parent / "out" / "package.xml").unlink()
    assert problems(lambda: form.load(path))


def test_a_file_of_a_package_does_not_leave_it(place: Path, tmp_path: Path):
    (place.parent / "out" / "link.obj").symlink_to(tmp_path / "other.obj")
    (tmp_path / "other.obj").write_text(BOX)
    said = Reading(packages=(("out", str(place.parent / "out")),))
    for name in ("link.obj", "../other.obj"):
        (place / "r.urdf").write_text(URDF.format("visual").format(f"package://out/{name}"))
        assert "--allow-outside" in problems(lambda: form.load(place / "r.urdf", reading=said))[0].remedy


def test_remedies_list_nothing_that_lies_outside(place: Path):
    (place / "near.obj").symlink_to("../out/b.obj")
    (place / "m.toml").write_text(HEAD + '[[part]]\nname = "p"\nmesh = "nea.obj"\n')
    (place / "n.toml").write_text(HEAD + '[[part]]\nname = "p"\nmesh = "../out/bb.obj"\n')
    for name in ("m.toml", "n.toml"):
        (problem,) = problems(lambda name=name: form.load(place / name))
        assert "near" not in problem.remedy and "b.obj" not in problem.remedy


def test_a_buffer_of_gltf_outside_is_refused(place: Path):
    (place.parent / "out" / "x.bin").write_bytes(bytes(36))
    (place / "x.bin").symlink_to("../out/x.bin")
    mesh = {"primitives": [{"attributes": {"POSITION": 0}}]}
    whole = {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [mesh],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "x.bin", "byteLength": 36}],
    }  # fmt: skip
    (place / "s.gltf").write_text(json.dumps(whole))
    assert any("outside" in problem.message for problem in problems(lambda: form.load(place / "s.gltf")))


def test_a_study_of_a_design_outside_needs_leave(place: Path):
    text = '[study]\ndesign = "../out/s.toml"\n[[vary]]\nname = "x"\nvalue = "part.p.solid"\nvalues = [true]\n'
    (place / "s.toml").write_text(text + '[[measure]]\nname = "y"\nvalue = "mass.total"\n')
    there = problems(lambda: read_plan(place / "s.toml"))
    (place.parent / "out" / "s.toml").unlink()
    assert problems(lambda: read_plan(place / "s.toml")) == there
