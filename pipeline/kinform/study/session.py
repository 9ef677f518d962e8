"""A study from start to end: the design as it stands, all samples by a crew, and where it stopped."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from kinform.batch.crew import Crew
from kinform.batch.desk import code_of_here
from kinform.batch.desks import close_all, perform
from kinform.batch.session import Settings
from kinform.batch.task import INPUT, Task
from kinform.errors import InputError, Problem
from kinform.form.keys import steps_of
from kinform.foundation import provenance
from kinform.frozen import dataclass
from kinform.results import computed_anew, refuse_links
from kinform.study.plan import Plan
from kinform.study.sampling import samples

Row = tuple[float | None, ...]


@dataclass(frozen=True)
class Outcome:
    """All samples and what was measured of them."""

    plan: Plan
    samples: tuple[tuple[Any, ...], ...]
    """Values of the axes, sample by sample."""
    measured: tuple[Row, ...]
    """Of each sample; all None of one that failed."""
    failures: tuple[str, ...]
    """Of each sample: "" where it was measured."""
    nominal: Row
    """Of the design as it stands."""
    units: tuple[str, ...] = ()
    """Of what is measured; "" where nothing says it."""


def run(
    plan: Plan,
    output: Path,
    settings: Settings,
    progress: Callable[[int, int], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> Outcome:
    """Measure all samples. What an interrupted study of the same files has measured, kept beside `output`, is not
    measured again, if it was this user's, or the settings trust it; else `say` is told. Raises InputError where the
    design as it stands cannot be used, or a measure is not there."""
    rows = samples(plan)
    measured = [steps_of(one.value) for one in plan.measures]
    folder = Path(tempfile.mkdtemp(prefix=".kinform-study-", dir=output.parent))
    try:
        base = folder / "base.h5"
        nominal, units, contents = _nominal(plan, base, measured, settings)
        kept = Journal(_part(output), _key(plan, contents), trust=settings.trust_results)
        done = kept.read()
        if kept.unknown and say is not None:
            say(f"{kept.path}: {computed_anew(kept.path)}")
        tasks = [
            _task(plan, k, row, base if base.exists() else None, measured, settings)
            for k, row in enumerate(rows)
            if k not in done
        ]
        if tasks:
            _measure(tasks, kept, done, settings, progress)
    finally:
        close_all()
        shutil.rmtree(folder, ignore_errors=True)
    nothing: Row = (None,) * len(measured)
    values = tuple(done[k][0] or nothing for k in range(len(rows)))
    return Outcome(plan, tuple(rows), values, tuple(done[k][1] for k in range(len(rows))), nominal, units)


def _measure(
    tasks: Sequence[Task],
    kept: Journal,
    done: dict[int, tuple[Row | None, str]],
    settings: Settings,
    progress: Callable[[int, int], None] | None,
) -> None:
    with kept, Crew(min(settings.jobs, len(tasks)), settings.scheduler) as crew:
        for count, answer in enumerate(crew.answers(tasks), start=1):
            k = int(answer.key.rpartition(" ")[2])
            why = ""
            if answer.failure is not None:
                why = f"{answer.failure.kind}: " + "; ".join(p.message for p in answer.failure.problems)
            done[k] = (answer.result, why)
            kept.note(k, answer.result, why)
            if progress is not None:
                progress(count, len(tasks))


def _nominal(
    plan: Plan, base: Path, measured: Sequence[tuple[str, ...]], settings: Settings
) -> tuple[Row, tuple[str, ...], dict[str, str]]:
    """What is measured of the design as it stands, with its results at `base`, and the units; and the hashes of its
    files."""
    arguments = {"design": str(plan.design.absolute()), "output": str(base), "measured": measured,
                 "allow_outside": settings.allow_outside, "allow_xacro": settings.allow_xacro}  # fmt: skip
    answer = perform(Task("nominal", "kinform.study.work:nominal", arguments, settings.limits))
    if answer.failure is not None:
        if answer.failure.kind == INPUT:
            raise InputError(answer.failure.problems)
        problem = answer.failure.problems[0]
        raise InputError([Problem(f"as it stands: {problem.message}", str(plan.design), None, problem.remedy)])
    result: tuple[Row, tuple[str, ...], dict[str, str]] = answer.result
    return result


def _task(
    plan: Plan, k: int, row: tuple[Any, ...], base: Path | None, measured: Sequence[tuple[str, ...]], settings: Settings
) -> Task:
    named = {axis.name: value for axis, value in zip(plan.axes, row, strict=True)}
    changes = [(axis.steps, named[axis.name]) for axis in plan.axes if axis.steps is not None]
    commands = [
        (make.part, [_filled(word, named) for word in make.command], make.suffix) for make in plan.makes
    ]  # fmt: skip
    arguments = {
        "design": str(plan.design.absolute()), "base": None if base is None else str(base.absolute()),
        "changes": changes, "measured": measured, "commands": commands, "allow_outside": settings.allow_outside,
        "allow_xacro": settings.allow_xacro, "folder": str(plan.path.parent.absolute()),
    }  # fmt: skip
    return Task(f"sample {k}", "kinform.study.work:sample", arguments, settings.limits, code_of_here())


def _filled(word: str, values: dict[str, Any]) -> str:
    """The word of a command with the values of what varies in it."""
    for name, value in values.items():
        word = word.replace("{" + name + "}", repr(value) if isinstance(value, float) else str(value))
    return word


def _key(plan: Plan, contents: dict[str, str]) -> str:
    """What measured samples are samples of."""
    whole = [plan.digest, code_of_here(), sorted(contents.items())]
    return hashlib.sha256(json.dumps(whole).encode()).hexdigest()


class Journal:
    """The samples that are measured, a line each, as they come: what is left of a study that was interrupted. Each line
    ends with a code that only this user's kinform can make of it."""

    def __init__(self, path: Path, key: str, *, trust: bool = False):
        self.path, self._key, self._trust = path, key, trust
        self._stream: Any = None
        self.unknown = 0
        """Lines of this very study that were read and are of unknown origin."""

    def read(self) -> dict[int, tuple[Row | None, str]]:
        """What is there of this very study; a line that is not whole is left out."""
        out: dict[int, tuple[Row | None, str]] = {}
        for k, values, why, _ in self._lines():
            out[int(k)] = (None if values is None else tuple(values), str(why))
        return out

    def _lines(self) -> Iterator[Any]:
        try:
            refuse_links(self.path)
            lines = self.path.read_text(encoding="utf-8").split("\n")
        except (OSError, UnicodeDecodeError):
            return
        if lines[0] != json.dumps({"study": self._key}):
            return
        for line in lines[1:-1]:  # behind the last end of line is nothing, or half a line
            try:
                k, values, why, code = json.loads(line)
            except (ValueError, TypeError):
                return
            if not _is_sample(k, values, why):
                return
            if self._trust or provenance.is_signed(self._text(k, values, why), code, self.path):
                yield k, values, why, code
            else:
                self.unknown += 1

    def _text(self, k: int, values: Row | None, why: str) -> str:
        """What the code of a line is made of."""
        return json.dumps([self._key, k, values, why])

    def __enter__(self) -> Journal:
        whole = [json.dumps({"study": self._key}), *(json.dumps(line) for line in self._lines())]
        refuse_links(self.path)
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_NOFOLLOW", 0)
        self._stream = open(os.open(self.path, flags, 0o666), "w", encoding="utf-8")
        self._stream.write("\n".join(whole) + "\n")
        self._stream.flush()
        return self

    def __exit__(self, *_: object) -> None:
        self._stream.close()

    def note(self, k: int, values: Row | None, why: str) -> None:
        """Keep a sample."""
        code = provenance.signed(self._text(k, values, why), self.path)
        self._stream.write(json.dumps([k, values, why, code]) + "\n")
        self._stream.flush()

    def forget(self) -> None:
        """The study is written: nothing is left to be gone on with."""
        if self.path.exists():
            os.unlink(self.path)


def _is_sample(k: Any, values: Any, why: Any) -> bool:
    """Whether a line holds what `note` was given."""
    numbers = values is None or (
        isinstance(values, list) and all(v is None or isinstance(v, int | float) for v in values)
    )
    return isinstance(k, int) and numbers and isinstance(why, str)


def journal_of(output: Path) -> Journal:
    """The journal beside the file of a study."""
    return Journal(_part(output), "")


def _part(output: Path) -> Path:
    """Where the journal stands while a study runs."""
    return output.with_name(f"{output.name}.part")
