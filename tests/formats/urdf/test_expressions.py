"""Expressions give what Python gives, as far as they are known, and reach nothing else."""

from __future__ import annotations

import math
import re

import pytest

from kinform.formats.urdf.reading.expressions import (
    Budget,
    Language,
    Names,
    NotAllowed,
    functions,
    maths,
    more_functions,
)

SYMBOLS = Names({**functions(), **maths(), "math": maths(), "python": more_functions(), "a": 2, "t": "x y", "l": [1, 2],
                 "d": {"k": [1.5], "keys": 1}})  # fmt: skip
LANGUAGE = Language()


def value(text, symbols=SYMBOLS, most=2_000_000):
    return LANGUAGE.evaluate(text, symbols, Budget(most))


PLAIN = """
1+2*3-4/5//6%7**2; -(-1.5); not a; ~5; 1 << 3; 7 & 3; 1 | 2 ^ 3; 2**-1; 2**0.5; 1e300*10; 1 < a <= 2; a == 2 and t
0 or t; 'y' in t; 'z' not in t; None is None; 1 if a > 1 else 0; [1, *l]; (1, 2)[0]; l[-1]; t[::-1]; l[0:1]
{'x': 1, 'y': 2}; {k: 1 for k in l}; [i*j for i in l for j in l if i != j]; max(x for x in l); d['k'][0]
t.split()[1]; t.upper().strip(); ','.join(map(str, l)); 'a'.rjust(5, '*'); 'aXa'.replace('a', 'bb')
'%s %.3f %5d' % ('q', 1.5, 3); '%(x)s' % {'x': 1}; str(1e-7); int('12') + float('1.5'); int('ff', 16); bool('')
len(t); min(1, 2); max(l); max([], default=3); round(2.675, 2); round(7.5); sorted([3, 1], reverse=True)
list(range(3)); dict(a=1, b=2); python.sum(l); python.abs(-1); python.isinstance(a, (python.int, python.str))
python.divmod(7, 2); list(python.zip(l, l)); list(python.enumerate('ab')); list(python.reversed(l))
list(python.filter(None, [0, 1])); sorted(['bb', 'a'], key=len); python.any([0, 1]); python.all(l); d.get('n', 4)
sin(pi/2) + math.cos(0) + radians(180); atan2(1, 2); math.hypot(3, 4); factorial(5); inf; str([1, 'a', None, True])
python.tuple(l); python.ord('a'); python.repr('a'); l.index(2); l.count(1); list(d.keys()); 'abc' < 'abd'; "a" "b"
"""


@pytest.mark.parametrize("text", re.split("[;\n] ?", PLAIN.strip()))
def test_what_is_known_gives_what_python_gives(text):
    python = type("python", (), {name: staticmethod(getattr(__import__("builtins"), name))
                                 for name in more_functions() if name not in ("True", "False")})  # fmt: skip
    names = {**{key: held for key, held in vars(math).items() if key[0] != "_"}, "math": math, "python": python,
             **{key: SYMBOLS[key] for key in "atld"}}  # fmt: skip
    assert value(text) == eval(text, names)


ESCAPES = (
    "().__class__.__base__.__subclasses__()", "''.__class__.__mro__", "(lambda: 0)()", "(lambda: 0).__globals__",
    "str.__globals__", "len.call", "len.call.__self__", "math.__loader__", "math.sin.__self__", "[].append(1)",
    "(x for x in l).gi_frame.f_back", "[x for x in l].__len__()", "f'{l.__class__}'", "'{0.__class__}'.format(l)",
    "'{a}'.format_map(d)", "str.format('{}', 1)", "type(1)", "python.type(1)", "python.vars(math)", "vars()",
    "globals()", "getattr(l, 'x')", "__builtins__", "__import__('os')", "open('/dev/null')", "exec('1')", "eval('1')",
    "(y := 1)", "d.__class__", "d.update", "d.update(x=1)", "dict.fromkeys('a')", "(1).real", "1j", "b'x'", "...",
    "{1, 2}", "{x for x in l}", "[*l][0].__class__", "dict(**d)", "len['a']", "map(type, l)", "t.encode()",
    "t.translate(d)", "math.gcd.__call__(1)", "python.isinstance(1, object)", "python.hash(1)", "print(1)", "str(math)",
    "[l.__class__ for l in l]", "{**d}", "sorted(l, key=lambda x: x)", "sorted(l, key=t)", "max(l, key=eval)", "l()",
    "a.b", "d.k", "math[0]", "await a", "(yield)", "[x async for x in l]", "(-8)**(1/3)", "a @ a", "python['type']",
    "'%*d' % (9, 1)", "'%ld' % 1", "[1 for d['x'] in l]", "[1 for l.x in l]", "not_there", "t.__len__()",
)  # fmt: skip


@pytest.mark.parametrize("text", ESCAPES)
def test_nothing_else_is_reached(text):
    with pytest.raises((NotAllowed, NameError, KeyError, AttributeError, TypeError, SyntaxError)):
        value(text)


LARGE = (
    "9**9**9", "2**5000", "1 << 10**9", "10**1000 * 10**1000", "'a' * 10**9", "[0] * 10**9", "10**9 * (1,)",
    "range(10**12)",
    "list(range(10**7))", "'%1000000000d' % 1", "'%.99999999f' % 1", "'a'.ljust(10**9)", "'a'.zfill(10**9)",
    "('a' * 1000).replace('', 'b' * 100000)", "','.join(['a' * 1000000] * 1000)", "[[[[0]*1000]*1000]*1000]*1000",
    "str([[[0]*1000]*1000]*1000)", "python.sum([[1]] * 1000, [])", "factorial(10**6)", "factorial(10**9)",
    "round(5, -10**9)",
    "math.prod([10**300] * 100)", "[x for x in range(10**6) for y in range(10**6)]",
    "[1 for i in range(10**6) if t * 9]",
    "-" * 9000 + "1", "(" * 500 + "1" + ")" * 500, "+".join(["1"] * 4000), "not " * 2000 + "1", "[" * 5000, "1" * 9000,
    "1" + " " * 20000 + "+1", "int('9' * 100000)", "[r for r in [range(999999)] for i in range(10**5) if 1.5 in r]",
)  # fmt: skip


@pytest.mark.parametrize("text", LARGE, ids=[text[:30] for text in LARGE])
def test_what_is_large_is_refused(text):
    with pytest.raises((NotAllowed, SyntaxError, ValueError, TypeError)):
        value(text, most=100_000)


def test_values_of_symbols_are_plain_data():
    for one in (object(), open, math, {1}, type, iter([])):
        with pytest.raises(NotAllowed):
            value("x", {"x": one})
        with pytest.raises(NotAllowed):
            value("x[0]", {"x": [one]})


def test_work_is_counted_over_all_expressions():
    budget = Budget(20)
    assert [LANGUAGE.evaluate("1 + 2", {}, budget) for _ in range(2)] == [3, 3]
    with pytest.raises(NotAllowed):
        LANGUAGE.evaluate("1 + 2 + 3 + 4 + 5", {}, budget)
