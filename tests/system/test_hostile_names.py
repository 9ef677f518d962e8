"""Names that try to be markup, commands and several lines go from the manifest through every format of the gate."""

from __future__ import annotations

import json
import shutil
from xml.etree import ElementTree

import pytest
from support.places import FIXTURES

from kinform_cli.main import main
from kinform_cli.options import FindingsFormat

PAIR = FIXTURES / "pairs" / "revolute_collars"
BLOCK = '[bold]blo ck[-bold] "q" <b>tag Ø螺\n::error::x,y|z`'
SHAFT = "a, 'shaft' %0A ]]> {x} @me \x1b[31m"
JOINT = "j [red] | `x`\n<b>"


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """A design whose gate is red, with such names for everything that has one; its folder."""
    folder = tmp_path_factory.mktemp("a [b] c")
    for path in PAIR.glob("*.stl"):
        shutil.copy(path, folder / path.name)
    text = (PAIR / "revolute_collars.toml").read_text()
    names = {"block": BLOCK, "shaft": SHAFT, "main": JOINT, "revolute_collars": BLOCK}
    for plain, name in names.items():
        text = text.replace(f'"{plain}"', json.dumps(name))
    text = text.replace('"revolute"', '"prismatic"').replace('material = "steel"', "")
    text += '\n[simulation]\nlevel = "dynamic"\n'
    (folder / "m [1].toml").write_text(text)
    main(["run", str(folder / "m [1].toml"), "-o", str(folder / "r [1].h5"), "-q"])
    return folder


@pytest.mark.parametrize("format", list(FindingsFormat))
def test_hostile_names_change_no_code_and_no_line(hostile, format, capsys):
    assert main(["check", str(hostile / "r [1].h5"), "-f", format, "-q"]) == 1
    told = capsys.readouterr().out
    assert "\x1b" not in told
    lines = told.splitlines()
    if format == "json":
        subjects = {name for finding in json.loads(told)["findings"] for name in finding["subject"]}
        assert {SHAFT, JOINT} <= subjects
    elif format == "sarif":
        found = json.loads(told)["runs"][0]["results"]
        names = {one["name"] for result in found for one in result["locations"][0].get("logicalLocations", ())}
        assert {SHAFT, JOINT} <= names
    elif format == "junit":
        cases = [case.get("name") for case in ElementTree.fromstring(told).iter("testcase")]
        assert f"joint-wrong-type: {JOINT}" in cases
    elif format == "github":
        assert all(line.startswith(("::error ", "::warning ", "::notice ")) for line in lines[:-1])
        assert not lines[-1].startswith("::")
    elif format == "concise":
        assert all(line.startswith("m [1].toml:") for line in lines[:-2])
    else:
        assert all(line.isprintable() for line in lines)


def test_what_is_told_on_stderr_commands_no_terminal(hostile, capsys):
    manifest = hostile / "m [1].toml"
    text = manifest.read_text()
    try:
        manifest.write_text(text.replace("ground = ", 'ground = "nobody" #'))
        assert main(["run", str(manifest)]) == 2
        told = capsys.readouterr().err
        assert "\x1b[31m" not in told
        assert "\\x1b[31m" in told
        manifest.write_text("\n".join(line for line in text.splitlines() if not line.startswith("ground")))
        assert main(["run", str(manifest)]) == 1
        assert "\x1b[31m" not in capsys.readouterr().err
    finally:
        manifest.write_text(text)
