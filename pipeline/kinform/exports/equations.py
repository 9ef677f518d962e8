"""What formats of equations have in common (Modelica, VHDL-AMS): which equations of the loops are independent, which
coordinates they leave, what drives and holds them, and laws as polynomials.

Redundant loops have dependent equations, which solvers of equations reject. A joint that closes a loop
ends in a frame that must coincide with its second body: six rows, in axes of that frame that follow the
joint's axis, so that what is redundant at the start (all that leaves the plane of a planar linkage) stays
redundant. Rows are taken greedily, the best supported first, until there are as many as the rank that the
simulation uses. The coordinates that are left free are chosen so that they stay good along our run.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field, fields, replace

import numpy as np

from kinform.behaviour import Actor, Gear, JointComponent, MotionDrive, RigidBody, smooth
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Spline, Table
from kinform.exports.free_columns import CLOSE_CHOICE, free_columns
from kinform.exports.model import ExportModel
from kinform.exports.motors import left_out
from kinform.exports.tree import Closing, Tree, grow
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.rank import rank_of
from kinform.model.arrays import Array, Ints


@dataclass(frozen=True, eq=False)
class Closure:
    """The frame at the end of a closing joint must coincide with the second body in the rows that are held."""

    joint: JointComponent
    a: int
    """Link of the tree that the joint starts from."""
    b: int
    """Link that it ends at."""
    point: Array
    """(3,) m, world at the pose of the meshes."""
    axes: Array
    """(3, 3) columns: the axes of the rows, at the pose of the meshes."""
    place: tuple[bool, bool, bool]
    """Which displacements along the axes are held."""
    turn: tuple[bool, bool, bool]
    """Which turns about the axes are held."""


@dataclass(frozen=True, eq=False)
class Equations:
    """A model as its equations: the tree of its links, what closes the loops, and which rates nothing else
    determines."""

    model: ExportModel
    tree: Tree
    closures: tuple[Closure, ...]
    """In the order of the tree's closing joints."""
    gears: tuple[Gear, ...]
    """Those that are not redundant with the loops."""
    free: frozenset[int]
    """Indices of rates that drives and loops leave free."""
    led: frozenset[int]
    """Indices of rates that drives prescribe."""
    held: frozenset[int]
    """Indices of free rates that the equations hold, because our run is one without forces."""
    lost: list[str] = field(default_factory=list)
    """What the equations do not carry, in sentences."""
    remarks: list[str] = field(default_factory=list)
    """Choices that were made, in sentences."""

    def actors(self, joint: JointComponent) -> Iterator[Actor]:
        """What acts on a joint, tables of motions smoothed where bodies with mass have to follow; one motion at
        most."""
        led = set()
        for actor in self.model.system.actors(joint.name):
            if joint.kind.name == "spherical":
                continue
            if not isinstance(actor, MotionDrive):
                yield actor
            elif actor.freedom not in led:
                led.add(actor.freedom)
                followed = smooth(actor.signal, self.model.duration) if self.model.with_forces else actor.signal
                yield replace(actor, signal=followed)

    def rates_of(self, joint: JointComponent) -> range:
        """Indices of the rates of a joint."""
        (slot,) = (s for s in self.model.mechanism.slots if s.name == joint.subject)
        return range(slot.v.start, slot.v.stop)


def equations_of(model: ExportModel) -> Equations:
    """The independent equations of a model, and what is to be said of them."""
    tree = grow(model.system)
    closures, gears, free, led = _independent_equations(model, tree)
    lost, remarks = [*model.lost, *model.dry, *_singular(model)], [*model.taken, *model.teeth]
    held = _held_rates(model, free, lost, remarks)
    closed = {closure.joint.subject for closure in closures}
    lost += [
        f"{closing.joint.subject}: it closes a loop that is not connected with the ground"
        for closing in tree.closing
        if not closing.rigid and closing.joint.subject not in closed
    ]
    for joint in model.system.joints:
        actors = model.system.actors(joint.name)
        if joint.kind.name == "spherical":
            lost += [f"{actor.subject}: what acts about one direction of the ball {joint.subject}" for actor in actors]
        lost += [said for actor in actors for said in left_out(model.system, actor)]
        motions = [actor for actor in actors if isinstance(actor, MotionDrive)]
        lost += [
            f"{actor.subject}: a second drive prescribes the motion of {joint.subject}"
            for k, actor in enumerate(motions)
            if actor.freedom in [other.freedom for other in motions[:k]]
        ]
    remarks += [f"{gear.subject}: it is redundant with the loops" for gear in model.system.gears if gear not in gears]
    if model.ranges:
        remarks.append("joints do not stop at the ends of their ranges, as in our simulation")
    if closures:
        remarks.append("redundant constraints of loops are left out: closures hold independent directions only")
    return Equations(model, tree, closures, gears, free, led, held, lost, remarks)


