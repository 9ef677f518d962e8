"""STEP in place of a manifest: the joints of the STL versions, names and hierarchy kept, broken files told."""

from __future__ import annotations

import faulthandler
import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest
from support.diagonal import first
from tests.support.places import FIXTURES
from tests.support.scenes import assert_same_joints, over, step_copy

import kinform
from kinform import form
from kinform.errors import InputError
from kinform.form.readers.assembly import load
from kinform.form.scenes import step
from kinform.form.sources import Reading
from kinform.foundation.no_more_files import open_no_more_files
from kinform.foundation.processes import in_own_process

FILES = Path(__file__).parent / "step"
PAIRS = {
    "revolute_collars": FIXTURES / "pairs",
    "prismatic_dovetail": FIXTURES / "pairs",
    "four_bar": FIXTURES / "mechanisms",
}


def refused(path: Path, **keys):
    with pytest.raises(InputError) as caught:
        load(path, **keys)
    (problem,) = caught.value.problems
    assert problem.file == path.name and problem.remedy
    return problem


@pytest.fixture
def reader():
    pytest.importorskip("cascadio", reason="cascadio is not installed (make validators)")


@pytest.mark.usefixtures("reader")
@pytest.mark.parametrize("name", first(2, list(PAIRS)))
def test_a_step_file_has_the_joints_of_the_stl_version(tmp_path, name):
    manifest = PAIRS[name] / name / f"{name}.toml"
    of_step, of_stl = kinform.run(over(manifest, step_copy(tmp_path, name))), kinform.run(manifest)
    assert [part.name for part in of_step.assembly.parts] == [part.name for part in of_stl.assembly.parts]
    assert_same_joints(of_step, of_stl)


@pytest.mark.usefixtures("reader")
def test_names_hierarchy_instances_and_the_unit_are_kept(tmp_path):
    assembly = form.load(step_copy(tmp_path, "names"))
    assert [part.name for part in assembly.parts] == ["a_b", "pin", "pins/pin", "pins/pin#2"]
    assert [sub.name for sub in assembly.subassemblies] == ["pins"]
    assert assembly.units == "mm"
    assert len({part.mesh.digest for part in assembly.parts if "pin" in part.name}) == 1
    assert np.allclose(assembly.part("pins/pin#2").X_WP[:3, 3], [0.1, 0.02, 0.0], atol=1e-8)
    assert np.allclose(assembly.part("pin").X_WP[:3, 0], [np.cos(np.pi / 6), 0, -0.5], atol=1e-7)
    assert all(part.mesh.health.watertight for part in assembly.parts)
    assert any('"a/b"' in note and '"a_b"' in note for note in assembly.notes)


@pytest.mark.usefixtures("reader")
@pytest.mark.parametrize(
    ("unit", "written", "factor"),
    [
        ("m", "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) )", 1000.0),
        ("in", "( CONVERSION_BASED_UNIT('INCH',#9000) LENGTH_UNIT() NAMED_UNIT(#9002) )", 25.4),
    ],
)
def test_lengths_are_in_the_unit_that_the_file_states(tmp_path, unit, written, factor):
    inch = (
        "#9000 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9001);\n"
        "#9001 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );\n"
        "#9002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\nENDSEC;\nEND-ISO"
    )

    def other(text):
        stated = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"
        assert stated in text
        return text.replace(stated, written).replace("ENDSEC;\nEND-ISO", inch)

    plain = form.load(step_copy(tmp_path, "revolute_collars"))
    assembly = form.load(step_copy(tmp_path, "revolute_collars", other))
    assert assembly.units == unit
    for part in plain.parts:
        there = assembly.part(part.name)
        assert there.mesh.diagonal == pytest.approx(part.mesh.diagonal * factor, rel=1e-6)
        assert np.allclose(there.X_WP[:3, 3], part.X_WP[:3, 3] * factor, rtol=1e-6)


@pytest.mark.usefixtures("reader")
def test_a_stated_deviation_bounds_the_facets_and_is_told(tmp_path):
    path = step_copy(tmp_path, "revolute_collars")
    for deviation in (2e-5, 1e-6):
        assembly = load(path, reading=Reading(deviation=deviation))
        vertices = assembly.part("shaft").mesh.vertices
        faces = assembly.part("shaft").mesh.faces
        corners = vertices[faces]
        flat = np.linalg.norm(corners[:, :, :2], axis=2)
        on_shaft = corners[(np.abs(flat - 0.01) < 1e-6).all(axis=1) & (np.ptp(corners[:, :, 2], axis=1) > 1e-6)]
        middles = 0.5 * (on_shaft + np.roll(on_shaft, 1, axis=1))
        sag = 0.01 - np.linalg.norm(middles[:, :, :2], axis=2).min()
        assert 0.1 * deviation < sag <= 1.01 * deviation


