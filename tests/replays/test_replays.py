"""Every rule that may find an error gives a witness, which another method repeats, and which no change survives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest
from support.erring import ERRING
from support.places import ROOT

from kinform.consistency import RULES
from kinform.foundation.boundary import Boundary
from kinform.model.findings import Equation
from kinform.replays import exit_code, replay_all
from kinform.replays.computed import EQUATIONS

OF_RULES = ROOT / "pipeline" / "kinform" / "consistency" / "rules"


def replayed(design, folder, code):
    report = replace(design.report, findings=tuple(f for f in design.report.findings if f.code == code), ignored=())
    return [item for item in replay_all(report, design, folder, Boundary(folder / "any")) if is_error(item.finding)]


def is_error(finding):
    return finding.severity == "error"


def with_witness(design, finding, witness):
    alone = replace(finding, witness=witness, cause=None)
    return replace(design, report=replace(design.report, findings=(alone,), members=(), ignored=()))


def changes(witness):
    """The witness with one thing of it wrong, in each way that is never right."""
    if witness.kind == "textual":
        yield replace(witness, source_line=100_000)
        for k, text in enumerate(witness.states or ()):
            states = list(witness.states)
            states[k] = f"{text}1"
            yield replace(witness, states=tuple(states))
        if witness.lacks:
            yield replace(witness, lacks=(*witness.lacks, witness.states[0]))
        if witness.missing:
            yield replace(witness, missing=witness.source_file)
    elif witness.kind == "computed":
        yield replace(witness, residual=1.5 * witness.residual + 1.0)
        yield replace(witness, limit=witness.residual + 1.0)
    elif witness.depth is not None:
        back, ahead = witness.depth
        yield replace(witness, depth=(2.0 * back, ahead))
        yield replace(witness, depth=(back, 0.5 * ahead))
        yield replace(witness, step=(0.0, witness.step[1]))
    elif witness.gap is not None:
        yield replace(witness, gap=2.0 * witness.gap if witness.gap else 1e-3)
        if witness.gap < 0.0:
            yield replace(witness, gap=0.5 * witness.gap)
            yield replace(witness, volume=1.1 * witness.volume)
    else:
        yield replace(witness, step=(0.0, -witness.step[1]))


def numbers_changed(witness):
    """A computed witness with one of its inputs wrong."""
    for name, values in (witness.inputs or {}).items():
        for k in range(min(len(values), 4)):
            wrong = [1.2 * x + 0.1 if i == k else x for i, x in enumerate(values)]
            yield replace(witness, inputs={**witness.inputs, name: tuple(wrong)})


@pytest.mark.parametrize("code", ERRING)
def test_an_error_has_a_witness_that_another_method_repeats_and_no_change_survives(code, tmp_path, derive_design):
    design = ERRING[code](tmp_path, derive_design)
    found = replayed(design, tmp_path, code)
    assert found
    for item in found:
        assert item.finding.witness is not None
        assert item.outcome.state == "holds", item.outcome
    finding = found[0].finding
    for wrong in changes(finding.witness):
        (again,) = replayed(with_witness(design, finding, wrong), tmp_path, code)
        assert again.outcome.state == "does not hold", (wrong, again.outcome)
        assert exit_code((again,)) == 1
    if finding.witness.kind == "computed" and finding.witness.inputs:
        wrongs = numbers_changed(finding.witness)
        states = {replayed(with_witness(design, finding, w), tmp_path, code)[0].outcome.state for w in wrongs}
        assert "does not hold" in states


def test_every_rule_that_may_find_an_error_is_tried():
    """A rule without the word has no error of its own: only `[check.severity]` makes one of its findings."""
    sources = {path.stem[:5].upper(): path.read_text(encoding="utf-8") for path in OF_RULES.glob("kf*.py")}
    may = {rule.code for rule in RULES if rule.severity == "error" or '"error"' in sources[rule.code]}
    assert set(ERRING) == may


def test_equations_are_those_that_a_witness_may_name():
    assert sorted(EQUATIONS) == list(get_args(Equation))


def test_an_error_without_a_witness_is_told_and_fails_nothing(derive_design, tmp_path):
    design = ERRING["KF203"](tmp_path, derive_design)
    finding = next(f for f in design.report.findings if f.code == "KF203")
    (item,) = replayed(with_witness(design, finding, None), tmp_path, "KF203")
    assert item.outcome.state == "not replayed"
    assert exit_code((item,)) == 0


def test_notes_and_warnings_need_none(derive_design, tmp_path):
    design = ERRING["KF203"](tmp_path, derive_design)
    note = replace(design.report.findings[0], severity="note", witness=None)
    report = replace(design.report, findings=(note,), ignored=())
    assert replay_all(report, design, Path(tmp_path), Boundary(tmp_path / "any")) == ()
