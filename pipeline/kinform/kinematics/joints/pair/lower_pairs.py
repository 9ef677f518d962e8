"""Names a space of relative motions: which lower pair it is, with its axis, point and pitch.

The lower pairs are the Lie subgroups that surfaces allow; a basis of the twist space is enough to
tell them (Hervé 1978; Gelfand and Guibas 2004). Anything else is `general`.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.screws import Frame, rotation, translation
from kinform.foundation.algebra.vectors import canonical, cross, cross_matrix, norm, perpendicular
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.kinematics import JointType

NEAR_PAIR = 0.02
"""Spaces pieced together from patches that agree within their tolerances are off a lower pair by this much. Chosen, not
measured."""


@dataclass(frozen=True, eq=False)
class JointForm:
    """Type of a joint with its geometry in the world; None where the type has none."""

    type: JointType
    axis: Array | None = None
    point: Array | None = None
    pitch: float | None = None
    """m a turn."""
    axis2: Array | None = None
    """Of a universal joint: its axis in the second body."""


def name_space(basis: Array, frame: Frame) -> JointForm:
    """The joint whose freedoms are the columns of `basis` (6, k), scaled twists in `frame`."""
    freedoms = basis.shape[1]
    if freedoms == 0:
        return JointForm("fixed")
    if freedoms == 1:
        return _one_freedom(basis[:, 0], frame)
    _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
    turns = int(np.count_nonzero(values > SINGLE))
    mixed = basis @ right.T
    if turns == 1:
        return _one_turn(mixed[:, 0], mixed[3:, turns:], frame)
    centre = _centre(basis, frame, 10.0 * SINGLE) if turns == 3 and freedoms == 3 else None
    return JointForm("general") if centre is None else JointForm("spherical", None, centre)


def nearest_pair(basis: Array, frame: Frame) -> Array | None:
    """Orthonormal basis (6, k) of the lower pair that the space (6, k) nearly is; None if there is none.

    Motions found patch by patch do not quite form a group: their directions differ by what the patches
    tolerate. Whether the patches preserve the lower pair is for the caller to test.
    """
    freedoms = basis.shape[1]
    if freedoms == 0:
        return None
    _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
    turns = int(np.count_nonzero(values > NEAR_PAIR))
    mixed = basis @ right.T
    if freedoms == 3 and turns == 3:
        centre = _centre(basis, frame, NEAR_PAIR)
        return None if centre is None else _orthonormal([rotation(e, centre, frame) for e in np.eye(3)])
    slides = mixed[3:, turns:]
    if turns == 0 or turns > 1:
        return None
    axis, point, lead = _axis_of(mixed[:, 0], frame)
    if freedoms == 1:
        return _orthonormal([rotation(axis, point, frame)]) if abs(lead) < NEAR_PAIR * frame.length else None
    if freedoms == 2 and norm(cross(axis, slides[:, 0])) < NEAR_PAIR:
        return _orthonormal([rotation(axis, point, frame), translation(axis)])
    if freedoms == 3 and norm(axis @ slides) < NEAR_PAIR:
        normal = cross(slides[:, 0], slides[:, 1])
        normal /= norm(normal)
        u, v = perpendicular(normal)
        return _orthonormal([rotation(normal, frame.centre, frame), translation(u), translation(v)])
    return None


def _orthonormal(twists: list[Array]) -> Array:
    basis: Array = np.linalg.qr(np.array(twists).T)[0]
    return basis


def _axis_of(twist: Array, frame: Frame) -> tuple[Array, Array, float]:
    """Unit axis, its point nearest to the centre (m), and the slide per turn (m a radian)."""
    omega, velocity = twist[:3] / frame.length, twist[3:]
    square = float(omega @ omega)
    point = frame.centre + cross(omega, velocity) / square
    return omega / math.sqrt(square), point, float(omega @ velocity) / square


def _one_freedom(twist: Array, frame: Frame) -> JointForm:
    if norm(twist[:3]) <= SINGLE:
        return JointForm("prismatic", canonical(twist[3:]), frame.centre)
    axis, point, lead = _axis_of(twist, frame)
    if abs(lead) < SINGLE * frame.length:
        return JointForm("revolute", canonical(axis), point)
    return JointForm("screw", canonical(axis), point, 2.0 * math.pi * lead)


def _one_turn(turn: Array, slides: Array, frame: Frame) -> JointForm:
    axis = turn[:3] / norm(turn[:3])
    along = norm(axis @ slides)
    if slides.shape[1] == 1 and along > 1.0 - SINGLE:
        _, point, _ = _axis_of(turn, frame)
        return JointForm("cylindrical", canonical(axis), point)
    if slides.shape[1] == 2 and along < SINGLE:
        return JointForm("planar", canonical(axis), frame.centre)
    return JointForm("general")


def _centre(basis: Array, frame: Frame, tolerance: float) -> Array | None:
    """The point o (m) that rests under all three turns, v = ω × (c − o), or None if they miss it by more than
    `tolerance`."""
    matrix, right = cross_matrix(basis[:3].T).reshape(9, 3), basis[3:].T.ravel()
    offset, *_ = np.linalg.lstsq(matrix, right, rcond=None)
    if float(np.abs(matrix @ offset - right).max()) > tolerance:
        return None
    centre: Array = frame.centre - frame.length * offset
    return centre
