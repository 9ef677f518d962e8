"""Collects everything that is wrong with the input, so that all of it is reported at once."""

from __future__ import annotations

from dataclasses import replace

from kinform.errors import InputError, Problem
from kinform.form.constants import PROBLEMS_MOST
from kinform.foundation.words import counted


class Problems:
    """A list of problems that raises itself."""

    def __init__(self) -> None:
        self._items: dict[Problem, None] = {}
        self._alike: dict[tuple[str, str | None], dict[str, None]] = {}
        self._noted = 0
        self.elements = 0
        """Elements of XML that were read so far: their number is limited for all files of a design."""

    def __len__(self) -> int:
        return len(self._items)

    def add(self, message: str, file: str | None, line: int | None, remedy: str, column: int | None = None) -> None:
        """Note a problem; the same problem is kept once. Raises InputError with all where there were very many,
        repeated ones included: looking for more takes long, and these are to be repaired first."""
        self._items.setdefault(Problem(message=message, file=file, line=line, remedy=remedy, column=column))
        self._count()

    def _count(self) -> None:
        self._noted += 1
        if self._noted >= PROBLEMS_MOST:
            self.raise_if_any()

    def add_alike(self, what: str, fault: str, file: str | None, line: int | None, remedy: str) -> None:
        """Note that `what` has a `fault` that others of the file have too: they become one problem, at the first.
        Raises as `add`."""
        others = self._alike.setdefault((fault, file), {})
        if not others:
            self._items.setdefault(Problem(message=fault, file=file, line=line, remedy=remedy))
        others.setdefault(what)
        self._count()

    def _told(self, problem: Problem) -> Problem:
        """The problem with how many have it."""
        alike = self._alike.get((problem.message, problem.file))
        if alike is None:
            return problem
        many = f" (and {counted(len(alike) - 1, 'more such file')})" if len(alike) > 1 else ""
        return replace(problem, message=f"{next(iter(alike))} {problem.message}{many}")

    def raise_if_any(self) -> None:
        """Raise InputError with all problems, by file in the order of their first problem, then by line."""
        if not self._items:
            return
        order = {file: i for i, file in reversed(list(enumerate(p.file for p in self._items)))}
        told = sorted(map(self._told, self._items), key=lambda p: (order[p.file], p.line or 0))
        if self._noted >= PROBLEMS_MOST:
            told.append(Problem("more problems of this input were not looked for", None, None, "repair these first"))
        raise InputError(told)
