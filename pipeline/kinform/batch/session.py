"""A batch from start to end: what needs nothing, what is to be run, rows as they come, and the record."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from kinform import results
from kinform.batch import record
from kinform.batch.crew import Crew
from kinform.batch.desk import code_of_here
from kinform.batch.desks import close_all, perform
from kinform.batch.discovery import Found
from kinform.batch.record import Record, Row
from kinform.batch.task import INPUT, UNLIMITED, Answer, Failure, Limits, Task
from kinform.batch.unchanged import row_if_unchanged
from kinform.errors import InputError, Problem, ResultsError
from kinform.foundation import provenance
from kinform.frozen import dataclass


@dataclass(frozen=True)
class Settings:
    """How designs are run; nothing of it changes what comes out of one."""

    jobs: int = 1
    scheduler: str | None = None
    send: bool = False
    """Whether inputs are sent to the workers and results back; else they see the same files."""
    limits: Limits = UNLIMITED
    allow_outside: bool = False
    allow_xacro: bool = False
    trust_results: bool = False
    """Whether earlier results are reused whoever wrote them."""


def run(
    found: Sequence[Found],
    folder: Path,
    settings: Settings,
    progress: Callable[[int, int], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> tuple[Row, ...]:
    """Run all designs, with results below `folder`; gives their rows, in the order of `found`.

    What is unchanged is not touched. `say` is told where earlier results are not used because of their origin. A design
    that fails stops no other. The record is written as rows come, also where this is interrupted. `progress(done, to be
    done)` counts designs that are run. Raises InputError where Dask is missing and something is to be run, or nothing
    can be written.
    """
    _make(folder)
    kept = record.read(folder, trust=settings.trust_results)
    if kept.note and say is not None:
        say(kept.note)
    rows: dict[str, Row] = {}
    for one in found:
        fault = one.fault or _unmade(folder / one.results, folder)
        if fault is not None:
            rows[one.name] = kept.rows[one.name] = _row(one, Answer(one.name, failure=Failure(INPUT, (fault,))))
            continue
        row = row_if_unchanged(one, kept, folder, allow_outside=settings.allow_outside)
        if row is not None:
            rows[one.name] = row
    left = [one for one in found if one.name not in rows]
    if len(rows) > sum(row.unchanged for row in rows.values()):
        record.write(kept, folder)
    if left:
        _run(left, folder, settings, kept, rows, progress)
    return tuple(rows[one.name] for one in found)


def _run(
    left: Sequence[Found],
    folder: Path,
    settings: Settings,
    kept: Record,
    rows: dict[str, Row],
    progress: Callable[[int, int], None] | None,
) -> None:
    """Run what is left, and note each row when it comes."""
    by_name = {one.name: one for one in left}
    written = time.monotonic()
    with Crew(min(settings.jobs, len(left)), settings.scheduler) as crew:
        if progress is not None:
            progress(0, len(left))
        try:
            for done, answer in enumerate(_answers(left, folder, settings, crew), start=1):
                one = by_name[answer.key]
                rows[one.name] = kept.rows[one.name] = _row(one, answer)
                if progress is not None:
                    progress(done, len(left))
                # s between two writings of the record: what a killed batch has to look at again. Chosen, not measured.
                if time.monotonic() - written > 5.0:
                    record.write(kept, folder)
                    written = time.monotonic()
        finally:
            record.write(kept, folder)


def _answers(left: Sequence[Found], folder: Path, settings: Settings, crew: Crew) -> Iterator[Answer]:
    """The answers as they come: a result is the fields of a row."""
    code = code_of_here()
    how = {
        "allow_outside": settings.allow_outside,
        "allow_xacro": settings.allow_xacro,
        "trust_results": settings.trust_results,
    }
    if not settings.send:
        yield from crew.answers(
            Task(one.name, "kinform.batch.work:run",
                 {"source": str(one.source.absolute()), "output": str((folder / one.results).absolute()), **how},
                 settings.limits, code)
            for one in left
        )  # fmt: skip
        return
    try:
        yield from _sent(left, folder, settings, crew, code)
    finally:
        close_all()


def _sent(left: Sequence[Found], folder: Path, settings: Settings, crew: Crew, code: str) -> Iterator[Answer]:
    """As _answers, for workers that see none of the files: designs are imported here, by a desk."""
    refused: list[Answer] = []

    def tasks() -> Iterator[Task]:
        for one in left:
            allowed = {"allow_outside": settings.allow_outside, "allow_xacro": settings.allow_xacro}
            source = {"source": str(one.source.absolute()), **allowed}
            answer = perform(Task(one.name, "kinform.batch.work:imported", source, settings.limits))
            if answer.failure is not None:
                refused.append(answer)
            else:
                design = {"design": answer.result}
                yield Task(one.name, "kinform.batch.work:derive", design, settings.limits, code)

    places = {one.name: folder / one.results for one in left}
    for answer in crew.answers(tasks()):
        yield answer if answer.failure is not None else _kept(answer, places[answer.key], folder)
        yield from _taken(refused)
    yield from _taken(refused)


def _taken(answers: list[Answer]) -> Iterator[Answer]:
    while answers:
        yield answers.pop(0)


def _kept(answer: Answer, output: Path, folder: Path) -> Answer:
    """The answer after its results file was written; the fields of a row as result."""
    from kinform.batch.work import summary_of

    data, said = answer.result
    try:
        results.write_bytes(data, output, below=folder)
    except (ResultsError, InputError) as error:
        problems = error.problems if isinstance(error, InputError) else (error.problem,)
        return Answer(answer.key, failure=Failure(INPUT, problems), seconds=answer.seconds, tries=answer.tries)
    fields = summary_of(results.read_gist(output, recorded=True), data, said)
    return Answer(answer.key, fields, seconds=answer.seconds, tries=answer.tries)


def _row(one: Found, answer: Answer) -> Row:
    start: dict[str, Any] = {
        "name": one.name, "source": str(one.source), "results": one.results, "seconds": round(answer.seconds, 3),
        "tries": answer.tries,
    }  # fmt: skip
    if answer.failure is not None:
        return Row(**start, failure=answer.failure.kind, problems=answer.failure.problems)
    fields = dict(answer.result)
    seal = fields.pop("seal")
    if fields["recorded"]:  # a worker elsewhere keeps records of its own
        provenance.record(seal)
    return Row(**start, **fields)


def _unmade(output: Path, folder: Path) -> Problem | None:
    """Why a results file cannot be written below the folder, or the folders on its way not made; None where they are
    there now."""
    try:
        results.make_folder(output.parent, folder)
        results.refuse_links(output, (), folder)
    except ResultsError as error:
        return error.problem
    except OSError as error:
        return Problem(
            f"its results cannot be written: {error.strerror}", str(output), None, "rename it, or --exclude it"
        )
    return None


def _make(folder: Path, below: Path | None = None) -> None:
    try:
        results.make_folder(folder, below)
    except OSError as error:
        problem = Problem(f"the folder cannot be made: {error.strerror}", str(folder), None, "name another with -o")
        raise InputError([problem]) from None
