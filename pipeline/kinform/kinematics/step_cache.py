"""The interface of a cache for pure steps of the derivation; `reuse.decisions` implements it.

Steps that may be cached: the joint of a pair of bodies ("pair"), and which contacts of a block can open together
("opened"). Each result depends on its question alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

Result = TypeVar("Result")

Question = TypeVar("Question")

StepCache = Callable[[str, Sequence[Any], Callable[[list[Any]], Sequence[Any]]], list[Any]]
"""Takes the name of a step, its questions, and the function that computes the results of several questions at once;
returns the results, computing only those that it does not have."""


def cached_each(
    cache: StepCache | None,
    step: str,
    questions: Sequence[Question],
    compute: Callable[[Sequence[Question]], Sequence[Result]],
) -> Sequence[Result]:
    """The results of `compute` for the questions, from the cache where it has them. Results are None, numbers, texts,
    arrays, or tuples and dataclasses of these."""
    return compute(questions) if cache is None else cache(step, questions, compute)
