"""What people see on a terminal of 80 columns without colour."""

from __future__ import annotations

import io
import os
import pty
import re
import struct
import subprocess
import sys
from dataclasses import replace
from fcntl import ioctl
from functools import cache
from termios import TIOCSWINSZ

import numpy as np
import pytest
from rich.console import Console
from support.command_line import environment
from support.places import FIXTURES

from kinform import results, stages
from kinform_cli.tables import stacked
from kinform_cli.text import Lengths
from kinform_cli.views import assembly, mass, series
from kinform_cli.views.series import BLOCKS, PLAIN, spark

SEEKER = FIXTURES / "seeker/5_complete/seeker.toml"


@pytest.fixture(scope="module")
def on_a_terminal(tmp_path_factory, derive_design):
    """Lines of `kinform show` of the complete seeker, on a terminal so many columns wide; each is asked once."""
    path = tmp_path_factory.mktemp("terminal") / "seeker.h5"
    results.write(derive_design(SEEKER), path)

    @cache
    def show(*arguments, columns=80):
        ours, theirs = pty.openpty()
        ioctl(theirs, TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        command = [sys.executable, "-m", "kinform_cli", "show", str(path), *arguments]
        env = environment(COLUMNS=str(columns), NO_COLOR="1")
        with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=env) as ran:
            os.close(theirs)
            text = b""
            while True:
                try:
                    chunk = os.read(ours, 65536)
                except OSError:
                    break
                if not chunk:
                    break
                text += chunk
        os.close(ours)
        assert ran.returncode == 0, text
        return [line.rstrip() for line in text.decode("utf-8").splitlines()]

    return show


@pytest.mark.parametrize(
    "topic",
    [
        "assembly",
        "simulation",
        *(pytest.param(t, marks=pytest.mark.sweep) for t in ("contacts", "joints", "mobility", "mass", "findings")),
    ],
)
def test_nothing_is_wider_than_the_terminal_or_coloured(on_a_terminal, topic):
    lines = on_a_terminal(topic)
    assert max(map(len, lines)) <= 80
    assert not any("\x1b[3" in line or "\x1b[9" in line for line in lines)


def test_the_tree_shows_subassemblies_parts_and_groups(on_a_terminal):
    lines = on_a_terminal("assembly")
    at = next(i for i, line in enumerate(lines) if "yaw_motor  motor/motor.toml, 1 freedom stated" in line)
    inside = [re.sub(r"^[ │├└─]+", "", line) for line in lines[at + 1 : at + 4]]
    assert [line.split()[0] for line in inside] == ["bearing", "rotor", "stator"]
    assert [line.partition(" in ")[2].split()[0] for line in inside[1:]] == ["gimbal", "base"]
    below = "\n".join(lines)
    assert re.search(r"gimbal   outer_gimbal, .*yaw_dowel,\n {11}yaw_motor/rotor", below)


def test_series_have_extremes_and_a_line(on_a_terminal):
    rows = [line for line in on_a_terminal("simulation") if BLOCKS[-1] in line]
    assert [row.split()[0] for row in rows[:3]] == ["yaw", "pitch", "yaw"]
    yaw = re.search(r"yaw +-30° +1.5 +30° +0.5 +(\S+)$", rows[0])[1]
    assert len(yaw) == 20
    # a sine of one period: up, down, and back
    assert yaw.index(BLOCKS[-1]) < 10 < yaw.index(BLOCKS[0])


def test_what_the_bearings_carry_is_a_series(on_a_terminal):
    lines = on_a_terminal("simulation")
    for joint in ("yaw", "pitch"):
        assert any(line.startswith(f"{joint} |F| N ") for line in lines)
        assert any(line.startswith(f"{joint} |τ| N·m ") for line in lines)


def test_contacts_that_do_not_fit_are_listed_by_pairs_of_parts(on_a_terminal):
    lines = on_a_terminal("contacts", columns=70)
    assert max(map(len, lines)) <= 70
    at = lines.index("yaw_motor/bearing  yaw_motor/rotor")
    assert lines[at + 1].split()[:2] == ["#", "surface"]
    assert lines.count("yaw_motor/bearing  yaw_motor/rotor") == 1


def test_lines_that_do_not_fit_go_on_indented():
    console = Console(width=40, file=io.StringIO(), color_system=None)
    console.print(stacked("  base and gimbal: " + "word " * 12, "short"))
    lines = [line.rstrip() for line in console.file.getvalue().splitlines()]
    assert max(map(len, lines)) <= 40
    assert lines[0].startswith("  base and gimbal: word")
    assert all(line.startswith("    word") for line in lines[1:-1]) and len(lines) > 3
    assert lines[-1] == "short"


def test_masses_that_are_not_known_are_no_rows_of_dashes(derive_design):
    design = derive_design(FIXTURES / "pairs/planar_block/planar_block.toml")
    parts = tuple(replace(part, material=None, density=None) for part in design.assembly.parts)
    bare = stages.mass(replace(design, assembly=replace(design.assembly, parts=parts), mass=None))
    console = Console(width=200, file=io.StringIO(), color_system=None)
    console.print(mass.render(bare))
    text = console.file.getvalue()
    assert "block, table: " in text and "–" not in text


def test_a_part_is_marked_as_ground_only_where_one_is_stated(derive_design):
    design = derive_design(SEEKER)
    stated = replace(design, assembly=replace(design.assembly, ground=None, groups=()))
    console = Console(width=200, file=io.StringIO(), color_system=None)
    console.print(assembly.render(stated))
    assert "(ground)" not in console.file.getvalue()


def test_a_narrow_terminal_gets_blocks_and_no_cut_names(on_a_terminal):
    lines = on_a_terminal("simulation", columns=50)
    assert max(map(len, lines)) <= 50
    assert any(line.startswith("pitch mN·m") for line in lines)


class TestSparks:
    def test_a_ramp_goes_through_all_heights(self):
        assert spark(np.linspace(0.0, 1.0, 8), 8) == BLOCKS

    def test_a_lone_peak_is_not_lost(self):
        values = np.zeros(1000)
        values[501] = 1.0
        assert spark(values, 10).count(BLOCKS[-1]) == 1

    def test_unknown_values_are_blank_and_constants_low(self):
        assert spark(np.array([np.nan, 2.0, 2.0, np.nan]), 4) == f" {BLOCKS[0] * 2} "
        assert spark(np.full(5, np.nan), 5) == ""

    def test_where_blocks_cannot_be_written_characters_stand_for_them(self):
        assert spark(np.linspace(0.0, 1.0, 8), 8, PLAIN) == PLAIN


def test_unknown_efforts_are_no_series(derive_design):
    design = derive_design(FIXTURES / "functional/stick_four_bar/stick_four_bar.toml")
    rows = series.render(design.simulation, Lengths.of(design.assembly))
    assert rows is not None
    assert len(rows._rows) == 4
