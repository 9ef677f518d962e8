"""The mechanism and what acts on it as the tables of the kernel; see `kernel.layout`."""

from __future__ import annotations

from functools import cache

import numpy as np

from kinform.behaviour.components import RigidBody, System
from kinform.behaviour.signals import STEADY, Constant, Ramp, Signal, Sine, Spline, Table
from kinform.foundation.algebra.vectors import perpendicular
from kinform.model.arrays import Array, Ints
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.tables import Tables
from kinform.simulation.mechanism.actuation import Actuation, Push
from kinform.simulation.mechanism.coefficients import NUMBERS
from kinform.simulation.mechanism.elastic import WIDTH
from kinform.simulation.mechanism.mechanism import Mechanism


def tabulate(mechanism: Mechanism, system: System, gravity: Array, actuation: Actuation, rank: int) -> Tables:
    """Tables of the mechanism under gravity (3,); `rank` of the loops for rates that are not led.

    Raises ValueError for a signal that is none of kinform's.
    """
    order = _Order(mechanism)
    signals = _Signals()
    columns, led = order.columns(), 0
    for v, signal in zip(actuation.led, actuation.signals, strict=True):
        columns[order.rate[v], layout.SIGNAL] = signals.add(signal)
        led += 1
    actors, actor_numbers = _actors(actuation, order, signals)
    for v, at in zip(actuation.metered, actuation.meters[0], strict=True):
        columns[order.rate[v], layout.METER] = at
    meters = 3 * sum(at >= 0 for at in (*actuation.meters[0], *actuation.meters[1]))
    states = actuation.controlled + meters
    loads, load_numbers = (
        _rows([(load.link, int(load.turning), _factor(load, signals)) for load in actuation.loads], 3),
        np.array([[*load.force, *load.torque, *load.point] for load in actuation.loads]).reshape(-1, 9),
    )
    springs = _rows([(s.first, s.second, s.kind) for s in actuation.springs], 3)
    spring_numbers = np.array([s.numbers for s in actuation.springs]).reshape(-1, WIDTH)
    stops = _rows([(order.place[s.q], order.rate[s.v], s.sense, 0) for s in actuation.stops], 4)
    closures = _rows([tuple(pair) for pair in mechanism.closures], 2)
    n, nq = mechanism.rates, mechanism.gear_q.shape[1]
    size = nq + n + states + 1
    count = 6 * len(closures) + len(mechanism.gear_v)
    width = max(n, count, nq, 2)
    massless = ~mechanism.moves[mechanism.link_of].any(axis=0) & (actuation.armature == 0.0)
    scale = np.column_stack([mechanism.scale, massless, actuation.armature])[order.v_order]
    gears = np.hstack([mechanism.gear_v[:, order.v_order], mechanism.gear_q[:, order.q_order]])
    values, pieces = signals.tables()
    mode = np.zeros((7, width), dtype=np.int64)
    mode[layout.ORDER, :n] = np.argsort(columns[:, layout.SIGNAL] >= 0, kind="stable")
    mode[layout.PLACE, :n] = np.argsort(mode[layout.ORDER, :n])
    numbers = np.array([[*gravity, mechanism.length, np.inf, 0.0, 0.0, 0.0]])
    ints = (
        np.array([[rank, led, nq, states, n, size, meters]]), order.links(), columns, closures, np.zeros((0, 1)),
        actors, loads, springs, mode, stops,
    )  # fmt: skip
    nums = (
        numbers, _links(mechanism, system, order), scale, _frames(mechanism), values, actor_numbers, load_numbers,
        spring_numbers, gears, np.array([[s.limit] for s in actuation.stops]).reshape(-1, 1), pieces, _coefficients(),
    )  # fmt: skip
    L = len(mechanism.parent)
    shapes = (
        (L, 40), (n, 6), (n, n), (max(count, 1), max(n, 1)), (n, n), (n, n), (10, width), (20, size), (7, size), (n, n),
        (L, layout.CARRIED_WIDTH), (n, layout.HANDLE_WIDTH),
    )  # fmt: skip
    work = tuple(np.zeros(shape) for shape in shapes)
    work[layout.STATE][0, [0, 4, 8]] = 1.0
    return Tables(
        tuple(np.ascontiguousarray(table, dtype=np.int64) for table in ints),
        tuple(np.ascontiguousarray(table, dtype=np.float64) for table in nums),
        work, order.q_order, order.v_order, states, meters,
    )  # fmt: skip


