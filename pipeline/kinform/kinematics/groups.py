"""Spaces of relative motions in words: the Lie subgroup that a space is, and what turns and slides span it.

The ten kinds of subgroups of rigid motions beside the identity and all of them: revolute, prismatic, screw,
cylindrical, planar translation, planar, spherical, planar screw, spatial translation, Schoenflies (Hervé 1978). The
lower pairs among them have a type of their own; the others are `general` joints, and only words tell them apart.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import canonical, cross, perpendicular
from kinform.model.arrays import Array

__all__ = ["group_of", "in_words"]


EXACT = 1e-5
"""Of unit twists, scaled in the frame: what is zero is zero to rounding and snapping."""


def group_of(basis: Array, frame: Frame) -> str:
    """Name of the subgroup that the span of `basis` (6, k; scaled in `frame`) is; "" where it is none."""
    turns, slides = _split(basis)
    kind = (turns.shape[1], slides.shape[1])
    if kind in _NAMES:
        return _NAMES[kind]
    if kind == (1, 0):
        return "revolute" if abs(_lead(turns[:, 0])) < EXACT else "screw"
    if kind[0] == 1:
        axis = turns[:3, 0] / np.linalg.norm(turns[:3, 0])
        along = float(np.linalg.norm(axis @ slides[3:]))
        if kind == (1, 1) and along > 1.0 - EXACT:
            return "cylindrical"
        if kind == (1, 2) and along < EXACT:
            return "planar" if abs(_lead(turns[:, 0])) < EXACT else "planar screw"
        return ""
    centre = _centre(turns) if kind[0] > 1 and kind[1] == 0 else None
    return "spherical" if kind == (3, 0) and centre is not None else ""


_NAMES = {
    (0, 0): "identity", (0, 1): "prismatic", (0, 2): "planar translation", (0, 3): "spatial translation",
    (1, 3): "Schoenflies", (3, 3): "all rigid motions",
}  # fmt: skip
"""Subgroups that the numbers of turns and slides tell alone."""


def in_words(basis: Array, frame: Frame) -> str:
    """What the motions are: "turns about (0, 0, 1), slides along (1, 0, 0)", with the subgroup where it is one.

    Points are given in mm in the world, of axes that lie in one place.
    """
    turns, slides = _split(basis)
    said = [*_turning(turns, slides, frame)]
    directions = _tidy(slides[3:])
    if directions.shape[1] == 3:
        said.append("slides every way")
    elif directions.shape[1]:
        said.append("slides along " + " and ".join(_vector(d) for d in directions.T))
    name = group_of(basis, frame)
    return ", ".join(said or ["does not move"]) + (f" ({name})" if name else "")


def _split(basis: Array) -> tuple[Array, Array]:
    """Twists that turn, their velocities without what slides do (6, r), and twists that slide (6, s)."""
    if not basis.shape[1]:
        return basis, basis
    _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
    count = int(np.count_nonzero(values > EXACT))
    mixed = basis @ right.T
    turns, slides = mixed[:, :count].copy(), mixed[:, count:].copy()
    slides[:3] = 0.0
    if slides.shape[1]:
        slides[3:] = np.linalg.qr(slides[3:])[0]
    turns[3:] -= slides[3:] @ (slides[3:].T @ turns[3:])
    return turns, slides


def _lead(twist: Array) -> float:
    """Advance a radian, in lengths of the frame."""
    return float(twist[:3] @ twist[3:] / (twist[:3] @ twist[:3]))


def _turning(turns: Array, slides: Array, frame: Frame) -> list[str]:
    count = turns.shape[1]
    if count == 0:
        return []
    if count == 1:
        twist = turns[:, 0]
        lead = 2.0 * np.pi * frame.length * _lead(twist)
        # along a slide it may be anywhere
        place = frame.centre + frame.length * cross(twist[:3], twist[3:]) / (twist[:3] @ twist[:3])
        through = "" if slides.shape[1] > 1 else f" through {_point(place)}"
        if abs(lead) > 1e-6 * frame.length and np.linalg.norm(slides[3:].T @ canonical(twist[:3])) < 1.0 - EXACT:
            return [f"screws about {_vector(twist[:3])}{through}, {1e3 * lead:.4g} mm a turn"]
        return [f"turns about {_vector(twist[:3])}{through}"]
    centre = _centre(turns) if not slides.shape[1] else None
    about = "" if centre is None else f" through {_point(frame.centre + frame.length * centre)}"
    if count == 3:
        return [f"turns every way{about}"]
    axes = _tidy(turns[:3])
    words = " and ".join(_vector(axis) for axis in axes.T)
    return [f"turns about {words}{about}" + (", as a universal joint does" if centre is not None else "")]


def _centre(turns: Array) -> Array | None:
    """The point, in lengths from the centre of the frame, that rests under all turns; None where there is none."""
    rows = [np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]) for w in turns[:3].T]
    matrix, right = np.vstack(rows), -turns[3:].T.ravel()
    centre, *_ = np.linalg.lstsq(matrix, right, rcond=None)
    return None if float(np.abs(matrix @ centre - right).max()) > 10.0 * EXACT else np.asarray(centre)


def _tidy(directions: Array) -> Array:
    """Perpendicular unit vectors (3, k) of the same span: of a plane, the first one across the coordinate axis that
    is nearest to its normal's smallest component."""
    if directions.shape[1] == 2:
        left = np.linalg.svd(directions)[0]
        return np.array(perpendicular(canonical(left[:, 2]))).T
    return np.linalg.qr(directions)[0] if directions.shape[1] else directions


def _vector(direction: Array) -> str:
    unit = canonical(direction)
    return "(" + ", ".join(f"{x:.3g}" for x in np.where(np.abs(unit) < 5e-4, 0.0, unit)) + ")"


def _point(place: Array) -> str:
    size = max(float(np.abs(place).max()), 1e-300)
    return "(" + ", ".join(f"{1e3 * x:.4g}" for x in np.where(np.abs(place) < 1e-6 * size, 0.0, place)) + ") mm"
