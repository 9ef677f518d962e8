"""Expressions of xacro, evaluated without Python's `eval`: a walk over the syntax tree that knows what is listed here.

Why it holds: nothing is looked up by name on an object. A name comes from the table of symbols, an attribute from a
mapping, a method from the tables below, and every value is plain data of an exact type (`_DATA`) or one of the
functions listed here. So no class, module, frame or function of Python can be reached, whatever is written.
What a value may weigh, and all work together, is bounded (`Budget`) before memory is allocated.
"""

from __future__ import annotations

import ast
import datetime
import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import NoneType
from typing import Any

from kinform.frozen import dataclass

EXPRESSION_LENGTH = 10_000
"""Characters of an expression; the longest in 330 public files has 98."""
DEPTH = 100
"""Levels of an expression, of which a sum of n terms has n."""
INTEGER_BITS = 4096
"""Of an integer: the largest double has 1024, and Python refuses to print more than 14,000."""
WEIGHT = 1_000_000
"""Characters and items of one value, those of values inside it counted as often as they occur. The largest YAML file
of a public robot has 20,000."""
WORK = 2_000_000
"""Steps of all expressions of a file together, about two seconds; public robots take up to 18,000."""
_FACTORIAL = 300
"""Largest argument of `factorial` and `comb`: 300! has 2043 bits."""
_DIGITS = 400
"""Largest number of decimals that `round` takes; a double has fewer."""
_WIDTH = 3
"""Digits of the width and of the precision in a format such as %.3f."""


class NotAllowed(Exception):
    """An expression asks for what this evaluator does not do, or for more than it may take."""

    def __init__(self, words: str, remedy: str | None = None):
        super().__init__(words)
        self.words, self.remedy = words, remedy
        self.expression: str | None = None


class Budget:
    """What all expressions of a file may still take."""

    def __init__(self, most: int = WORK):
        self.left = most

    def spend(self, steps: int) -> None:
        """Raise NotAllowed when nothing is left."""
        self.left -= steps
        if self.left < 0:
            raise NotAllowed(
                "takes too many steps to expand: do its macros call each other more than once?", "call them in turn"
            )


@dataclass(frozen=True, eq=False)
class Function:
    """A function that expressions may call; `kind` is the type that it stands for in isinstance."""

    name: str
    call: Callable[..., Any]
    kind: type | None = None

    def __repr__(self) -> str:
        return f"<function {self.name}>"


class Names(dict[str, Any]):
    """A namespace of functions and constants, such as `math`."""

    def __repr__(self) -> str:
        return "<namespace>"


class Language:
    """What expressions know: their functions, and the types of mapping of the program that keeps the symbols.

    `dotted` are types of mapping whose items are read like attributes, `lists` other types of list; both only hold
    data. `spaces` are types of symbol table whose items are read like attributes.
    """

    def __init__(self, dotted: Sequence[type] = (), lists: Sequence[type] = (), spaces: Sequence[type] = ()):
        self.dotted, self.spaces = frozenset(dotted), frozenset((*spaces, Names))
        self.lists, self.dicts = frozenset((list, tuple, *lists)), frozenset((dict, *dotted))
        self.known = _DATA | self.lists | self.dicts | self.spaces
        self.methods: dict[type, Mapping[str, Callable[..., Any]]] = {str: _TEXT_METHODS}
        self.methods |= dict.fromkeys(self.lists, _LIST_METHODS) | dict.fromkeys(self.dicts, _DICT_METHODS)
        self._trees: dict[str, ast.expr] = {}

    def evaluate(self, text: str, symbols: Any, budget: Budget) -> Any:
        """The value of an expression. `symbols[name]` gives that of a name, or raises KeyError.

        Raises NotAllowed, or what Python raises for a fault of the expression.
        """
        return _Walk(self, symbols, budget).value(self._tree(text.strip()))

    def _tree(self, text: str) -> ast.expr:
        if text not in self._trees:
            if len(text) > EXPRESSION_LENGTH:
                raise NotAllowed(f"has an expression of {len(text):,} characters: {EXPRESSION_LENGTH:,} are the most")
            try:
                self._trees[text] = ast.parse(text, "<expression>", "eval").body
            except (MemoryError, RecursionError):  # the parser's own limits
                raise _too_deep() from None
        return self._trees[text]

    def checked(self, value: Any, budget: Budget) -> Any:
        """The value itself, which is plain data of a bounded size; charges for what it holds."""
        if type(value) in _SMALL:
            return value
        weight, waiting = 0, [value]
        while waiting:
            one = waiting.pop()
            kind, size = type(one), 0
            if kind is str or kind is range:
                size = len(one)
            elif kind is int:
                if one.bit_length() > INTEGER_BITS:
                    raise NotAllowed(f"makes a number of more than {INTEGER_BITS} bits", "use a smaller number")
            elif kind in self.lists:
                size = len(one)
                waiting.extend(list.__iter__(one) if isinstance(one, list) else one)
            elif kind in self.dicts:
                size = 2 * len(one)
                waiting.extend(dict.keys(one))
                waiting.extend(dict.values(one))
            elif kind in self.spaces or kind not in self.known:
                raise NotAllowed(f"uses {_a_kind(kind)} as a value, which kinform does not take")
            weight += 1 + (size >> 3 if kind is str else size)
            if weight > WEIGHT or size > WEIGHT:
                raise too_large()
        budget.spend(1 + (weight >> 2))
        return value


