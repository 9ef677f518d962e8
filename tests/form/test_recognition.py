"""Which files are designs: whatever the spelling, the encoding, and what stands before the first key or element."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from kinform.form.recognition import is_design

HEAD = '[assembly]\nname = "a"\nunits = "mm"\n'
MANIFESTS = {
    "plain": "schema = 1\n" + HEAD, "quoted": '"schema" = 1\n' + HEAD, "literal": "'schema' = 1\n" + HEAD,
    "escaped": '"sch\\u0065ma" = 1\n["\\u0061ssembly"]\n', "dotted": 'schema = 1\nassembly.name = "a"\n',
    "inline": 'schema = 1\nassembly = { name = "a" }\n', "spaced": "schema=1\n[ 'assembly' ]\n",
    "commented": "# " + "x" * 1_000_000 + "\nschema = 1\n" + HEAD,
    "last": HEAD + "[[part]]\n", "cr": "schema = 1\r[assembly]\r",
    "no schema": HEAD + "[function]\n", "faulty": "schema = 1\n" + HEAD + "[[part\n",
    "deep": "schema = " + "[" * 99 + "\n" + HEAD,
    "faulty and escaped": '"sch\\u0065ma" = 1\n["\\u0061ssembly"]\n[[part\n',
    "large": "schema = 1\n" + HEAD + "#" * (3 << 20),
    "pointer": "version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
}  # fmt: skip
OTHERS = {
    "project": "[project]\nname = 'x'\n", "part": "[part]\na = 1\n", "text": 'a = "[assembly] schema = 1"\n',
    "inner": "[tool.assembly]\n[tool.schema]\n", "faulty": "[project\nname = {{ part }}\n", "empty": "",
}  # fmt: skip


@pytest.mark.parametrize("text", MANIFESTS.values(), ids=MANIFESTS)
def test_a_manifest_is_one_however_it_is_spelled(tmp_path, text):
    path = tmp_path / "a.TOML"
    path.write_bytes(text.encode())
    assert is_design(path)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be", "utf-32", "latin-1"])
def test_a_manifest_in_another_encoding_is_one_with_a_fault(tmp_path, encoding):
    path = tmp_path / "a.toml"
    path.write_bytes((MANIFESTS["plain"] + "# é\n").encode(encoding))
    assert is_design(path)


@pytest.mark.parametrize("text", OTHERS.values(), ids=OTHERS)
def test_toml_of_other_programs_is_no_design(tmp_path, text):
    path = tmp_path / "a.toml"
    path.write_text(text)
    assert not is_design(path)


def written(folder: Path, name: str, data: bytes) -> Path:
    (folder / name).write_bytes(data)
    return folder / name


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-32", "latin-1", "utf-7", "utf-8-sig"])
def test_roots_are_found_in_any_encoding(tmp_path, encoding):
    declared = "utf-8" if encoding == "utf-8-sig" else encoding
    text = f"<?xml version='1.0' encoding='{declared}'?><robot name='r'><link name='l'/></robot>"
    assert is_design(written(tmp_path, "r.urdf", text.encode(encoding)))
    assert is_design(written(tmp_path, "r.XML", text.replace("robot", "mujoco").encode(encoding)))


@pytest.mark.parametrize(
    ("name", "text", "design"),
    [
        ("r.urdf", "<!--" + "x" * (1 << 20) + "--><robot name='r'/>", True),
        ("r.urdf", "<!--" + "x" * (20 << 20) + "--><robot name='r'/>", True),
        ("r.URDF", "<!DOCTYPE robot [<!ENTITY a 'b'>]><robot name='&a;'/>", True),
        ("r.urdf", "<a:robot xmlns:a='b' name='r'/>", True),
        ("r.urdf", "no xml", True),
        ("r.urdf", "", True),
        ("r.urdf", "<materials/>", False),
        ("r.xacro", "<robot><link name='l'/></robot>", False),
        ("r.xacro", "<robot " + " ".join(f"a{k}='1'" for k in range(20_000)) + " name='r'><link/></robot>", True),
        ("r.xacro", "<robot name=", True),
        ("m.xml", "<!-- <mujoco/> --><other/>", False),
        ("m.xml", "<!--" + "x" * (1 << 20) + "--><mujoco/>", True),
        ("m.xml", "no xml <mujoco>", True),
        ("m.xml", "no xml", False),
        ("m.xml", "<robot generator='Robot'><suite/></robot>", False),
        ("m.xml", "<robot name='r'><link name='l'/></robot>", True),
        ("m.xml", "<sdf version='1.9'/>", True),
        ("m.sdf", "caffeine\n  -OEChem-", False),
        ("m.world", "junk <sdf version='1.9'>", True),
    ],
)
def test_descriptions_are_told_by_their_root(tmp_path, name, text, design):
    began = time.process_time()
    assert is_design(written(tmp_path, name, text.encode())) == design
    assert time.process_time() - began < 15.0


def test_expanding_entities_cost_nothing(tmp_path):
    entities = "".join(f'<!ENTITY a{k + 1} "{f"&a{k};" * 10}">' for k in range(12))
    text = f'<!DOCTYPE robot [<!ENTITY a0 "ha">{entities}]><robot name="&a12;">&a12;<link/></robot>'
    began = time.process_time()
    assert is_design(written(tmp_path, "r.urdf", text.encode()))
    assert time.process_time() - began < 15.0
