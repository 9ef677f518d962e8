"""Spaces of screws in words: of relative motions, and of the forces and moments that are held against them.

Motions: the Lie subgroup that a space is, and what turns and slides span it. The ten kinds of subgroups of rigid
motions beside the identity and all of them: revolute, prismatic, screw, cylindrical, planar translation, planar,
spherical, planar screw, spatial translation, Schoenflies (Hervé 1978). The lower pairs among them have a type of
their own; the others are `general` joints, and only words tell them apart.

Forces and moments: readable directions that span a space of wrenches, "force along z, moments about x and y".
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, span
from kinform.foundation.algebra.vectors import canonical, cross, cross_matrix, norm, perpendicular
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.foundation.words import counted, listed
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.screws.canonical_basis import directions as canonical_directions
from kinform.model.arrays import Array

EXACT_WRENCH = SINGLE
"""Of wrenches, whose joints are snapped: below this they are zero but for rounding."""
NAMED_AXIS = 5e-4
"""Half of the third digit. Directions this near (sine) to an axis of the world have its name, and components below it
are shown as 0."""


def components(direction: Array) -> str:
    """ "(0, 0.6, 0.8)"."""
    return _in_brackets(direction, NAMED_AXIS, "{:.3g}")


def _in_brackets(numbers: Array, least: float, form: str) -> str:
    """Numbers (3,) as text; those below `least` are zero."""
    return "(" + ", ".join(form.format(0.0 if abs(x) < least else x) for x in numbers.tolist()) + ")"


def direction_words(direction: Array) -> str:
    """A signed unit direction: "+z", "-x", or its components."""
    size = np.abs(direction)
    axis = int(size.argmax())
    if size[axis] > 1.0 - 0.5 * SAME_DIRECTION**2:
        return f"{'+' if direction[axis] > 0.0 else '-'}{'xyz'[axis]}"
    return components(direction)


def axis_word(direction: Array, near: float = NAMED_AXIS) -> str:
    """ "z", where it is so near to it (sine), or "(0.6, 0.8, 0)"."""
    unit = canonical(direction)
    for name, axis in zip("xyz", np.eye(3), strict=True):
        if norm(unit - axis) < near:
            return name
    return "(" + ", ".join(f"{round(float(c), 3) + 0.0:g}" for c in unit) + ")"


def group_of(basis: Array, frame: Frame) -> str:
    """Name of the subgroup that the span of `basis` (6, k; scaled in `frame`) is; "" where it is none."""
    return _group(*_split(basis))


def _group(turns: Array, slides: Array) -> str:
    """Name of the subgroup that these twists that turn and that slide span; "" where it is none."""
    kind = (turns.shape[1], slides.shape[1])
    if kind in _NAMES:
        return _NAMES[kind]
    if kind == (1, 0):
        return "revolute" if abs(_lead(turns[:, 0])) < SINGLE else "screw"
    if kind[0] == 1:
        axis = turns[:3, 0] / norm(turns[:3, 0])
        along = norm(axis @ slides[3:])
        if kind == (1, 1) and along > 1.0 - SINGLE:
            return "cylindrical"
        if kind == (1, 2) and along < SINGLE:
            return "planar" if abs(_lead(turns[:, 0])) < SINGLE else "planar screw"
        return ""
    centre = _centre(turns) if kind[0] > 1 and kind[1] == 0 else None
    return "spherical" if kind == (3, 0) and centre is not None else ""


_NAMES = {
    (0, 0): "identity", (0, 1): "prismatic", (0, 2): "planar translation", (0, 3): "spatial translation",
    (1, 3): "Schoenflies", (3, 3): "all rigid motions",
}  # fmt: skip
"""Subgroups that the numbers of turns and slides tell alone."""


def motions_in_words(basis: Array, frame: Frame) -> str:
    """What the motions are: "turns about (0, 0, 1), slides along (1, 0, 0)", with the subgroup where it is one.

    Points are given in mm in the world, of axes that lie in one place.
    """
    turns, slides = _split(basis)
    parts = [*_turning(turns, slides, frame)]
    directions = _tidy(slides[3:])
    if directions.shape[1] == 3:
        parts.append("slides every way")
    elif directions.shape[1]:
        parts.append("slides along " + " and ".join(_axis_components(d) for d in directions.T))
    name = _group(turns, slides)
    return ", ".join(parts or ["does not move"]) + (f" ({name})" if name else "")


def _split(basis: Array) -> tuple[Array, Array]:
    """Twists that turn, their velocities without what slides do (6, r), and twists that slide (6, s)."""
    if not basis.shape[1]:
        return basis, basis
    if basis.shape[1] == 1:
        count, mixed = int(norm(basis[:3]) > SINGLE), basis
    else:
        _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
        count = int(np.count_nonzero(values > SINGLE))
        mixed = basis @ right.T
    turns, slides = mixed[:, :count].copy(), mixed[:, count:].copy()
    if slides.shape[1]:
        slides[:3] = 0.0
        slides[3:] = np.linalg.qr(slides[3:])[0]
        turns[3:] -= slides[3:] @ (slides[3:].T @ turns[3:])
    return turns, slides


def _lead(twist: Array) -> float:
    """Advance a radian, in lengths of the frame."""
    return float(twist[:3] @ twist[3:] / (twist[:3] @ twist[:3]))


def _turning(turns: Array, slides: Array, frame: Frame) -> list[str]:
    """What the turns are: about one axis (a screw, where it advances across the slides), two, or every axis."""
    count = turns.shape[1]
    if count == 0:
        return []
    if count == 1:
        twist = turns[:, 0]
        lead = 2.0 * np.pi * frame.length * _lead(twist)
        # along a slide it may be anywhere
        place = frame.centre + frame.length * cross(twist[:3], twist[3:]) / (twist[:3] @ twist[:3])
        through = "" if slides.shape[1] > 1 else f" through {_point(place, frame)}"
        if abs(lead) > SINGLE * frame.length and norm(slides[3:].T @ canonical(twist[:3])) < 1.0 - SINGLE:
            return [f"screws about {_axis_components(twist[:3])}{through}, {1e3 * lead:.4g} mm a turn"]
        return [f"turns about {_axis_components(twist[:3])}{through}"]
    centre = _centre(turns) if not slides.shape[1] else None
    about = "" if centre is None else f" through {_point(frame.centre + frame.length * centre, frame)}"
    if count == 3:
        return [f"turns every way{about}"]
    axes = _tidy(turns[:3])
    words = " and ".join(_axis_components(axis) for axis in axes.T)
    return [f"turns about {words}{about}" + (", as a universal joint does" if centre is not None else "")]


def _centre(turns: Array) -> Array | None:
    """The point, in lengths from the centre of the frame, that rests under all turns; None where there is none."""
    matrix, right = cross_matrix(turns[:3].T).reshape(-1, 3), -turns[3:].T.ravel()
    centre, *_ = np.linalg.lstsq(matrix, right, rcond=None)
    return None if float(np.abs(matrix @ centre - right).max()) > 10.0 * SINGLE else np.asarray(centre)


def _tidy(directions: Array) -> Array:
    """Perpendicular unit vectors (3, k) of the same span: of a plane, the first one across the coordinate axis that
    is nearest to its normal's smallest component."""
    if directions.shape[1] == 2:
        return canonical_directions(directions)
    return np.linalg.qr(directions)[0] if directions.shape[1] else directions