def _too_deep() -> NotAllowed:
    return NotAllowed(f"has an expression that is nested more than {DEPTH} deep", "use properties for its parts")


def too_large() -> NotAllowed:
    """A value is larger than WEIGHT."""
    return NotAllowed(f"makes a text or a list of more than {WEIGHT:,} items", "shorten it")


def _a_kind(kind: type) -> str:
    return f"a value of type {kind.__name__}"


class _Walk:
    """One evaluation."""

    def __init__(self, language: Language, symbols: Any, budget: Budget):
        self.language, self.symbols, self.budget = language, symbols, budget
        self.local: dict[str, Any] = {}
        self.depth = 0

    def value(self, node: ast.expr) -> Any:
        """Of a node of the tree."""
        step = _STEPS.get(type(node))
        if step is None:
            what = _UNKNOWN.get(type(node), type(node).__name__)
            raise NotAllowed(f"uses {what} in an expression, which kinform does not evaluate")
        self.budget.spend(1)
        self.depth += 1
        if self.depth > DEPTH:
            raise _too_deep()
        out = step(self, node)
        self.depth -= 1
        return out

    def kept(self, value: Any) -> Any:
        """What an operation made, if it is plain data of a bounded size."""
        return self.language.checked(value, self.budget)

    def constant(self, node: ast.Constant) -> Any:
        """Numbers, texts, True, False and None."""
        if type(node.value) not in (int, float, str, bool, NoneType):
            raise NotAllowed(f"uses {_a_kind(type(node.value))} in an expression, which kinform does not evaluate")
        return self.kept(node.value)

    def name(self, node: ast.Name) -> Any:
        """The value of a symbol."""
        if node.id in self.local:
            return self.local[node.id]
        if node.id.startswith("__"):
            raise NotAllowed(f"uses the name {node.id}, which kinform does not evaluate")
        try:
            value = self.symbols[node.id]
        except KeyError:
            raise NameError(f"name '{node.id}' is not defined") from None
        return self.typed(value)

    def typed(self, value: Any) -> Any:
        """A part of what was weighed before, if it is plain data."""
        if type(value) not in self.language.known:
            raise NotAllowed(f"uses {_a_kind(type(value))}, which kinform does not take")
        return value

    def attribute(self, node: ast.Attribute) -> Any:
        """An item of a mapping, written with a dot."""
        return self.item_by_dot(self.value(node.value), node.attr)

    def item_by_dot(self, whole: Any, name: str) -> Any:
        """The item of a mapping that has the name."""
        kind = type(whole)
        if name.startswith("__") or (kind not in self.language.dotted and kind not in self.language.spaces):
            raise NotAllowed(f"uses .{name} of {_a_kind(kind)}, which kinform does not evaluate")
        if kind in self.language.dotted and name not in whole:
            raise AttributeError(f"The yaml dictionary has no key '{name}'")
        try:
            return self.typed(whole[name])
        except KeyError:
            raise NameError(f"name '{name}' is not defined") from None

    def subscript(self, node: ast.Subscript) -> Any:
        """An item, or a slice."""
        whole = self.value(node.value)
        if isinstance(node.slice, ast.Slice):
            start, stop, step = (None if n is None else self.value(n) for n in
                                 (node.slice.lower, node.slice.upper, node.slice.step))  # fmt: skip
            self.cost(whole)
            return self.kept(self.indexed(whole)[start:stop:step])
        return self.typed(self.indexed(whole)[self.key(self.value(node.slice))])

    def indexed(self, whole: Any) -> Any:
        """The value, which is not an object of Python with items of its own."""
        if isinstance(whole, Function):
            raise NotAllowed(f"uses {whole.name}[…], which kinform does not evaluate")
        return whole

    def call(self, node: ast.Call) -> Any:
        """One of the functions, or one of the methods of texts, lists and mappings."""
        function: Callable[..., Any]
        if isinstance(node.func, ast.Attribute):
            whole, name = self.value(node.func.value), node.func.attr
            method = self.language.methods.get(type(whole), {}).get(name)
            if method is not None:
                self.cost(whole)
                return self.kept(method(whole, *self.arguments(node), **self.keywords(node)))
            if type(whole) not in self.language.spaces:
                raise NotAllowed(f"calls .{name}() of {_a_kind(type(whole))}, which kinform does not evaluate")
            called = self.item_by_dot(whole, name)
        else:
            called = self.value(node.func)
        if not isinstance(called, Function):
            raise TypeError(f"{type(called).__name__!r} object is not callable")
        function = called.call
        return self.kept(function(*self.arguments(node), **self.keywords(node)))

    def arguments(self, node: ast.Call) -> list[Any]:
        """The arguments by place."""
        out: list[Any] = []
        for argument in node.args:
            if isinstance(argument, ast.Starred):
                out += items_of(self.value(argument.value))
            else:
                out.append(self.value(argument))
        for value in out:
            self.cost(value)
        return out

    def keywords(self, node: ast.Call) -> dict[str, Any]:
        """The arguments by name."""
        if any(keyword.arg is None for keyword in node.keywords):
            raise NotAllowed("uses ** in an expression, which kinform does not evaluate")
        out = {str(keyword.arg): self.value(keyword.value) for keyword in node.keywords}
        for value in out.values():
            self.cost(value)
        return out

    def cost(self, value: Any) -> None:
        """Charge for looking through a value."""
        if type(value) is str:
            self.budget.spend(len(value) >> 6)
        elif type(value) not in _SMALL:
            self.kept(value)

    def unary(self, node: ast.UnaryOp) -> Any:
        """Signs, `not` and `~`."""
        return self.kept(_UNARY[type(node.op)](self.value(node.operand)))

    def binary(self, node: ast.BinOp) -> Any:
        """Arithmetic."""
        operation = _BINARY.get(type(node.op))
        if operation is None:
            raise NotAllowed("uses @ in an expression, which kinform does not evaluate")
        first, second = self.value(node.left), self.value(node.right)
        self.cost(first)
        self.cost(second)
        return self.kept(operation(first, second))

    def boolean(self, node: ast.BoolOp) -> Any:
        """`and` and `or`, which leave out what does not count."""
        value, stops = None, isinstance(node.op, ast.Or)
        for inner in node.values:
            value = self.value(inner)
            if bool(value) is stops:
                break
        return value

    def compare(self, node: ast.Compare) -> Any:
        """Comparisons, also in chains."""
        first, out = self.value(node.left), True
        for sign, inner in zip(node.ops, node.comparators, strict=True):
            second = self.value(inner)
            self.cost(first)
            self.cost(second)
            out = _COMPARED[type(sign)](first, second)
            if not out:
                break
            first = second
        return out

    def conditional(self, node: ast.IfExp) -> Any:
        """`a if b else c`."""
        return self.value(node.body if self.value(node.test) else node.orelse)

    def sequence(self, node: ast.List | ast.Tuple) -> Any:
        """A list or a tuple."""
        out: list[Any] = []
        for inner in node.elts:
            if isinstance(inner, ast.Starred):
                out += items_of(self.value(inner.value))
            else:
                out.append(self.value(inner))
        return self.kept(out if isinstance(node, ast.List) else tuple(out))

    def mapping(self, node: ast.Dict) -> Any:
        """A dictionary."""
        out = {}
        for key, inner in zip(node.keys, node.values, strict=True):
            if key is None:
                raise NotAllowed("uses ** in an expression, which kinform does not evaluate")
            out[self.key(self.value(key))] = self.value(inner)
        return self.kept(out)

    def key(self, value: Any) -> Any:
        """A key of a mapping, which is looked through where it is hashed."""
        self.cost(value)
        return value

    def each(self, node: ast.ListComp | ast.GeneratorExp) -> Any:
        """A comprehension as a list."""
        out: list[Any] = []
        for _ in self.turns(node.generators):
            out.append(self.value(node.elt))
            self.bounded(len(out))
        return self.kept(out)

    def each_pair(self, node: ast.DictComp) -> Any:
        """A comprehension as a dictionary."""
        out = {}
        for _ in self.turns(node.generators):
            out[self.key(self.value(node.key))] = self.value(node.value)
            self.bounded(len(out))
        return self.kept(out)

    def bounded(self, size: int) -> None:
        """Raise NotAllowed for a list of too many."""
        if size > WEIGHT:
            raise too_large()

    def turns(self, loops: Sequence[ast.comprehension]) -> Iterator[None]:
        """The turns of a comprehension, with its names in place."""
        if not loops:
            yield
            return
        loop = loops[0]
        if loop.is_async:
            raise NotAllowed("uses async in an expression, which kinform does not evaluate")
        outer = dict(self.local)
        for one in items_of(self.value(loop.iter)):
            self.bind(loop.target, one)
            if all(self.value(test) for test in loop.ifs):
                yield from self.turns(loops[1:])
        self.local = outer

    def bind(self, target: ast.expr, value: Any) -> None:
        """Give a value to the names of a loop."""
        self.budget.spend(1)
        if isinstance(target, ast.Name):
            self.local[target.id] = self.typed(value)
        elif isinstance(target, ast.Tuple | ast.List):
            values = items_of(value)
            if len(values) != len(target.elts):
                raise ValueError(f"{len(target.elts)} values are expected, and {len(values)} are there")
            for inner, one in zip(target.elts, values, strict=True):
                self.bind(inner, one)
        else:
            raise NotAllowed("gives a value to what is no name, which kinform does not evaluate")


