"""What the documentation shows is what the program prints."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys

import pytest
from known import ROOT

from kinform.consistency import rules_markdown

BLOCK = re.compile(r"<!-- demo -->\n```\n(.*?)```\n<!-- /demo -->", re.DOTALL)


def stripped(text):
    return [line.rstrip() for line in text.splitlines() if not line.startswith("make[")]


def test_the_demo_in_the_readme_is_what_the_demo_prints(tmp_path):
    if shutil.which("make") is None:
        pytest.skip("needs make")
    stamps = tmp_path / "env"
    (stamps / "bin").mkdir(parents=True)
    (stamps / "bin" / "python").symlink_to(sys.executable)
    (stamps / "bin" / "kinform").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m kinform_cli "$@"\n')
    (stamps / "bin" / "kinform").chmod(0o755)
    (stamps / ".installed").touch()
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "FORCE_COLOR", "MAKEFLAGS", "MFLAGS")}
    command = ["make", "--no-print-directory", "demo", f"VENV={stamps}", f"OUT={tmp_path}"]
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    shown = BLOCK.search((ROOT / "README.md").read_text())[1]
    assert stripped(ran.stdout) == stripped(shown)


def test_the_page_of_rules_is_current():
    assert (ROOT / "docs" / "rules.md").read_text(encoding="utf-8") == rules_markdown()


def test_every_folder_named_in_the_architecture_is_there():
    text = (ROOT / "docs" / "architecture.md").read_text()
    for folder in re.findall(r"^\| `(\w+)/` \|", text, re.MULTILINE):
        assert (ROOT / "pipeline" / "kinform" / folder).is_dir()
