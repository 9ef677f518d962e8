"""What decisions of pairs ask of linear algebra, answered for many at once.

A decision is a generator. Where it needs to know what rows leave free it yields a `Remainder`, and is sent the answer:
many are decided in step (`foundation.lockstep`), and `remains` stacks their questions of one shape. The matrices of a
stack are decomposed one by one: an answer is the same to the last bit whatever it is stacked with.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Generator, Sequence
from typing import TypeVar

import numpy as np

from kinform.foundation.algebra.screws import spans
from kinform.frozen import dataclass
from kinform.model.arrays import Array

NEW_FREEDOM = 0.03
"""A motion adds a freedom when this much of its unit twist lies outside those already found. Chosen, not measured."""


Result = TypeVar("Result")

Turns = tuple[Array, Array]
"""Singular values and right singular vectors (k, k) of the turns of a basis (6, k), which are its first three rows."""

Remains = tuple[Array, Array, Turns, Array]
"""Orthonormal basis (6, k) of what rows leave free, their singular values (6,) ascending, the turns of the basis, and
what it has beyond the freedoms that were named (6, n)."""


@dataclass(frozen=True, eq=False)
class Remainder:
    """What do rows leave free, made exactly consistent with motions that they are known to leave free?"""

    rows: Array
    """(n, 6)."""
    share: Array
    """(n,) weight of each row's square."""
    basis: Array
    """(6, k) orthonormal, of the motions that are known."""
    free: float
    """Singular values below count as none."""
    beyond: Array | None = None
    """(6, k') orthonormal freedoms: what is there beyond them? None: it is not asked."""


Steps = Generator[Remainder, Remains, Result]
"""A way to a result, with questions on it."""


def remains(questions: Sequence[Remainder]) -> list[Remains]:
    """The answers to questions of any shapes."""
    alike: dict[tuple[int, int], list[int]] = defaultdict(list)
    for k, question in enumerate(questions):
        alike[len(question.rows), question.basis.shape[1]].append(k)
    answers: dict[int, Remains] = {}
    for members in alike.values():
        answers |= zip(members, _remains([questions[k] for k in members]), strict=True)
    return [answers[k] for k in range(len(questions))]


def _remains(questions: Sequence[Remainder]) -> list[Remains]:
    """The answers to questions of one shape."""
    share = np.array([question.share for question in questions])
    basis = np.array([question.basis for question in questions])
    rows = np.array([question.rows for question in questions])
    rows *= np.sqrt(share / share.sum(axis=1, keepdims=True))[..., None]
    rows = rows - (rows @ basis) @ np.swapaxes(basis, 1, 2)
    triangle = np.linalg.qr(rows, mode="r") if rows.shape[1] >= 6 else rows
    _, values, right = np.linalg.svd(np.concatenate([triangle, np.zeros((len(rows), 6, 6))], axis=1))
    values, right = values[:, 5::-1], right[:, 5::-1]
    free = np.array([question.free for question in questions])
    null = [vectors[of] for vectors, of in zip(right, values < free[:, None], strict=True)]
    bases = spans([vectors.T for vectors in null])
    return list(zip(bases, values, _turns(bases), _freed(questions, bases), strict=True))


def _turns(bases: Sequence[Array]) -> list[Turns]:
    """Of each basis (6, k)."""
    out: dict[int, Turns] = {}
    for count in {basis.shape[1] for basis in bases}:
        members = [k for k, basis in enumerate(bases) if basis.shape[1] == count]
        _, values, right = np.linalg.svd(np.array([bases[k][:3] for k in members]), full_matrices=True)
        out |= zip(members, zip(values, right, strict=True), strict=True)
    return [out[k] for k in range(len(bases))]


def _freed(questions: Sequence[Remainder], bases: Sequence[Array]) -> list[Array]:
    """(6, n) orthonormal: what each basis (6, k) has beyond the freedoms that its question names."""
    out = [basis[:, :0] for basis in bases]
    alike: dict[tuple[int, int], list[int]] = defaultdict(list)
    for k, (question, basis) in enumerate(zip(questions, bases, strict=True)):
        if question.beyond is not None:
            alike[question.beyond.shape[1], basis.shape[1]].append(k)
    for members in alike.values():
        before = np.array([questions[k].beyond for k in members])
        basis = np.array([bases[k] for k in members])
        rest = basis - before @ (np.swapaxes(before, 1, 2) @ basis)
        vectors, sizes, _ = np.linalg.svd(rest, full_matrices=False)
        for k, of_basis, new in zip(members, vectors, sizes > NEW_FREEDOM, strict=True):
            out[k] = of_basis[:, new]
    return out