_STEPS: Mapping[type[ast.expr], Callable[[_Walk, Any], Any]] = {
    ast.Constant: _Walk.constant, ast.Name: _Walk.name, ast.Attribute: _Walk.attribute,
    ast.Subscript: _Walk.subscript, ast.Call: _Walk.call, ast.UnaryOp: _Walk.unary, ast.BinOp: _Walk.binary,
    ast.BoolOp: _Walk.boolean, ast.Compare: _Walk.compare, ast.IfExp: _Walk.conditional, ast.List: _Walk.sequence,
    ast.Tuple: _Walk.sequence, ast.Dict: _Walk.mapping, ast.ListComp: _Walk.each, ast.GeneratorExp: _Walk.each,
    ast.DictComp: _Walk.each_pair,
}  # fmt: skip
_UNKNOWN: Mapping[type[ast.expr], str] = {
    ast.Lambda: "lambda", ast.NamedExpr: ":=", ast.JoinedStr: "an f-string", ast.Set: "a set", ast.SetComp: "a set",
    ast.Await: "await", ast.Yield: "yield", ast.YieldFrom: "yield", ast.Starred: "*", ast.Slice: "a slice",
}  # fmt: skip
"""What is refused, as messages have it."""

_SMALL = frozenset((float, bool, NoneType, Function))
"""Types of which a value has always the same size."""
_DATA = frozenset((*_SMALL, int, str, range, datetime.date, datetime.datetime))
"""Types of plain data; dates come from YAML."""