def inertia_of(body: RigidBody) -> tuple[float, Array, Array]:
    """Mass (kg), centre of mass (3,) m and inertia (3, 3) kg·m²; zeros where the mass is not known."""
    if body.mass is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    return body.mass, body.centre_of_mass, body.inertia


def law_numbers(signal: Signal) -> tuple[str, dict[str, float]]:
    """The law of a signal that is no table (constant, ramp, sine), and its numbers by name."""
    assert isinstance(signal, Constant | Ramp | Sine)
    numbers = {entry.name: getattr(signal, entry.name) for entry in fields(signal) if entry.name != "knots"}
    return type(signal).__name__.lower(), numbers


def polynomials(signal: Table | Spline) -> list[tuple[float, float, list[float]]]:
    """(end, start, coefficients from the constant up, in time − start) of each stretch; held before and after."""
    knots = signal.knots
    out = [(knots[0], knots[0], [signal.value(knots[0])])]
    for k, (left, right) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if isinstance(signal, Table):
            out.append((right, left, [signal.levels[k], signal.rate(left)]))
        else:
            out.append((right, left, signal.coefficients(k)))
    out.append((np.inf, knots[-1], [signal.value(knots[-1])]))
    return out


def _independent_equations(
    model: ExportModel, tree: Tree
) -> tuple[tuple[Closure, ...], tuple[Gear, ...], frozenset[int], frozenset[int]]:
    """Closures with the rows that are held, gears that are held, rates that stay free, and those that drives lead.

    `tree` must be that of our simulation.
    """
    mechanism = model.mechanism
    closings = [c for c in tree.closing if not c.rigid and _is_grounded(tree, c.a)]
    led = frozenset(
        slot.v.start + actor.freedom
        for slot, joint in zip(mechanism.slots, model.system.joints, strict=True)
        for actor in model.system.actors(joint.name)
        if isinstance(actor, MotionDrive)
    )
    rest = np.array([k for k in range(mechanism.rates) if k not in led], dtype=np.int64)
    frames = [_axes(closing) for closing in closings]
    scale = mechanism.scale[rest]
    rows = _rows(model, closings, frames, model.q)[:, rest] * scale
    rank = rank_of(
        mechanism.closure(mechanism.screws(mechanism.poses(model.q)))[:, rest], scale, model.assembly.tolerances.free
    )
    # Gears come last among the rows and first among the choices: they are stated, loops are not.
    first_gear = len(rows) - len(mechanism.gear_v)
    order = [*range(first_gear, len(rows)), *range(first_gear)]
    held = {order[k] for k in _independent_rows(rows[order], rank)}
    closures = []
    for n, (closing, axes) in enumerate(zip(closings, frames, strict=True)):
        place, turn = (tuple(6 * n + side + k in held for k in range(3)) for side in (3, 0))
        point = closing.joint.geometry.point
        closures.append(
            Closure(
                closing.joint, closing.a, closing.b, mechanism.centre if point is None else point, axes,
                (place[0], place[1], place[2]), (turn[0], turn[1], turn[2]),
            )
        )  # fmt: skip
    gears = tuple(gear for k, gear in enumerate(model.system.gears, start=first_gear) if k in held)
    free = rest[_free_columns(model, closings, frames, rest, sorted(held))]
    return tuple(closures), gears, frozenset(free.tolist()), led


