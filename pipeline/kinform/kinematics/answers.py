"""Steps that depend on nothing but what they are given: somebody may know their results from an earlier run.

Steps: what contact decides of a pair ("pair"), and which contacts of a block can open together ("opened"). Who
knows, and how long, is not known here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

Result = TypeVar("Result")

Answers = Callable[[str, Sequence[Any], Callable[[], Any]], Any]
"""Somebody who knows what a step, by its name, gives for all that it is given, or has it computed."""


def ask(answers: Answers | None, step: str, question: Sequence[Any], compute: Callable[[], Result]) -> Result:
    """What `compute` gives, which depends on nothing but the `question`: None, numbers, texts, arrays, and tuples and
    dataclasses of such."""
    if answers is None:
        return compute()
    result: Result = answers(step, question, compute)
    return result
