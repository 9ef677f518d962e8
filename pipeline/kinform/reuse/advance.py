"""A stage on a design: the earlier result where nothing changed, else a new one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from typing import Any

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly
from kinform.model.fingerprints import Fingerprints
from kinform.reuse import fingerprints, lineage
from kinform.reuse.dependence import STAGES, Stage
from kinform.reuse.ledger import Ledger


@dataclass(frozen=True)
class Result:
    """What a stage has made."""

    fields: Mapping[str, Any]
    """Of Design: those that the stage fills."""
    marks: Mapping[str, Any] = field(default_factory=dict)
    """Of Fingerprints: those that belong to the stage."""


def advance(
    stage: Stage,
    design: Design,
    compute: Callable[[Assembly], Result],
    ledger: Ledger,
    settings: Mapping[str, str | None] | None = None,
    asked: str | None = None,
) -> Design:
    """The design with the result of the stage; that of later stages is dropped.

    `compute` is given what the stage sees of the assembly. `settings` are those that the result depends on, by their
    names in words; `asked` is what was asked for beside what the design says, None for what a run does.
    """
    start = without(stage, design)
    inputs = fingerprints.of_stage(stage, start, settings or {})
    mark = fingerprints.mark(stage.name, inputs)
    before = ledger.fingerprints
    result = _earlier(stage, ledger) if before.stages.get(stage.name) == mark else None
    if result is not None:
        ledger.keep(stage.name)
    else:
        inputs_before = before.inputs.get(stage.name, {}) if stage.name in before.stages else None
        ledger.compute(stage.name, fingerprints.changes(inputs_before, inputs))
        result = compute(stage.view(design.assembly))
    marks = replace(
        start.fingerprints,
        stages=start.fingerprints.stages | {stage.name: mark},
        inputs=start.fingerprints.inputs | {stage.name: dict(inputs)},
        **result.marks,
    )
    return replace(start, **result.fields, fingerprints=descend(marks, stage, asked))


def _earlier(stage: Stage, ledger: Ledger) -> Result | None:
    """What the stage made before; None where it is not there."""
    fields = {name: getattr(ledger.previous, name) for name in stage.fills}
    marks = {name: getattr(ledger.fingerprints, name) for name in stage.marks}
    return None if fields[stage.fills[-1]] is None else Result(fields, marks)


def without(stage: Stage, design: Design) -> Design:
    """The design before that stage: without its result, and without those of later stages."""
    later = STAGES[STAGES.index(stage) :]
    kinds = {kind for other in later for kind in other.code}
    marks = design.fingerprints
    cleared: dict[str, Any] = {
        name: {kind: mark for kind, mark in getattr(marks, name).items() if kind not in kinds}
        for name in ("stages", "lineage", "inputs")
    } | {name: {} for other in later for name in other.marks}
    fields: dict[str, Any] = {name: {} if name == "surfaces" else None for other in later for name in other.fills}
    return replace(design, **fields, fingerprints=replace(marks, **cleared))


def descend(marks: Fingerprints, stage: Stage, asked: str | None = None) -> Fingerprints:
    """The fingerprints with the lineage of this stage, where that of the stage before is known."""
    earlier = lineage.before(stage)
    descent = lineage.following(stage, marks.lineage.get(earlier, ""), asked)
    return replace(marks, lineage=marks.lineage | {stage.name: descent}) if descent else marks
