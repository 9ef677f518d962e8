"""Axes and spaces of forces and moments in words: "force along z", "moments about x and y"."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kinform.foundation.algebra.screws import span
from kinform.foundation.algebra.vectors import canonical, cross, perpendicular
from kinform.model.arrays import Array

__all__ = ["Locked", "axis_word", "listed", "locked", "locked_text", "rows_too_many"]


EXACT = 1e-6

Locked = tuple[str, Array]
"""In words, and as a wrench (τ about the centre over the length; f)."""


def axis_word(direction: Array, near: float = 5e-4) -> str:
    """ "z", where it is so near to it (sine), or "(0.6, 0.8, 0)"."""
    unit = canonical(direction)
    for name, axis in zip("xyz", np.eye(3), strict=True):
        if float(np.linalg.norm(unit - axis)) < near:
            return name
    return "(" + ", ".join(f"{round(float(c), 3) + 0.0:g}" for c in unit) + ")"


def listed(items: Iterable[str]) -> str:
    """ "a", "a and b", "a, b and c"."""
    known = list(items)
    return known[0] if len(known) == 1 else ", ".join(known[:-1]) + " and " + known[-1] if known else ""


def rows_too_many(count: int) -> str:
    """ "1 row too many", "3 rows too many"."""
    return f"{count} row{'' if count == 1 else 's'} too many"


def locked(wrenches: Array, near: float = 5e-4) -> list[Locked]:
    """The space of the rows (k, 6), (τ about the centre over the length; f), in readable directions: forces first.

    Directions within `near` (sine) of an axis of the world have its name. A force is followed by " with a moment about it" where its line of action has one.
    """
    basis = span(wrenches.T)
    left, values, right = np.linalg.svd(basis[3:], full_matrices=True)
    rank = int(np.count_nonzero(values > EXACT))
    moments = basis[:3] @ right[rank:].T
    moments = span(moments) if moments.shape[1] else moments
    out: list[Locked] = []
    for direction in _directions(left[:, :rank]):
        wrench = basis @ np.linalg.lstsq(basis[3:], direction, rcond=1e-9)[0]
        wrench[:3] -= moments @ (moments.T @ wrench[:3])
        twisted = abs(float(wrench[:3] @ direction)) > 10.0 * EXACT
        out.append(
            (f"force along {axis_word(direction, near)}" + (" with a moment about it" if twisted else ""), wrench)
        )
    for direction in _directions(moments):
        out.append((f"moment about {axis_word(direction, near)}", np.concatenate([direction, np.zeros(3)])))
    return out


def _directions(space: Array) -> list[Array]:
    """Unit vectors that span the columns (3, k): axes of the world where they do."""
    count = space.shape[1]
    if count == 0:
        return []
    if count == 3:
        return list(np.eye(3))
    if count == 1:
        return [canonical(space[:, 0])]
    normal = canonical(cross(space[:, 0], space[:, 1]))
    inside = [e for e in np.eye(3) if abs(float(e @ normal)) < EXACT]
    if len(inside) == 2:
        return inside
    if len(inside) == 1:
        return [inside[0], canonical(cross(normal, inside[0]))]
    return [canonical(d) for d in perpendicular(normal)]


def locked_text(words: Sequence[str]) -> str:
    """ "force along z, moments about x and y"."""
    groups: dict[str, list[str]] = {}
    for word in words:
        for head in ("force along ", "moment about "):
            if word.startswith(head) and "with" not in word:
                groups.setdefault(head, []).append(word.removeprefix(head))
                break
        else:
            groups.setdefault(word, []).append("")
    out = []
    for head, axes in groups.items():
        if len(axes) > 1 and axes[0]:
            noun, rest = head.split(" ", 1)
            out.append(f"{noun}s {rest}{listed(axes)}")
        else:
            out.append(head + axes[0])
    return ", ".join(out)
