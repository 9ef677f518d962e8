"""Steps that depend on nothing but what they are given: somebody may know their results from an earlier run.

Steps: what contact decides of a pair ("pair"), and which contacts of a block can open together ("opened"). Who
knows, and how long, is not known here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

Result = TypeVar("Result")

Question = TypeVar("Question")

Answers = Callable[[str, Sequence[Any], Callable[[list[Any]], Sequence[Any]]], list[Any]]
"""Somebody who knows what a step, by its name, gives for each of several questions, or has those computed, all at once,
of which it is not known."""


def ask(
    answers: Answers | None,
    step: str,
    questions: Sequence[Question],
    compute: Callable[[Sequence[Question]], Sequence[Result]],
) -> Sequence[Result]:
    """What `compute` gives for the questions, which depends for each on nothing but itself: None, numbers, texts,
    arrays, and tuples and dataclasses of such."""
    return compute(questions) if answers is None else answers(step, questions, compute)