def items_of(value: Any) -> list[Any]:
    """The items of a list, text, mapping or range; raises TypeError of other values."""
    if type(value) is range and len(value) > WEIGHT:
        raise too_large()
    if isinstance(value, list | tuple | str | dict | range) and not isinstance(value, Names):
        return list(value)
    raise TypeError(f"{type(value).__name__!r} object is not iterable")


def _bits(value: int) -> int:
    return abs(value).bit_length()


def _product(first: Any, second: Any) -> Any:
    for one, times in ((first, second), (second, first)):
        if isinstance(one, str | list | tuple) and isinstance(times, int) and len(one) * times > WEIGHT:
            raise too_large()
    if isinstance(first, int) and isinstance(second, int):
        _bounded_bits(_bits(first) + _bits(second) - 1)
    return first * second


def _power(first: Any, second: Any) -> Any:
    if isinstance(first, int) and isinstance(second, int) and second > 0 and _bits(first) > 1:
        _bounded_bits((_bits(first) - 1) * second)
    return first**second


def _shifted(first: Any, second: Any) -> Any:
    if isinstance(first, int) and isinstance(second, int):
        _bounded_bits(_bits(first) + second)
    return first << second


def _bounded_bits(bits: int) -> None:
    if bits > INTEGER_BITS:
        raise NotAllowed(f"makes a number of more than {INTEGER_BITS} bits", "use a smaller number")


