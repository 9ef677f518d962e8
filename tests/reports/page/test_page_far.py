"""Pages of designs with parts so far from the origin that pictures of a usual size cannot tell their samples."""

from __future__ import annotations

import shutil

import pytest
from support.markup import read
from support.places import FIXTURES

from kinform import run
from kinform.reports.page import page_html


@pytest.mark.parametrize("far", [1e10, 1e18])
def test_parts_as_far_as_numbers_reach_are_no_error(far, tmp_path):
    gears = FIXTURES / "mechanisms" / "gear_pair"
    shutil.copytree(gears, tmp_path / "gears")
    manifest = tmp_path / "gears" / "gear_pair.toml"
    manifest.write_text(manifest.read_text().replace("position = [0, 0, 6]", f"position = [0, 0, {far!r}]"))
    page = read(page_html(run(manifest, ranges=False).design))
    assert len(page.scene["parts"]) == 3
