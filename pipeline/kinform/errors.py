"""Exceptions of kinform. They take data and build the message; the command turns them into exit 2."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from kinform.frozen import dataclass


class KinformError(Exception):
    """Base of everything kinform raises on purpose."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with the input: what, where, and what to do about it.

    `file` is as the user wrote it or relative to the manifest; `line` and `column` are 1-based; `remedy` is an
    imperative sentence.
    """

    message: str
    file: str | None = None
    line: int | None = None
    remedy: str | None = None
    column: int | None = None

    @property
    def within(self) -> str:
        """Where in the file it is, as it follows the file's name: ":12:5", or ""."""
        return "".join(f":{number}" for number in (self.line, self.column) if number is not None)

    def __str__(self) -> str:
        place = f"{self.file or ''}{self.within}"
        text = f"{place}: {self.message}" if place else self.message
        return f"{text}\n  remedy: {self.remedy}" if self.remedy else text


class InputError(KinformError):
    """The input cannot be used; carries every problem that was found, not only the first."""

    def __init__(self, problems: Iterable[Problem]):
        self.problems = tuple(problems)
        super().__init__("\n".join(str(p) for p in self.problems))


class OpenSidesError(InputError):
    """Joints that do not name their sides, where contact does not tell them; problems by joint."""

    def __init__(self, by_joint: Mapping[str, Problem]):
        self.by_joint = by_joint
        super().__init__(by_joint.values())

    def at(self, places: Mapping[str, tuple[str, int | None]]) -> OpenSidesError:
        """The same with the file and line of each joint."""
        return OpenSidesError(
            {
                name: replace(problem, file=places[name][0] or None, line=places[name][1])
                if name in places
                else problem
                for name, problem in self.by_joint.items()
            }
        )


class ResultsError(KinformError):
    """A results file cannot be read or written; `problem` names it."""

    def __init__(self, problem: Problem | str):
        self.problem = Problem(problem) if isinstance(problem, str) else problem
        super().__init__(str(self.problem))


class StageError(KinformError):
    """A stage was asked for before the stages that it needs."""

    def __init__(self, stage: str, needs: str):
        self.stage, self.needs = stage, needs
        super().__init__(f"{stage} needs the results of `kinform {needs}`: run that first")