def _held_rates(model: ExportModel, free: frozenset[int], lost: list[str], remarks: list[str]) -> frozenset[int]:
    """Rates that the equations hold, because our run is one without forces; what that run did otherwise is added."""
    run = model.simulation
    if model.with_forces or run is None or not free:
        return frozenset()
    remarks.append("our run is one without forces: joints that nothing prescribes are held where they start")
    columns = dict(zip(run.joint_names, run.joint_offset, strict=False))
    for slot in model.mechanism.slots:
        held = [k for k in range(slot.v.stop - slot.v.start) if slot.v.start + k in free]
        if held and slot.has_ball:
            lost.append(f"{slot.name}: in our run it rests, here its spherical joint swings")
        elif any(np.ptp(run.joint_position[:, int(columns[slot.name]) + k]) > SOLVED for k in held):
            lost.append(
                f"{slot.name}: nothing prescribes it; in our run it moves no more than it must, here it is held"
            )
    return free


def _singular(model: ExportModel) -> tuple[str, ...]:
    """A sentence where the start is a singular pose: what is redundant there is not so along our run."""
    run = model.simulation
    if model.refused:
        return (f"a motion to compare with: ours was refused, as {model.refused}",)
    if run is None or not len(run.rank) or run.rank.max() <= run.rank[0]:
        return ()
    return (
        f"the loops away from the start: {run.rank[0]} of their equations are independent there, {run.rank.max()} "
        "later in our run, and only the former are held; it starts in a singular pose",
    )


def _is_grounded(tree: Tree, link: int) -> bool:
    """Whether the tree carries the link from the ground on."""
    while tree.links[link].parent >= 0:
        link = tree.links[link].parent
    return link == 0


def _axes(closing: Closing) -> Array:
    """(3, 3) columns: two directions across the joint's axis and the axis; the world's where it has none."""
    axis = closing.joint.geometry.axis
    if axis is None:
        return np.eye(3)
    u, v = perpendicular(np.asarray(axis))
    return np.column_stack([u, v, axis])


def _rows(model: ExportModel, closings: list[Closing], frames: list[Array], q: Array) -> Array:
    """(6C + G, n) turns about and displacements (over length) along the axes, at the points, by the rates."""
    mechanism = model.mechanism
    X = mechanism.poses(q)
    rows = mechanism.closure(mechanism.screws(X))
    out = rows.copy()
    for n, (closing, axes) in enumerate(zip(closings, frames, strict=True)):
        end = X[mechanism.closures[n, 0]]
        point = closing.joint.geometry.point
        arm = end[:3, :3] @ (np.zeros(3) if point is None else point - mechanism.centre) + end[:3, 3]
        E = (end[:3, :3] @ axes).T
        turning, moving = rows[6 * n : 6 * n + 3], rows[6 * n + 3 : 6 * n + 6]
        out[6 * n : 6 * n + 3] = E @ turning
        out[6 * n + 3 : 6 * n + 6] = E @ (moving + np.cross(turning.T, arm / mechanism.length).T)
    return out


def _independent_rows(rows: Array, rank: int) -> list[int]:
    """Indices of `rank` independent rows."""
    rest, size, chosen = rows.copy(), np.linalg.norm(rows, axis=1), []
    for _ in range(rank):
        k = int(np.flatnonzero(size >= CLOSE_CHOICE * size.max())[0])
        chosen.append(k)
        unit = rest[k] / size[k]
        share = rest @ unit
        # rows of other loops have no share
        left = np.flatnonzero(share)
        rest[left] -= np.outer(share[left], unit)
        rest[k] = 0.0
        size[left] = np.linalg.norm(rest[left], axis=1)
    return chosen


def _free_columns(
    model: ExportModel, closings: list[Closing], frames: list[Array], rest: Ints, held: list[int]
) -> list[int]:
    """Indices into `rest` of coordinates that determine the others all along our run."""
    mechanism = model.mechanism
    scale = mechanism.scale[rest]
    poses = _poses_of_run(model) if held else [model.q]
    every = [_rows(model, closings, frames, q)[held][:, rest] * scale for q in poses]
    return free_columns(every)


def _poses_of_run(model: ExportModel) -> list[Array]:
    """Coordinates along our run, the start first."""
    run, mechanism = model.simulation, model.mechanism
    if run is None or run.joint_names != tuple(slot.name for slot in mechanism.slots):
        return [model.q]
    # Poses of our run at which the free coordinates must be good: a turn is seen every 15°. Chosen, not measured.
    picked = np.unique(np.linspace(0, len(run.time) - 1, 24).round().astype(np.int64))
    return [model.q, *run.joint_position[picked]]
