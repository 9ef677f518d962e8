"""The four-bar linkage with a short motion: where only stages, files and reuse are looked at."""

from __future__ import annotations

import functools
import shutil
from pathlib import Path

import kinform
from support.places import FIXTURES

run = functools.partial(kinform.run, ranges=False)
"""`kinform.run` without ranges of joints, which take two thirds of the time."""


def four_bar(folder: Path) -> None:
    """The fixture in this new folder; it turns by a tenth of its turn."""
    shutil.copytree(FIXTURES / "mechanisms/four_bar", folder)
    manifest = folder / "four_bar.toml"
    text = manifest.read_text()
    assert "duration = 2\n" in text
    manifest.write_text(text.replace("duration = 2\n", "duration = 0.2\n"))
