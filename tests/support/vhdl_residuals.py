"""What is left of the statements of a VHDL-AMS model that was read.

Every simultaneous statement is evaluated on jets. Known are the potentials of the nodes, orientations and joint
coordinates; quantities that a statement defines follow from it; through quantities and efforts are what makes the
statements hold, if anything does: they enter linearly and are solved for together.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lstsq

from support.vhdl_expressions import Evaluator, names_in, parse
from support.vhdl_reader import SIZES


def chosen(statement, evaluate, values):
    """The simultaneous statements in a row: of an `if … use` the branch that holds.

    Raises LookupError as long as it is not known which does.
    """
    if not statement.startswith("if"):
        return [statement]
    for condition, body in re.findall(r"(?:if|elsif)\s+(.*?)\s+use\s+(.*?);", statement, re.S):
        if unknown := names_in(parse(re.sub(r"'above|<", "-", condition))) - {*values, "now"}:
            raise LookupError(unknown)
        if holds(condition, evaluate, values):
            return [body.strip()]
    return [re.search(r"else\s+(.*?);", statement, re.S)[1].strip()]


def holds(condition, evaluate, values):
    """A boolean generic, a comparison with `now`, or whether a quantity is above something."""
    if above := re.fullmatch(r"(\w+)'above\((.*)\)", condition, re.S):
        return float((evaluate(parse(above[1]), values) - evaluate(parse(above[2]), values)).d[0]) > 0.0
    if "<" not in condition:
        return values[condition.lower()] is True
    left, right = condition.split("<")
    return float(evaluate(parse(left), values).d[0]) < float(evaluate(parse(right), values).d[0])


def constant(text):
    """Value of a generic: true, false, upright, zero, a number, a vector."""
    named = {"true": True, "false": False, "upright": np.array([1.0, 0, 0, 0]), "zero": np.zeros(3), "unlimited": 1e300}
    if text in named:
        return named[text]
    numbers = [float(x) for x in text.strip("()").split(",")]
    return np.array(numbers) if text.startswith("(") else numbers[0]


@dataclass
class Residuals:
    """What is left of every statement at the best through quantities, and those."""

    worst: float
    where: str
    through: dict[str, float]
    equations: int
    unknowns: int
    freedoms: int
    """How many more equations there are than through quantities and efforts."""


def residuals(flat, potentials, quantities, now):
    """Residuals of all statements.

    potentials: jets of the nets (places, angular velocities, voltages); quantities: jets of orientations and
    joint coordinates by their net names, and of states by their own. Through quantities, their vectors and
    efforts are unknown.
    """
    evaluate = Evaluator(flat.functions, now)
    unknown = {}
    rows = []
    nodes = {}
    fixed = {"zero": np.zeros(3), "upright": np.array([1.0, 0, 0, 0]), "unlimited": 1e300}

    def symbol(name, size=1):
        if name not in unknown:
            start = sum(unknown.values())
            unknown[name] = size
            index[name] = slice(start, start + size)
        return index[name]

    index = {}
    contexts = []
    count = 0
    for path, entity, constants, ports in flat.leaves:
        values = {**fixed, **{name.lower(): constant(text) for name, text in constants.items()}}
        forces = {}
        for across, through, terminal in entity.branches:
            net = ports[terminal]
            if across:
                values[across] = potentials[net]
            nodes.setdefault(net, []).append(f"{path}{through}")
            if f"{path}{through}" in quantities:
                values[through] = quantities[f"{path}{through}"]
            else:
                forces[through] = symbol(f"{path}{through}")
        for port in (*entity.inputs, *entity.outputs):
            net = ports[port]
            if net in quantities:
                values[port] = quantities[net]
            else:
                forces[port] = symbol(net)
        own = {name: SIZES[kind] for name, kind in entity.quantities.items() if f"{path}{name}" not in quantities}
        values.update({n: quantities[f"{path}{n}"] for n in entity.quantities if n not in own})
        contexts.append((path, entity, values, forces, own))
        count += len(entity.branches)
        count += sum(SIZES[t] for t in entity.outputs.values()) + sum(SIZES[t] for t in entity.quantities.values())
    for path, entity, values, forces, own in contexts:
        _define(path, entity, values, forces, own, evaluate, symbol, rows)
    for path, statement, scope in flat.equations:
        forces = {name: symbol(net) for name, net in scope.items() if net in _nets(statement, scope)}
        rows.append((f"{path}{statement}", *[parse(side) for side in statement.split("==")], dict(fixed), forces))
        count += 1
    for net, through in nodes.items():
        given = sum(float(quantities[name].d[0]) for name in through if name in quantities)
        rows.append((f"node {net}", given, None, [name for name in through if name not in quantities], None))
    return _solve(rows, unknown, index, evaluate, count)


def _nets(statement, scope):
    return {scope[name] for name in re.findall(r"[a-z]\w*", statement) if name in scope}


def _define(path, entity, values, forces, own, evaluate, symbol, rows):
    """Evaluate quantities that statements define from what is known; the rest are unknown, or equations."""
    pending, waiting = [], list(entity.statements)
    progress = True
    while progress:
        progress = False
        for statement in list(waiting):
            try:
                texts = chosen(statement, evaluate, values)
            except LookupError:
                continue
            waiting.remove(statement)
            pending += [(text, *[parse(side) for side in text.split("==")]) for text in texts]
            progress = True
        for row in list(pending):
            text, left, right = row
            name = left[1] if left[0] == "name" else None
            if name in own and name not in values and names_in(right) <= {*values, *evaluate.functions, "sin", "now"}:
                values[name] = evaluate(right, values)
                size = 1 if values[name].d.ndim == 1 else values[name].d.shape[1]
                assert size == own[name], f"{path}{text}: sizes differ"
                rows.append((f"{path}{text}", left, right, values, {}))
                pending.remove(row)
                progress = True
    assert not waiting, f"{path}: it is not known which branch holds of {waiting}"
    for name, size in own.items():
        if name not in values:
            forces[name] = symbol(f"{path}{name}", size)
    for text, left, right in pending:
        rows.append((f"{path}{text}", left, right, values, forces))


def _solve(rows, unknown, index, evaluate, count):
    n = sum(unknown.values())
    matrix, rest, places = [], [], []
    equations = 0
    for where, left, right, values, forces in rows:
        if right is None:
            line = np.zeros(n)
            for name in values:
                line[index[name]] += 1.0
            matrix.append(line[None])
            rest.append(np.full(1, left))
            places.append(where)
            continue
        used = (names_in(left) | names_in(right)) & set(forces)

        def difference(point, left=left, right=right, values=values):
            both = {**values, **point}
            return np.atleast_1d((evaluate(left, both) - evaluate(right, both)).d[0])

        sizes = {name: forces[name].stop - forces[name].start for name in used}
        zero = {name: np.zeros(size) if size > 1 else 0.0 for name, size in sizes.items()}
        start = difference(zero)
        assert np.all(np.isfinite(start)), f"{where}: a derivative that is not known"
        lines = np.zeros((len(start), n))
        for name in used:
            for k in range(sizes[name]):
                unit = np.eye(sizes[name])[k] if sizes[name] > 1 else 1.0
                lines[:, forces[name].start + k] = difference({**zero, name: unit}) - start
        matrix.append(lines)
        rest.append(start)
        places += [where] * len(start)
        equations += len(start)
    A, b = np.concatenate(matrix), np.concatenate(rest)
    # Rows without unknowns say where things are and how they move; the others determine the through quantities,
    # and one more for each freedom says that the motion is the right one.
    acting = np.abs(A).max(axis=1) > 0.0
    through, _, rank, _ = lstsq(A[acting], -b[acting], lapack_driver="gelsy", cond=1e-12)
    assert rank == n, "the through quantities are not determined"
    # Once more with what is left: forces may be large.
    through -= lstsq(A[acting], (A @ through + b)[acting], lapack_driver="gelsy", cond=1e-12)[0]
    left = np.abs(A @ through + b)
    worst = int(left.argmax())
    solved = {name: through[index[name]] for name in unknown}
    return Residuals(float(left[worst]), places[worst], solved, equations, count, int(acting.sum()) - n)
