"""Every format: the same bytes from the same design, and what each leaves out."""

from __future__ import annotations

import os
import subprocess
import sys

from support.export_models import known, model_of
from support.places import ROOT

from kinform.exports import FORMATS, export
from kinform.exports.port_model import read


def test_bytes_depend_on_nothing_but_the_design(tmp_path):
    """Another process, another hash seed, another folder: the same bytes, and no path of this machine."""
    code = (
        "import sys, hashlib\n"
        f"sys.path.insert(0, {str(ROOT / 'tests')!r})\n"
        "from support.export_models import known\n"
        "from kinform.exports import FORMATS, export\n"
        "for name in ('four_bar',):\n"
        "    for format in sorted(FORMATS):\n"
        "        for file, data in sorted(export(known(name), format).files.items()):\n"
        "            print(name, format, file, hashlib.sha256(data).hexdigest())\n"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "77"}
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    import hashlib

    here = [
        f"{name} {format} {file} {hashlib.sha256(data).hexdigest()}"
        for name in ("four_bar",)
        for format in sorted(FORMATS)
        for file, data in sorted(export(known(name), format).files.items())
    ]
    assert ran.stdout.splitlines() == here
    for format in FORMATS:
        for data in export(known("four_bar"), format).files.values():
            assert str(ROOT).encode() not in data and str(tmp_path).encode() not in data


def test_motors_and_servos_are_whole_where_there_are_equations_and_named_as_lost_elsewhere():
    found = known("motorised")
    (data,) = export(found, "json").files.values()
    system = read(data)
    assert system.components == model_of(found).system.components
    assert {type(c).__name__ for c in system.components} >= {"Servo", "DcMotor", "VoltageSource"}
    for format in ("json", "modelica", "vhdl-ams"):
        assert not export(found, format).lost
    for format in ("sdf", "urdf"):
        lost = {text.partition(":")[0] for text in export(found, format).lost}
        acting = [c for c in system.components if type(c).__name__ in ("Servo", "DcMotor")]
        assert {c.subject for c in acting} <= lost
