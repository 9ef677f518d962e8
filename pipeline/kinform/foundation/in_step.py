"""Many ways to results gone in step: each goes on by itself, and what they ask on it is answered for all at once.

A way is a generator that yields its questions, is sent the answers, and returns its result. That an answer is the same
whatever is asked beside it is for those to see to who answer.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Result = TypeVar("Result")


def in_step(
    ways: Sequence[Generator[Question, Answer, Result]], answers: Callable[[Sequence[Question]], Sequence[Answer]]
) -> list[Result]:
    """Where each of the ways leads: all go on to their next question, `answers` is asked for those of all, and so forth
    until none is left."""
    results: dict[int, Result] = {}
    asked: dict[int, Question] = {}

    def go_on(k: int, answer: Answer | None) -> None:
        try:
            asked[k] = next(ways[k]) if answer is None else ways[k].send(answer)
        except StopIteration as end:
            results[k] = end.value

    for k in range(len(ways)):
        go_on(k, None)
    while asked:
        waiting, found = list(asked), answers(list(asked.values()))
        asked.clear()
        for k, answer in zip(waiting, found, strict=True):
            go_on(k, answer)
    return [results[k] for k in range(len(ways))]
