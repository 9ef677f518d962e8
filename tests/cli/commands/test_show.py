"""`kinform show F.h5 mobility` names freedoms and redundancy, and draws the graph."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
from support.places import FIXTURES

from kinform import results as results_file

FOUR_BAR = FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml"


@pytest.fixture
def results(derive_design, tmp_path):
    path = tmp_path / "f.h5"
    results_file.write(derive_design(FOUR_BAR), path)
    return path


def test_mobility_says_what_moves_what_is_redundant_and_draws_it(command, results, tmp_path):
    shown = command("show", results, "mobility", COLUMNS="200")
    assert "crank_unit" in shown.stdout and "base-crank_unit-coupler-rocker_unit" in shown.stdout
    drawn = tmp_path / "graph.svg"
    ran = command("show", results, "mobility", "--graph", drawn)
    assert (ran.returncode, ran.stdout) == (0, "")
    assert ET.parse(drawn).getroot().tag.endswith("svg")
    assert command("show", results, "joints", "--graph", tmp_path / "graph.dot").returncode == 0
    assert (tmp_path / "graph.dot").read_text().startswith("graph ")
    refused = command("show", results, "mobility", "--graph", tmp_path / "graph.png")
    assert refused.returncode == 2 and ".svg" in refused.stderr and ".dot" in refused.stderr


def test_the_lead_of_a_screw_is_in_the_units_of_the_design(command, derive_design, tmp_path):
    path = tmp_path / "screw.h5"
    results_file.write(derive_design(FIXTURES / "pairs" / "screw_right" / "screw_right.toml"), path)
    shown = command("show", path, "mobility", COLUMNS="200")
    assert " mm a turn" in shown.stdout
    assert " m a turn" not in shown.stdout