_FORMAT = re.compile(r"%(?:\([^()]*\))?[-#0 +]*(\d*)(?:\.(\d*))?([diouxXeEfFgGcrsa%])")


def _remainder(first: Any, second: Any) -> Any:
    if isinstance(first, str):
        for rest in re.split(_FORMAT, first)[::4]:
            if "%" in rest:
                raise NotAllowed("uses a format that kinform does not evaluate", "use %s, %d or %f with a plain width")
        if any(len(number or "") > _WIDTH for match in _FORMAT.finditer(first) for number in match.groups()[:2]):
            raise too_large()
        if first.count("%") > DEPTH:
            raise NotAllowed(f"uses a format with more than {DEPTH} values")
    return first % second


_BINARY: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: _product, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: _remainder, ast.Pow: _power, ast.LShift: _shifted,
    ast.RShift: operator.rshift, ast.BitAnd: operator.and_, ast.BitOr: operator.or_, ast.BitXor: operator.xor,
}  # fmt: skip
_UNARY: Mapping[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos, ast.USub: operator.neg, ast.Not: operator.not_, ast.Invert: operator.invert,
}  # fmt: skip
_COMPARED: Mapping[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt,
    ast.GtE: operator.ge, ast.Is: operator.is_, ast.IsNot: operator.is_not,
    ast.In: lambda one, many: one in many, ast.NotIn: lambda one, many: one not in many,
}  # fmt: skip


def _replace(text: str, old: str, new: str, count: int = -1) -> str:
    if isinstance(old, str) and isinstance(new, str) and (len(text) + 1) * (len(new) + 1) > WEIGHT:
        times = text.count(old)
        if len(text) + times * len(new) > WEIGHT:
            raise too_large()
    return text.replace(old, new, count)


def _join(text: str, parts: Any) -> str:
    parts = items_of(parts)
    if sum(len(part) for part in parts if isinstance(part, str)) + len(text) * len(parts) > WEIGHT:
        raise too_large()
    return text.join(parts)


def _padded(method: Callable[..., str]) -> Callable[..., str]:
    def padded(text: str, width: int, *fill: str) -> str:
        if isinstance(width, int) and width > WEIGHT:
            raise too_large()
        return method(text, width, *fill)

    return padded


_PLAIN = (
    "upper lower title capitalize swapcase casefold strip lstrip rstrip split rsplit splitlines partition rpartition "
    "startswith endswith find rfind index rindex count removeprefix removesuffix isdigit isdecimal isnumeric isalpha "
    "isalnum isupper islower isspace istitle isidentifier"
)
_TEXT_METHODS: Mapping[str, Callable[..., Any]] = {name: getattr(str, name) for name in _PLAIN.split()} | {
    "replace": _replace,
    "join": _join,
    **{name: _padded(getattr(str, name)) for name in ("ljust", "rjust", "center", "zfill")},
}
_LIST_METHODS: Mapping[str, Callable[..., Any]] = {
    "index": lambda items, *given: items.index(*given),
    "count": lambda items, one: items.count(one),
}
_DICT_METHODS: Mapping[str, Callable[..., Any]] = {
    "get": dict.get,
    "keys": lambda items: list(dict.keys(items)),
    "values": lambda items: list(dict.values(items)),
    "items": lambda items: list(dict.items(items)),
}


def _called(function: Any) -> Callable[..., Any] | None:
    if function is None:
        return None
    if not isinstance(function, Function):
        raise TypeError("a function is expected")
    return function.call


def _map(function: Any, *many: Any) -> list[Any]:
    call = _called(function)
    if call is None:
        raise TypeError("a function is expected")
    return [call(*given) for given in zip(*map(items_of, many), strict=False)]


def _filter(function: Any, many: Any) -> list[Any]:
    call = _called(function) or bool
    return [one for one in items_of(many) if call(one)]


def _sorted(many: Any, *, key: Any = None, reverse: bool = False) -> list[Any]:
    return sorted(items_of(many), key=_called(key), reverse=reverse)


def _extreme(extreme: Callable[..., Any]) -> Callable[..., Any]:
    def chosen(*many: Any, key: Any = None, **given: Any) -> Any:
        if given.keys() - {"default"}:
            raise TypeError("key and default are expected")
        return extreme(*((items_of(many[0]),) if len(many) == 1 else many), key=_called(key), **given)

    return chosen