def _factor(load: Push, signals: _Signals) -> int:
    """The signal of a load; −1 for what does not change."""
    return -1 if load.signal == STEADY else signals.add(load.signal)


def _rows(rows: list[tuple[int, ...]], width: int) -> Ints:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


class _Order:
    """Links in their order, and coordinates in that of the links."""

    def __init__(self, mechanism: Mechanism):
        self.mechanism = mechanism
        self.v_order: Ints = np.argsort(mechanism.column_link, kind="stable")
        self.rate = np.argsort(self.v_order)
        """Kernel's number of each rate of the mechanism."""
        self._kinds = {
            int(link): (layout.SCREW, int(q)) for link, q in zip(mechanism.screw_link, mechanism.screw_q, strict=True)
        }
        self._kinds |= {b.link: (layout.BALL if b.forward else layout.LLAB, b.q) for b in mechanism.balls}
        q_order: list[int] = []
        for link in range(1, len(mechanism.parent)):
            kind, q = self._kinds[link]
            q_order.extend(range(q, q + (1 if kind == layout.SCREW else 4)))
        self.q_order: Ints = np.array(q_order, dtype=np.int64)
        self.place = np.argsort(self.q_order)

    def links(self) -> Ints:
        """Rows of ints[LINKS]."""
        out = np.zeros((len(self.mechanism.parent), 7), dtype=np.int64)
        carried = self.mechanism.column_link[self.v_order]
        heavy = set(self.mechanism.link_of.tolist())
        tip = {0: -1}
        for link in range(len(out)):
            own = np.flatnonzero(carried == link)
            parent = max(int(self.mechanism.parent[link]), 0)
            if link:
                kind, q = self._kinds[link]
                tip[link] = int(own[-1])
                out[link] = parent, kind, self.place[q], own[0], len(own), link in heavy, tip[link]
            else:
                out[link] = 0, layout.SCREW, 0, 0, 0, 0, -1
        return out

    def columns(self) -> Ints:
        """Rows of ints[COLUMNS], nothing led."""
        links = self.links()
        out = np.full((len(self.v_order), layout.METER + 1), -1, dtype=np.int64)
        for link in range(1, len(links)):
            first, width = links[link, layout.FIRST], links[link, layout.WIDTH]
            before = links[links[link, layout.PARENT], layout.TIP]
            for k in range(first, first + width):
                out[k, :2] = link, before
                before = k
        return out


def _links(mechanism: Mechanism, system: System, order: _Order) -> Array:
    """Rows of nums[LINKS]: primitives, and the bodies on each link as one."""
    out = np.zeros((len(mechanism.parent), 25))
    for link, terms in zip(mechanism.screw_link, mechanism.screw_primitives, strict=True):
        out[link, :9] = [*terms.omega, *terms.point, *terms.slide]
    for ball in mechanism.balls:
        out[ball.link, layout.POINT : layout.POINT + 3] = ball.point
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    carried: dict[int, list[RigidBody]] = {}
    for body in system.bodies:
        if isinstance(body, RigidBody) and link_of[body.subject] > 0:
            carried.setdefault(int(link_of[body.subject]), []).append(body)
    for link, bodies in carried.items():
        mass = sum(b.mass or 0.0 for b in bodies)
        points = np.array([b.centre_of_mass for b in bodies]) - mechanism.centre
        weights = np.array([b.mass for b in bodies])
        centre = weights @ points / mass if mass > 0.0 else points.mean(axis=0)
        tensor = np.zeros((3, 3))
        for body, arm in zip(bodies, points - centre, strict=True):
            tensor += body.inertia + (body.mass or 0.0) * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        # As moments of mass: tensor = Σ d (1 − u uᵀ), d = half the trace less the principal moment.
        moments, axes = np.linalg.eigh(tensor)
        seconds = 0.5 * moments.sum() - moments
        out[link, layout.WEIGHT] = mass
        out[link, layout.COM : layout.COM + 3] = centre
        out[link, layout.TENSOR :] = np.column_stack([seconds, axes.T]).ravel()
    return out


