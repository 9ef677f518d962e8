"""Expressions of VHDL-AMS: read into trees, and evaluated on jets.

A jet is a value with its first and second derivative in time, so that 'dot is exact.
"""

from __future__ import annotations

import math
import re
from functools import cache

import numpy as np

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
        d = np.zeros((3, *x.shape))
        d[0] = x
        return Jet(d)

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
        return Jet(np.array([a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]]))

    def __getitem__(self, k):
        return Jet(self.d[:, k])

    def dot(self):
        """The derivative; its second one is not known, and must not be used."""
        return Jet(np.stack([self.d[1], self.d[2], np.full_like(self.d[2], np.nan)]))

    def sin(self):
        s, c = math.sin(self.d[0]), math.cos(self.d[0])
        return Jet([s, c * self.d[1], c * self.d[2] - s * self.d[1] ** 2])


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
