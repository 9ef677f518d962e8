"""`run` computes what a change affects and nothing else, and the file is the same as one made from nothing."""

from __future__ import annotations

import os
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import kinform
import pytest
from kinform import results, stages
from kinform.ledger import Ledger
from known import FIXTURES

STAGES = ("surfaces", "contacts", "joints", "mass", "simulation", "findings")


def _replaced(old: str, new: str) -> Callable[[Path], None]:
    """An edit of the manifest."""

    def edit(folder: Path) -> None:
        manifest = folder / "four_bar.toml"
        text = manifest.read_text()
        assert old in text
        manifest.write_text(text.replace(old, new, 1))

    return edit


def _lengthen(folder: Path) -> None:
    """Make a pin longer, keeping the size and the time of its file."""
    path = folder / "pin_b.stl"
    data, before = bytearray(path.read_bytes()), path.stat()
    top = max(struct.unpack_from("<f", data, 84 + 50 * i + 12 + 4 * k)[0] for i in range(len(data) // 50 - 1) for k in (2, 5, 8))
    for i in range((len(data) - 84) // 50):
        for k in (2, 5, 8):
            at = 84 + 50 * i + 12 + 4 * k
            if struct.unpack_from("<f", data, at)[0] == top:
                struct.pack_into("<f", data, at, top + 1.0)
    path.write_bytes(data)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


EDITS = {
    "nothing": (lambda folder: None, ""),
    "new times": (lambda folder: [os.utime(path) for path in folder.iterdir()], ""),
    "lines move": (_replaced("schema = 1", "\n# one\n# two\nschema = 1"), "findings"),
    "mobility": (_replaced("mobility = 1", "mobility = 2"), "findings"),
    "range": (_replaced("point = [0, 0, 0]", "point = [0, 0, 0]\nrange = [-90, 90]"), "simulation findings"),
    "drive": (_replaced("rate = 180", "rate = 90"), "simulation findings"),
    "duration": (_replaced("duration = 2", "duration = 1"), "simulation findings"),
    "intended axis": (_replaced("axis = [0, 0, 1]", "axis = [0, 1, 0]"), "joints mass? simulation findings"),
    "material": (_replaced('material = "steel"', 'material = "brass"'), "mass simulation findings"),
    "moved": (_replaced("position = [15, 25.980762114, 8.1]", "position = [15, 25.98, 8.1]"), "contacts joints mass simulation findings"),
    "tolerance": (_replaced("[function]", "[tolerances]\ncontact = 0.2\n\n[function]"), "surfaces contacts joints mass simulation findings"),
    "group": (_replaced('["rocker", "pin_c", "pin_d"]', '["rocker", "pin_d"]'), "contacts joints mass simulation findings"),
    "new shape": (_lengthen, "surfaces contacts joints mass simulation findings"),
    "renamed": (_replaced('name = "four_bar"', 'name = "linkage"'), "findings"),
}  # fmt: skip


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("first") / "four_bar"
    shutil.copytree(FIXTURES / "mechanisms/four_bar", folder)
    kinform.run(folder / "four_bar.toml", folder / "r.h5")
    return folder


@pytest.mark.parametrize("name", EDITS)
def test_a_change_recomputes_what_depends_on_it_and_gives_the_bytes_of_a_fresh_run(
    name: str, first: Path, tmp_path: Path
) -> None:
    edit, expected = EDITS[name]
    folder = tmp_path / "copy"
    shutil.copytree(first, folder)
    edit(folder)
    again = kinform.run(folder / "four_bar.toml", folder / "r.h5")
    kinform.run(folder / "four_bar.toml", folder / "fresh.h5")
    assert (folder / "r.h5").read_bytes() == (folder / "fresh.h5").read_bytes()
    computed = {re.match(r"\w+", sentence)[0] for sentence in again.recomputed}
    assert computed == set(expected.split())
    assert {re.match(r"\w+", sentence)[0] for sentence in again.reused} >= set(STAGES) - computed
    assert all(re.search(r": .* changed$|: new shape of pin_b$", sentence) for sentence in again.recomputed)
