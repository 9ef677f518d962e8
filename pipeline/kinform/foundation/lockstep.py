"""Generators run in lockstep: the questions that they yield are answered in one batch a round.

A generator yields a question, is sent the answer, and returns its result. The function that answers a batch must give
each question the answer that it would get alone.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Result = TypeVar("Result")


def run_in_lockstep(
    generators: Sequence[Generator[Question, Answer, Result]], answers: Callable[[Sequence[Question]], Sequence[Answer]]
) -> list[Result]:
    """The result of each generator. In each round all unfinished generators yield one question, and `answers` is
    called once with these questions."""
    results: dict[int, Result] = {}
    asked: dict[int, Question] = {}

    def advance(k: int, answer: Answer | None) -> None:
        try:
            asked[k] = next(generators[k]) if answer is None else generators[k].send(answer)
        except StopIteration as end:
            results[k] = end.value

    for k in range(len(generators)):
        advance(k, None)
    while asked:
        waiting, found = list(asked), answers(list(asked.values()))
        asked.clear()
        for k, answer in zip(waiting, found, strict=True):
            advance(k, answer)
    return [results[k] for k in range(len(generators))]