def test_without_the_package_it_says_what_to_install(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "cascadio", None)
    assert "'kinform[step]'" in refused(step_copy(tmp_path, "names")).remedy


BAD = {
    "cut short": lambda text: text[: len(text) // 2],
    "no step": lambda text: "solid x\nendsolid x\n",
    "empty": lambda text: "",
    "zipped": lambda text: "PK\x03\x04" + text,
    "no data": lambda text: text[: text.index("DATA;")] + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n",
    "no unit of length": lambda text: text.replace("LENGTH_UNIT() ", ""),
    "a bracket too many": lambda text: text.replace("CARTESIAN_POINT('',(0.", "CARTESIAN_POINT('',((0.", 1),
    "a number beyond all": lambda text: text.replace("(0.,0.,50.)", "(0.,0.,1.E400)"),
    "a transformation of nothing": lambda text: re.sub(r"(ITEM_DEFINED_TRANSFORMATION\('','',)#\d+", r"\1#99999", text),
}


@pytest.mark.usefixtures("reader")
@pytest.mark.parametrize("change", BAD.values(), ids=BAD)
def test_what_is_wrong_with_a_step_file_is_one_problem(tmp_path, change):
    assert refused(step_copy(tmp_path, "names", change))


@pytest.mark.parametrize("entity", ["DOCUMENT_FILE", "DCMFL", "DOCUMENT_FILE/**/ "])
def test_references_to_other_files_are_refused(tmp_path, entity):
    """OpenCASCADE reads parts from the files that these name, wherever they are."""
    added = f"DATA;\n#99999={entity}('/etc/passwd','','',$,'',$);"
    assert refused(step_copy(tmp_path, "names", lambda text: text.replace("DATA;", added, 1))).line > 1


@pytest.mark.usefixtures("reader")
def test_the_end_of_the_native_reader_is_told(tmp_path, monkeypatch):
    import cascadio

    def end(*_, **__):
        faulthandler.disable()
        os.kill(os.getpid(), signal.SIGSEGV)

    monkeypatch.setattr(cascadio, "to_glb_bytes", end)
    assert refused(step_copy(tmp_path, "names"))


def test_units_of_a_step_file_are_refused(tmp_path):
    with pytest.raises(InputError):
        kinform.run(step_copy(tmp_path, "names"), units="mm")


def referring(text: str, file: str) -> str:
    """The dovetail, whose rail is said to be in another file."""
    whole = "PRODUCT_DEFINITION('design','',#32,#35)"
    assert f"#31 = {whole}" in text
    text = text.replace(
        f"#31 = {whole}", "#31 = PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS('design','',#32,#35,(#9001))"
    )
    more = (
        "#9001=DOCUMENT_FILE('x','',$,#9002,'',$);\n#9002=DOCUMENT_TYPE('geometry');\n"
        f"#9003=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{file}',#9004,#9005,(#9001));\n"
        "#9004=IDENTIFICATION_ROLE('external document id and location',$);\n#9005=EXTERNAL_SOURCE(IDENTIFIER('x'));\n"
    )
    before, end, after = text.rpartition("ENDSEC;")
    return before + more + end + after


@pytest.mark.usefixtures("reader")
def test_other_files_that_a_step_file_refers_to_are_not_read(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    other = tmp_path / "elsewhere" / "other.step"
    other.write_text((FILES / "revolute_collars.step").read_text())
    text = referring((FILES / "prismatic_dovetail.step").read_text(), str(other))
    for spelled in (text, text.replace("DOCUMENT_FILE", "DCMFL")):
        path = tmp_path / "a.step"
        path.write_text(spelled)
        with pytest.raises(InputError):
            form.load(path)
    if in_own_process(open_no_more_files):  # native code that would read them all the same cannot
        said = step._converted(text.encode(), Reading())[1]
        assert "shaft" not in said


def test_no_file_is_opened_after_that(tmp_path):
    (tmp_path / "a").write_text("a")

    def tried() -> str:
        if not open_no_more_files():
            return "not here"
        try:
            return (tmp_path / "a").read_text()
        except OSError:
            return "refused"

    assert in_own_process(tried) in ("refused", "not here")
