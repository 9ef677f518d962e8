"""What is asked of a worker, and what it answers: plain values, which travel between processes and machines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, Literal

from kinform.errors import Problem
from kinform.frozen import dataclass

FailureKind = Literal["worker died", "time limit", "memory limit", "input", "internal error"]
"""Why a task has no result."""
DIED: FailureKind = "worker died"
TIME: FailureKind = "time limit"
MEMORY: FailureKind = "memory limit"
INPUT: FailureKind = "input"
INTERNAL: FailureKind = "internal error"


@dataclass(frozen=True)
class Limits:
    """What a task may take; None: as much as there is."""

    seconds: float | None = None
    memory: int | None = None
    """Bytes of resident memory, of all processes of the task together."""


UNLIMITED = Limits()


@dataclass(frozen=True)
class Task:
    """A function of `kinform` and what it is called with."""

    key: str
    """Tells the task from all others."""
    function: str
    """`module:name`."""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    limits: Limits = UNLIMITED
    code: str = ""
    """Of the kinform that asks; a worker with another one refuses. "" where any will do."""


@dataclass(frozen=True)
class Failure:
    """Why there is no result."""

    kind: FailureKind
    problems: tuple[Problem, ...]


@dataclass(frozen=True)
class Answer:
    """What a task gave, or why it gave nothing, and how long it took."""

    key: str
    result: Any = None
    failure: Failure | None = None
    seconds: float = 0.0
    tries: int = 1


def failed(kind: FailureKind, message: str, remedy: str | None = None) -> Failure:
    """The failure that says this."""
    return Failure(kind, (Problem(message, None, None, remedy),))
