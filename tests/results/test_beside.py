"""Two computations side by side give what they give in turn, whatever becomes of the other process."""

from __future__ import annotations

import os
import signal
import sys
from dataclasses import replace

import numpy as np
import pytest
from support.places import FIXTURES

from kinform import stages
from kinform.design import Design
from kinform.kinematics import derive as derived
from kinform.reuse import inputs
from kinform.reuse.decisions import Known
from kinform.reuse.digest import digest
from kinform.reuse.processes import beside

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")


def test_both_results_come_back_whole_however_large() -> None:
    large = np.arange(300_000.0)
    one, two = beside(lambda: "first", lambda: (large, {"a": 1}))
    assert one == "first"
    assert np.array_equal(two[0], large) and two[1] == {"a": 1}


def test_the_second_is_computed_by_another_process() -> None:
    one, two = beside(os.getpid, os.getpid)
    assert one == os.getpid() != two


def test_what_another_process_cannot_finish_is_computed_here() -> None:
    here = os.getpid()

    def dies_elsewhere() -> str:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return "computed"

    assert beside(lambda: 1, dies_elsewhere) == (1, "computed")
    assert beside(lambda: 1, lambda: lambda: 2)[1]() == 2  # a function cannot be sent


@pytest.mark.parametrize("which", [0, 1])
def test_an_error_of_either_is_raised_and_leaves_no_process(which: int, monkeypatch) -> None:
    def fails() -> None:
        raise ValueError("no")

    started = []
    fork = os.fork
    monkeypatch.setattr(os, "fork", lambda: started.append(fork()) or started[0])
    works = [fails, fails]
    works[1 - which] = lambda: None
    with pytest.raises(ValueError, match="no"):
        beside(*works)
    (child,) = started
    with pytest.raises(ChildProcessError):
        os.waitpid(child, os.WNOHANG)


def test_joints_are_the_same_side_by_side_with_the_same_decisions(derive_design, monkeypatch) -> None:
    design: Design = derive_design(FIXTURES / "mechanisms/four_bar/four_bar.toml")
    view = inputs.assembly_for("joints", design.assembly)
    monkeypatch.setattr(sys.modules["kinform.kinematics.derivation"], "MANY_JOINTS", 1)
    alone, together = Known(None), Known(None)
    one = derived(view, design.surfaces, design.contacts, alone)
    two = derived(view, design.surfaces, design.contacts, together, together.beside)
    assert digest(one) == digest(two)
    assert alone.decisions == together.decisions and alone.decisions
    bare = replace(design, kinematics=None)
    assert digest(stages.joints(bare, jobs=2).kinematics) == digest(stages.joints(bare).kinematics)
