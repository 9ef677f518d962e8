"""Names in other languages: valid, different from each other, and independent of order."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.devices import device, drive, joint, sine
from support.export_models import X, Z, block, design
from support.other_programs import analysed, opened
from support.validators import package

from kinform.exports import FORMATS, export
from kinform.exports.names import FILES, MJCF, MODELICA, SDF, VHDL, XML, comment, identifiers

LANGUAGES = {"vhdl": VHDL, "modelica": MODELICA, "files": FILES, "xml": XML, "sdf": SDF, "mjcf": MJCF}
VALID = {
    "vhdl": r"[a-zA-Z](_?[a-zA-Z0-9])*",
    "modelica": r"[a-zA-Z_]\w*",
    "files": r"[A-Za-z0-9_][A-Za-z0-9_.-]*",
    "xml": r"[^\x00-\x1f\x7f]+",
    "sdf": r"[^\x00-\x1f\x7f]+",
    "mjcf": r"[^\x00-\x1f\x7f]+",
}
ODD = (
    "a b", "a_b", "a-b", "A B", "entity", "Model", "end", "1st", "räder", "rader", "車輪", "[m6] <bolt>", 'say "hi"',
    "x & y", "--", "__x__", "world", "a::b", "tab\tname", "body", "new\nline", "né", "né", "con", "*/ end",
    "über/unter"[:4],
)  # fmt: skip


@pytest.mark.parametrize("language", LANGUAGES)
@settings(max_examples=30, deadline=None)
@given(names=st.lists(st.text(min_size=1, max_size=12), min_size=1, max_size=12))
def test_any_names_become_valid_and_different_identifiers(language, names):
    rules = LANGUAGES[language]
    out = identifiers(names, rules)
    assert set(out) == set(names)
    assert len({rules.key(found) for found in out.values()}) == len(set(names))
    for found in out.values():
        assert re.fullmatch(VALID[language], found, re.ASCII if language in ("vhdl", "modelica", "files") else 0), found
        assert (found.lower() if rules.folds else found) not in rules.reserved
    assert identifiers(reversed(names), rules) == out


def test_a_name_that_is_an_identifier_stays():
    assert identifiers(["a b", "a_b"], VHDL) == {"a_b": "a_b", "a b": "a_b_2"}
    assert identifiers(["Arm", "arm"], MODELICA) == {"Arm": "Arm", "arm": "arm"}
    assert identifiers(["Arm", "arm"], VHDL) == {"Arm": "Arm", "arm": "arm_2"}
    assert identifiers(["räder"], VHDL) == {"räder": "rader"}
    assert identifiers(["signal"], VHDL) == {"signal": "signal_x"}


@pytest.mark.parametrize("name", ["con", "CON.x", "a" * 5000, "-rf", "..", "../../x", ".hidden", "a/b", "nul.tar.gz"])
def test_names_of_files_stay_in_their_folder_on_any_system(name):
    (found,) = identifiers([name], FILES).values()
    assert re.fullmatch(VALID["files"], found) and found[0] not in "-." and len(found) <= 120
    assert found.partition(".")[0].lower() not in FILES.reserved


def test_appended_suffixes_never_meet_another_name():
    out = identifiers(["a", "a m", "a_m"], VHDL, suffixes=("", "_m"))
    made = [found + end for found in out.values() for end in ("", "_m")]
    assert len(set(made)) == len(made) == 6


def test_comments_end_nowhere_else():
    for text in ODD:
        assert "--" not in comment(text) and "\n" not in comment(text) and "*/" not in comment(text)


@pytest.fixture(scope="module")
def oddly_named():
    """A chain of bodies whose names mean something in one language or another."""
    names = sorted(dict.fromkeys(name for name in ODD if "/" not in name))
    parts = [block(name, (0.01 * k, 0.1, 0)) for k, name in enumerate(names, start=1)]
    joints = [joint("base", names[0], "revolute", Z, (0, 0, 0))]
    joints += [
        joint(a, b, "revolute", (Z, X)[k % 2], (0.01 * k, 0, 0))
        for k, (a, b) in enumerate(zip(names, names[1:], strict=False))
    ]
    drives = [drive(joints[3].name, "motion", sine(10, 1))]
    made = design(device(parts, joints, drives=drives, duration=0.02, step=0.01))
    assert made.simulation.status == "done"
    return replace(made, assembly=replace(made.assembly, name='-- "odd" <name> \n end;')), names


@pytest.mark.parametrize("format", sorted(FORMATS))
def test_odd_names_give_the_same_bytes_and_stay_in_the_folder(format, oddly_named):
    found, _ = oddly_named
    made = export(found, format)
    assert made == export(found, format)
    for name in made.files:
        assert re.fullmatch(r"(meshes/)?[A-Za-z0-9_][A-Za-z0-9_.-]*", name), name


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf"])
def test_odd_names_are_well_formed_xml_and_all_there(format, oddly_named):
    found, names = oddly_named
    (text,) = (data for name, data in export(found, format).files.items() if "/" not in name)
    tags = {"urdf": "link", "sdf": "link", "mjcf": "body"}
    links = [node.get("name") for node in ElementTree.fromstring(text).iter(tags[format])]
    assert len(links) == len(set(links))
    assert len(links) == len(names) + (0 if format == "mjcf" else 1)
    kept = {"[m6] <bolt>", 'say "hi"', "x & y", "車輪", "a b", "a_b"}
    assert kept <= set(links)


def test_odd_names_are_read_by_mujoco_and_drake(oddly_named, tmp_path):
    found, names = oddly_named
    mujoco = package("mujoco")
    (text,) = export(found, "mjcf").files.values()
    assert mujoco.MjModel.from_xml_string(text.decode()).nbody == len(names) + 1
    plants = package("pydrake.multibody.plant")
    from pydrake.multibody.parsing import Parser

    ((name, text),) = export(found, "sdf").files.items()
    (tmp_path / name).write_bytes(text)
    plant = plants.MultibodyPlant(0.0)
    Parser(plant).AddModels(str(tmp_path / name))
    assert plant.num_bodies() == len(names) + 2


def test_odd_names_are_read_by_rumoca(oddly_named, tmp_path):
    found, _ = oddly_named
    rumoca = package("rumoca")
    small = [block("entity", (0.1, 0, 0)), block("end", (0.2, 0, 0)), block('"; der', (0.3, 0, 0))]
    joints = [
        joint("base", "entity", "revolute", Z, (0, 0, 0)),
        joint("end", "entity", "revolute", X, (0, 0, 0)),
        joint('"; der', "end", "prismatic", X, (0, 0, 0)),
    ]
    made = design(device(small, joints), run=False)
    made = replace(made, assembly=replace(made.assembly, name=found.assembly.name))
    ((name, text),) = export(made, "modelica").files.items()
    (tmp_path / name).write_bytes(text)
    assert rumoca.Session().load(str(tmp_path / name), model=f"{name.removesuffix('.mo')}.System") is not None


def test_odd_names_are_read_by_ghdl(oddly_named, tmp_path):
    ran = analysed(export(oddly_named[0], "vhdl-ams"), tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_odd_names_give_vhdl_that_reads_back(oddly_named):
    found, names = oddly_named
    _, flat, _ = opened(export(found, "vhdl-ams"))
    assert sum(entity.name == "rigid_body" for _, entity, _, _ in flat.leaves) == len(names)


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf"])
def test_a_joint_named_like_part_of_another_keeps_its_own_name(format):
    parts = [block("b", (0.1, 0, 0)), block("b.x", (0.2, 0, 0)), block("b.slide", (0.3, 0, 0))]
    joints = [
        joint("base", "b", "spherical", None, (0, 0, 0)),
        joint("base", "b.x", "spherical", None, (0, 0, 0)),
        joint("base", "b.slide", "revolute", Z, (0, 0, 0)),
    ]
    made = export(design(device(parts, joints), run=False), format)
    root = ElementTree.fromstring(next(iter(made.files.values())))
    names = [node.get("name") for node in root.iter("joint")]
    assert len(names) == len(set(names)) >= 3
