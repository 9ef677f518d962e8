"""Reads the VHDL-AMS that kinform writes, as a tool would: entities, ports, generics, statements.

Every simultaneous statement is evaluated on jets (a value with its first and second derivative in time), so
that 'dot is exact. Known are the potentials of the nodes, orientations and joint coordinates; quantities
that a statement defines follow from it; through quantities and efforts are what makes the statements hold,
if anything does: they enter linearly and are solved for together.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from scipy.linalg import lstsq

TOKEN = re.compile(r"\s*(\d[\d.]*(?:e[+-]?\d+)?|[a-z]\w*|'dot|'range|\*\*|=>|==|<=|>=|:=|[-+*/(),<>])", re.IGNORECASE)


class Jet:
    """A number or vector with two derivatives in time: (3,) or (3, n)."""

    def __init__(self, d):
        self.d = np.asarray(d, dtype=float)

    @staticmethod
    def of(x):
        if isinstance(x, Jet):
            return x
        x = np.asarray(x, dtype=float)
        return Jet(np.stack([x, np.zeros_like(x), np.zeros_like(x)]))

    def __add__(self, other):
        other = Jet.of(other)
        assert self.d.shape == other.d.shape, "a sum of vectors of different length"
        return Jet(self.d + other.d)

    def __neg__(self):
        return Jet(-self.d)

    def __sub__(self, other):
        return self + (-Jet.of(other))

    def __mul__(self, other):
        a, b = self.d, Jet.of(other).d
        if a.ndim < b.ndim:
            a = a[:, None]
        elif b.ndim < a.ndim:
            b = b[:, None]
        else:
            assert a.ndim == 1, "a product of two vectors"
        return Jet(np.stack([a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]]))

    def __getitem__(self, k):
        return Jet(self.d[:, k])

    def dot(self):
        """The derivative; its second one is not known, and must not be used."""
        return Jet(np.stack([self.d[1], self.d[2], np.full_like(self.d[2], np.nan)]))

    def sin(self):
        s, c = math.sin(self.d[0]), math.cos(self.d[0])
        return Jet([s, c * self.d[1], c * self.d[2] - s * self.d[1] ** 2])


@dataclass
class Entity:
    """An entity with its architecture."""

    name: str
    generics: dict[str, str | None] = field(default_factory=dict)
    inputs: list[str] = field(default_factory=list)
    outputs: dict[str, str] = field(default_factory=dict)
    terminals: dict[str, str] = field(default_factory=dict)
    branches: list[tuple[str | None, str, str]] = field(default_factory=list)
    """(across, through, terminal)."""
    quantities: dict[str, str] = field(default_factory=dict)
    inner: dict[str, str] = field(default_factory=dict)
    """Terminals declared inside."""
    parts: list[tuple[str, str, dict[str, str], dict[str, str]]] = field(default_factory=list)
    """(label, entity, generic map, port map)."""
    statements: list[str] = field(default_factory=list)
    breaks: list[str] = field(default_factory=list)
    stated: int | None = None
    """Equations that the comment above it states."""


SIZES = {"real": 1, "vector3": 3, "quaternion": 4}


def read(texts):
    """(entities by name, functions by name) of files in order."""
    entities, functions = {}, {}
    for text in texts:
        for name, arguments, body in re.findall(
            r"function (\w+) \(([^)]*)\) return \w+ is\s*begin\s*return (.*?);\s*end function", text, re.S
        ):
            names = [n.strip() for group in arguments.split(";") for n in group.split(":")[0].split(",")]
            functions[name] = names, " ".join(body.split())
        for name, body in re.findall(r"entity (\w+) is\n(.*?)end entity;", text, re.S):
            entity = entities[name] = Entity(name)
            above = text[: text.index(f"entity {name} is\n")].rsplit("end architecture;", 1)[-1]
            counted = re.search(r"-- (\d+) equations? for (\d+) unknowns?\n", above)
            if counted:
                assert counted[1] == counted[2]
                entity.stated = int(counted[1])
            _interface(entity, re.sub(r"--.*", "", body))
            architecture = re.search(rf"architecture \w+ of {name} is\n(.*?)end architecture;", text, re.S)
            _architecture(entity, re.sub(r"--.*", "", architecture[1]))
    return entities, functions


def _interface(entity, body):
    generics = re.search(r"generic \((.*?)\n  \);", body, re.S)
    for row in generics[1].split(";") if generics else []:
        names, rest = row.split(":", 1)
        default = rest.split(":=")[1].strip() if ":=" in rest else None
        entity.generics.update({name.strip(): default for name in names.split(",")})
    ports = re.search(r"port \((.*?)\n  \);", body, re.S)
    for row in ports[1].split(";") if ports else []:
        kind, names, rest = re.fullmatch(r"\s*(terminal|quantity) ([^:]+):(.*)", row, re.S).groups()
        for name in (n.strip() for n in names.split(",")):
            if kind == "terminal":
                entity.terminals[name] = rest.strip()
            elif rest.split()[0] == "in":
                entity.inputs.append(name)
            else:
                entity.outputs[name] = rest.split()[1]


def _architecture(entity, body):
    declared, statements = body.split("begin\n", 1)
    for row in (row.strip() for row in declared.split(";") if row.strip()):
        branch = re.fullmatch(r"quantity (?:(\w+) across )?(\w+) through (\w+) to \w+_ref", row)
        if branch:
            entity.branches.append(branch.groups())
            continue
        kind, names, type = re.fullmatch(r"(terminal|quantity) ([^:]+) : (\w+)", row, re.S).groups()
        into = entity.inner if kind == "terminal" else entity.quantities
        into.update({name.strip(): type for name in names.split(",")})
    for row in _rows(statements):
        part = re.fullmatch(r"(\w+) : entity work\.(\w+)(.*)", row, re.S)
        if part:
            generics, _, ports = part[3].partition("port map")
            entity.parts.append((part[1], part[2], _map(generics), _map(ports)))
        elif row.startswith("break"):
            entity.breaks.append(row)
        else:
            entity.statements.append(row)


def _rows(text):
    """Statements; an `if … use` is one."""
    rows, depth, row = [], 0, ""
    for piece in text.split(";"):
        row += piece
        depth += len(re.findall(r"\bif\b(?!.*\bend\b)", piece)) - len(re.findall(r"\bend use\b", piece))
        if depth > 0:
            row += ";"
            continue
        if row.strip():
            rows.append(row.strip())
        row = ""
    return rows


def _map(text):
    """Formals and actuals of a map in parentheses."""
    if "(" not in text:
        return {}
    out, depth, row = {}, 0, ""
    for c in text[text.index("(") + 1 : text.rindex(")")] + ",":
        depth += (c == "(") - (c == ")")
        if c == "," and depth == 0:
            formal, actual = row.split("=>")
            out[formal.strip()] = actual.strip()
            row = ""
        else:
            row += c
    return out


class Parser:
    """A recursive descent over expressions: sums, products, signs, calls, indices, aggregates."""

    def __init__(self, text):
        self.tokens, at = [], 0
        text = text.rstrip()
        while at < len(text):
            found = TOKEN.match(text, at)
            assert found, f"cannot read {text[at:]!r}"
            self.tokens.append(found[1].lower())
            at = found.end()
        self.at = 0

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else None

    def take(self, expected=None):
        token = self.peek()
        assert expected is None or token == expected, f"expected {expected}, found {token}"
        self.at += 1
        return token

    def sum(self):
        sign = self.take() if self.peek() in ("-", "+") else "+"
        left = self.product()
        if sign == "-":
            left = ("neg", left)
        while self.peek() in ("+", "-"):
            left = (self.take(), left, self.product())
        return left

    def product(self):
        left = self.factor()
        while self.peek() == "*":
            left = (self.take(), left, self.factor())
        return left

    def factor(self):
        token = self.take()
        if token == "-":
            return ("neg", self.factor())
        if token == "(":
            rows = [self.sum()]
            while self.peek() == ",":
                self.take()
                rows.append(self.sum())
            self.take(")")
            return self.after(rows[0] if len(rows) == 1 else ("vector", *rows))
        if token[0].isdigit():
            assert "." in token or token.isdigit()
            return ("number", float(token))
        return self.after(("name", token))

    def after(self, value):
        while self.peek() in ("(", "'dot"):
            if self.take() == "'dot":
                value = ("dot", value)
                continue
            rows = [self.sum()]
            while self.peek() == ",":
                self.take()
                rows.append(self.sum())
            self.take(")")
            value = ("call", value[1], *rows)
        return value


@cache
def parse(text):
    """The tree of an expression."""
    parser = Parser(text)
    out = parser.sum()
    assert parser.peek() is None, f"left over: {parser.tokens[parser.at :]}"
    return out


class Evaluator:
    """Evaluates trees; `values` has names of this place, in lower case."""

    def __init__(self, functions, now):
        self.functions = {name: (names, parse(body)) for name, (names, body) in functions.items()}
        self.now = now

    def __call__(self, tree, values):
        kind = tree[0]
        if kind == "number":
            return Jet.of(tree[1])
        if kind == "name":
            if tree[1] == "now":
                return Jet([self.now, 1.0, 0.0])
            return Jet.of(values[tree[1]])
        if kind == "neg":
            return -self(tree[1], values)
        if kind == "dot":
            return self(tree[1], values).dot()
        if kind == "vector":
            return Jet(np.stack([self(row, values).d for row in tree[1:]], axis=1))
        if kind == "call":
            arguments = [self(row, values) for row in tree[2:]]
            if tree[1] in values:
                return Jet.of(values[tree[1]])[int(arguments[0].d[0])]
            if tree[1] == "sin":
                return arguments[0].sin()
            names, body = self.functions[tree[1]]
            return self(body, dict(zip(names, arguments, strict=True)))
        left, right = self(tree[1], values), self(tree[2], values)
        return {"+": left.__add__, "-": left.__sub__, "*": left.__mul__}[kind](right)


@cache
def names_in(tree):
    """Names that a tree uses."""
    if tree[0] == "name":
        return {tree[1]}
    found = {tree[1]} if tree[0] == "call" else set()
    return found.union(*(names_in(row) for row in tree[1:] if isinstance(row, tuple)))


class Flat:
    """A system flattened: one entry an instance of an entity without parts, and the equations of structures."""

    def __init__(self, entities, functions, top, starts=None):
        self.entities, self.functions = entities, functions
        self.leaves = []
        """(path, entity, values of generics by name, actual of each port)."""
        self.equations = []
        """(path, entity, statement, actual of each name)."""
        self.nets = {}
        """Terminals: list of (instance, through) at each."""
        self._expand(top, "", dict(starts or {}), {})

    def _expand(self, name, path, generics, ports):
        entity = self.entities[name]
        constants = {**{g: v for g, v in entity.generics.items() if v is not None}, **generics}
        assert set(constants) == set(entity.generics), f"{path}: generics without a value"
        assert set(ports) == {*entity.terminals, *entity.inputs, *entity.outputs}, f"{path}: ports without an actual"
        if not entity.parts and not entity.inner:
            self.leaves.append((path, entity, constants, ports))
            return
        scope = {**ports, **{n: f"{path}{n}" for n in (*entity.inner, *entity.quantities)}}
        for label, kind, generic_map, port_map in entity.parts:
            given = {formal: constants.get(actual, actual) for formal, actual in generic_map.items()}
            actual = {formal: scope[name] for formal, name in port_map.items()}
            self._expand(kind, f"{path}{label}/", given, actual)
        for statement in entity.statements:
            self.equations.append((path, statement, scope))


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