def _point(place: Array, frame: Frame) -> str:
    size = max(*(abs(x) for x in place.tolist()), frame.length)
    return _in_brackets(1e3 * place, SINGLE * 1e3 * size, "{:.4g}") + " mm"


def _axis_components(direction: Array) -> str:
    return components(canonical(direction))


Locked = tuple[str, Array]
"""In words, and as a wrench (τ about the centre over the length; f)."""


def rows_too_many(count: int) -> str:
    """ "1 row too many", "3 rows too many"."""
    return f"{counted(count, 'row')} too many"


def locked_wrenches(wrenches: Array, near: float = NAMED_AXIS) -> list[Locked]:
    """The space of the rows (k, 6), (τ about the centre over the length; f), in readable directions: forces first.

    Directions within `near` (sine) of an axis of the world have its name. A force is followed by " with a moment
    about it" where its line of action has one.
    """
    basis = span(wrenches.T)
    left, values, right = np.linalg.svd(basis[3:], full_matrices=True)
    rank = int(np.count_nonzero(values > SINGLE))
    moments = basis[:3] @ right[rank:].T
    moments = span(moments) if moments.shape[1] else moments
    out: list[Locked] = []
    for direction in _directions(left[:, :rank]):
        wrench = basis @ np.linalg.lstsq(basis[3:], direction, rcond=SOLVED)[0]
        wrench[:3] -= moments @ (moments.T @ wrench[:3])
        twisted = abs(float(wrench[:3] @ direction)) > 10.0 * SINGLE
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
    inside = [e for e in np.eye(3) if abs(float(e @ normal)) < SINGLE]
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
