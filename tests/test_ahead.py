"""What is made ready for later stages while processes are at work changes nothing of what these give."""

from __future__ import annotations

import sys

from support.places import FIXTURES
from support.short_four_bar import four_bar

import kinform
from kinform import ahead, stages
from kinform.collisions import joint_ranges
from kinform.foundation import processes

FOUR_BAR = FIXTURES / "mechanisms" / "four_bar" / "four_bar.toml"


def test_a_run_gives_the_same_with_something_done_ahead_of_it(tmp_path, monkeypatch):
    alone, shared = tmp_path / "alone.h5", tmp_path / "shared.h5"
    four_bar(tmp_path / "four_bar")
    manifest = tmp_path / "four_bar" / FOUR_BAR.name
    kinform.run(manifest, alone)
    monkeypatch.setattr(ahead, "LARGE", 0)
    monkeypatch.setattr(processes, "_threaded", False)  # as in a process that has drawn no page before
    monkeypatch.setattr(joint_ranges, "SHARED_FACETS", 0)
    monkeypatch.setattr(sys.modules["kinform.contacts.find"], "LITTLE_PAIRS", -1)
    made = []
    of = ahead.of
    monkeypatch.setattr(ahead, "of", lambda assembly: made.append(of(assembly)) or made[-1])
    outcome = kinform.run(manifest, shared, jobs=2)
    assert sorted(made[0].masses) == sorted(part.name for part in outcome.design.assembly.parts)
    assert shared.read_bytes() == alone.read_bytes()


def test_nothing_is_done_ahead_of_small_assemblies():
    assert ahead.of(stages.import_(FOUR_BAR).assembly) is None