def _isinstance(value: Any, kinds: Any) -> bool:
    wanted = [kind.kind if isinstance(kind, Function) else None for kind in
              (kinds if isinstance(kinds, tuple) else (kinds,))]  # fmt: skip
    if None in wanted:
        raise TypeError("isinstance() arg 2 must be a type or a tuple of types")
    return any(isinstance(value, kind) for kind in wanted if kind is not None)


def _round(value: Any, digits: Any = None) -> Any:
    if isinstance(digits, int) and abs(digits) > _DIGITS:
        raise NotAllowed(f"rounds to more than {_DIGITS} decimals", "round to fewer")
    return round(value, digits)


def _sum(many: Any, start: Any = 0) -> Any:
    numbers = items_of(many)
    if not all(isinstance(one, int | float) for one in (*numbers, start)):
        raise TypeError("only numbers are added up")
    return sum(numbers, start)


def _int(*given: Any) -> int:
    return int(*given)


def _dict(*given: Any, **named: Any) -> dict[Any, Any]:
    if len(given) > 1:
        raise TypeError(f"dict expected at most 1 argument, got {len(given)}")
    if given and not isinstance(given[0], dict):
        given = ([tuple(items_of(pair)) for pair in items_of(given[0])],)
    return dict(*given, **named)


def _small(function: Callable[..., int]) -> Callable[..., int]:
    def small(*given: int) -> int:
        if any(isinstance(one, int) and abs(one) > _FACTORIAL for one in given):
            raise NotAllowed(f"asks for a factorial above {_FACTORIAL}")
        return function(*given)

    return small


def _prod(many: Any, *, start: Any = 1) -> Any:
    out = start
    for one in items_of(many):
        out = _product(out, one)
    return out


def _range(*given: Any) -> range:
    out = range(*given)
    if len(out) > WEIGHT:
        raise too_large()
    return out


def _text_of(value: Any = "") -> str:
    return str(value)


def _list_of(function: Callable[[list[Any]], Iterable[Any]]) -> Callable[..., list[Any]]:
    return lambda many=(): list(function(items_of(many)))


def _of_items(function: Callable[[list[Any]], Any]) -> Callable[[Any], Any]:
    return lambda many: function(items_of(many))


_FUNCTIONS = (
    Function("list", _list_of(lambda items: items), list), Function("dict", _dict, dict), Function("map", _map),
    Function("len", len), Function("str", _text_of, str), Function("float", float, float),
    Function("int", _int, int), Function("bool", bool, bool), Function("min", _extreme(min)),
    Function("max", _extreme(max)), Function("round", _round), Function("sorted", _sorted), Function("range", _range),
)  # fmt: skip
"""The functions that xacro gives by name alone."""
_MORE = (
    Function("abs", abs), Function("all", _of_items(all)), Function("any", _of_items(any)),
    Function("divmod", divmod), Function("enumerate", _list_of(enumerate)), Function("filter", _filter),
    Function("isinstance", _isinstance), Function("ord", ord), Function("repr", repr),
    Function("reversed", _list_of(reversed)), Function("sum", _sum),
    Function("tuple", lambda many=(): tuple(items_of(many)), tuple),
    Function("zip", lambda *many: list(zip(*map(items_of, many), strict=False))),
)  # fmt: skip
"""Those that it gives as `python.NAME`."""

_MATHS = (
    "acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh degrees dist e erf erfc exp exp2 expm1 fabs "
    "floor fmod frexp fsum gamma gcd hypot inf isclose isfinite isinf isnan isqrt ldexp lgamma log log10 log1p log2 "
    "modf nan nextafter pi pow radians remainder sin sinh sqrt tan tanh tau trunc ulp"
)


def maths() -> Names:
    """Constants and functions of `math`."""
    out = Names()
    for name in _MATHS.split():
        value = getattr(math, name, None)
        if value is not None:
            out[name] = Function(name, value) if callable(value) else value
    for name, function in (("factorial", _small(math.factorial)), ("comb", _small(math.comb)), ("prod", _prod)):
        out[name] = Function(name, function)
    return out


def functions() -> Names:
    """The functions that have names of their own."""
    return Names({one.name: one for one in _FUNCTIONS})


def more_functions() -> Names:
    """Those of `python`, which are all."""
    return Names({one.name: one for one in (*_FUNCTIONS, *_MORE)} | {"True": True, "False": False})
