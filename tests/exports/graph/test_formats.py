"""dot: the graph as a file."""

from __future__ import annotations

import re
import shutil
import subprocess

from support.export_models import known

from kinform.exports import export


def test_dot_names_every_body_and_joint():
    text = export(known("gimbal"), "dot").files["device.dot"].decode()
    assert text.count(" -- ") == 3
    for name in ("a rotor", "base", "inner", "outer"):
        assert re.search(rf'^  "{name}"', text, re.MULTILINE)
    if shutil.which("dot"):
        ran = subprocess.run(["dot", "-Tsvg"], input=text, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
