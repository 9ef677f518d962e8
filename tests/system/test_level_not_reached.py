"""A run without forces where they are expected says so on the first screen, in tables and on the page."""

from __future__ import annotations

import json

import pytest
from support.command_line import ran_here
from support.diagonal import first_rows
from support.sleds import sled

FRICTION = """[[function.drive]]
joint = "slide"
kind = "friction"
"""
MOTION = """[[function.drive]]
joint = "slide"
kind = "motion"
law = {type = "sine", amplitude = 10, frequency = 1}
"""
KNOWN = "mass = 2.0\ncentre_of_mass = [0, 0, 0]\ninertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]\n"


def _run(folder, more, *, velocity=0, level="", without=""):
    text = sled("bed", "sled", more, velocity=velocity)
    text = text.replace(without, "") if without else text
    text = text.replace("[simulation]\n", f"[simulation]\n{level}\n")
    (folder / "sled.toml").write_text(text)
    return ran_here("run", "sled.toml", "-q", "--no-ranges", "-o", "sled.h5", cwd=folder)


def _words(text):
    return " ".join(text.split())


@pytest.mark.parametrize(("more", "velocity"), first_rows(1, [(FRICTION, 1000), (FRICTION, 0)]))
def test_friction_that_nothing_says_how_to_compute_is_no_pass(tmp_path, more, velocity):
    ran = _run(tmp_path, more, velocity=velocity)
    assert ran.returncode == 2
    assert "KF509" in ran.stdout
    assert "slide" in _words(ran_here("show", "sled.h5", "simulation", cwd=tmp_path).stdout)
    values = json.loads(ran_here("show", "sled.h5", "simulation", "--format", "json", cwd=tmp_path).stdout)
    assert [item["subject"] for item in values["not_dynamic"]] == ["slide"]
    assert ran_here("report", "sled.h5", "-q", "-o", "sled.html", cwd=tmp_path).returncode == 0
    page = (tmp_path / "sled.html").read_text()
    assert "KF509" in page


def test_a_mass_that_is_missing_is_told_beside_the_verdict_where_only_motions_are_asked_for(tmp_path):
    assert _run(tmp_path, MOTION).returncode == 0
    text = (tmp_path / "sled.toml").read_text()
    bare = text.replace(KNOWN, "")
    (tmp_path / "sled.toml").write_text(bare)
    plain = ran_here("run", "sled.toml", "-q", "--no-ranges", "-o", "sled.h5", cwd=tmp_path)
    assert plain.returncode == 0 and "KF509" not in plain.stdout, "a function alone is not expected to have forces"
    weighed = bare.replace("[function]", f'[[part]]\nname = "cart"\n{KNOWN}[function]', 1)
    weighed += '\n[[function.joint]]\nname = "rail"\nbetween = ["sled", "cart"]\ntype = "prismatic"\naxis = [0, 1, 0]\n'
    (tmp_path / "sled.toml").write_text(weighed)
    ran = ran_here("run", "sled.toml", "-q", "--no-ranges", "-o", "sled.h5", cwd=tmp_path)
    assert ran.returncode == 0, ran.stdout
    assert "KF509" in ran.stdout


def test_a_level_that_is_asked_for_and_not_reached_is_refused(tmp_path):
    ran = _run(tmp_path, FRICTION, level='level = "dynamic"')
    assert ran.returncode == 2
    assert "slide" in ran.stdout


def test_a_lower_level_that_is_asked_for_is_what_is_given(tmp_path):
    ran = _run(tmp_path, MOTION, level='level = "kinematic"', without=KNOWN)
    assert ran.returncode == 0
    assert "KF509" not in ran.stdout