def _frames(mechanism: Mechanism) -> Array:
    """Rows of nums[CLOSURES]: three axes and a point that the tip of a loop carries, at the zero pose."""
    screws = dict(zip(mechanism.screw_link.tolist(), mechanism.screw_primitives, strict=True))
    points = {ball.link: ball.point for ball in mechanism.balls}
    out = np.zeros((len(mechanism.closures), 12))
    for row, (tip, _) in zip(out, mechanism.closures, strict=True):
        if int(tip) in screws:
            primitive = screws[int(tip)]
            axis = primitive.omega if primitive.omega.any() else primitive.slide
            axis = axis / np.linalg.norm(axis)
            row[:9] = np.concatenate([*perpendicular(axis), axis])
            row[9:] = primitive.point
        else:
            row[:9] = np.eye(3).ravel()
            row[9:] = points.get(int(tip), np.zeros(3))
    return out


class _Signals:
    """Signals as they are met."""

    def __init__(self) -> None:
        self._values: list[tuple[float, ...]] = []
        self._pieces: list[tuple[float, ...]] = []

    def add(self, signal: Signal) -> int:
        """Number of the signal."""
        kind, values, first = layout.STRAIGHT, (0.0, 0.0, 0.0, 0.0), len(self._pieces)
        if isinstance(signal, Constant):
            values = (signal.level, 0.0, 0.0, 0.0)
        elif isinstance(signal, Ramp):
            values = (signal.offset, signal.slope, 0.0, 0.0)
        elif isinstance(signal, Sine):
            kind, values = layout.WAVE, (signal.offset, signal.amplitude, signal.speed, signal.phase)
        elif isinstance(signal, Table | Spline):
            kind = layout.CURVE
            self._pieces.extend(_pieces(signal))
        else:
            raise ValueError(f"a signal of the kind {type(signal).__name__} cannot be simulated")
        self._values.append((*values, kind, first, len(self._pieces) - first))
        return len(self._values) - 1

    def tables(self) -> tuple[Array, Array]:
        """nums[SIGNALS] and nums[PIECES]."""
        values = np.array(self._values, dtype=np.float64).reshape(-1, 7)
        return values, np.array(self._pieces, dtype=np.float64).reshape(-1, 5)


def _pieces(signal: Table | Spline) -> list[tuple[float, ...]]:
    """(start, cubic) of each piece; constant before the first knot and after the last."""
    times = signal.knots
    ends = signal.value(times[0]), signal.value(times[-1])
    inner: list[tuple[float, ...]]
    if isinstance(signal, Spline):
        inner = [(t, *(float(c) for c in cubic)) for t, cubic in zip(times, signal.curve.c.T, strict=False)]
    else:
        inner = [(t, 0.0, 0.0, signal.rate(t), level) for t, level in zip(times[:-1], signal.levels, strict=False)]
    return [(times[0] - 1.0, 0.0, 0.0, 0.0, ends[0]), *inner, (times[-1], 0.0, 0.0, 0.0, ends[1])]


def _actors(actuation: Actuation, order: _Order, signals: _Signals) -> tuple[Ints, Array]:
    """Rows of ints[ACTORS] and nums[ACTORS]."""
    first = actuation.first_state
    rows, numbers, states = [], [], 0
    for actor, meter in zip(actuation.actors, actuation.meters[1], strict=True):
        own = []
        for wanted in actor.states:
            own.append(first + states if wanted else -1)
            states += int(wanted)
        law = -1 if actor.signal is None else signals.add(actor.signal)
        rows.append((actor.does, int(order.place[actor.q]), int(order.rate[actor.v]), law, *own, meter))
        numbers.append([*actor.numbers, *(0.0,) * (10 - len(actor.numbers))])
    return _rows(rows, 7), np.array(numbers, dtype=np.float64).reshape(-1, 10)


@cache
def _coefficients() -> Array:
    """nums[COEFFICIENTS]."""
    out = np.zeros((25, 16))
    for row, numbers in zip(out, NUMBERS, strict=False):
        row[list(numbers)] = list(numbers.values())
    out[layout.ORDER_ROW, :12] = np.argsort(out[layout.C_ROW, :12], kind="stable")
    out.setflags(write=False)
    return out
