"""What is done to a seed: bits, ranges, lines, numbers, words of the format."""

from __future__ import annotations

import random
import re

from structure import Grammar

_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
NUMBERS = (
    b"0", b"-0", b"1", b"-1", b"1e308", b"-1e308", b"1e309", b"1e160", b"1e-320", b"1e18", b"1e19", b"1e-30", b"nan",
    b"inf", b"-inf", b"1_0", b"0x10", b"2147483648", b"-2147483649", b"9223372036854775808", b"1" * 400, b"4294967295",
    b"0.5", b"1.0000000000000002", b"360", b"1e9",
)  # fmt: skip
JUNK = (
    b"\0",
    b"\xff",
    b"\xef\xbb\xbf",
    b"\xf0\x9f\x98\x80",
    b"\r",
    b"\\",
    b'"',
    b"'",
    b"[" * 40,
    b"{" * 40,
    b"\xc2\x85",
    b"/",
)
WORDS = (b"0", b"-1", b"255", b"65535")
MOST = 40_000
"""Bytes of a mutated input."""


STRUCTURED = 0.85
"""Share of inputs of a format with a grammar of which the structure is changed; the others stop at its parser."""
BOTH = 0.05
"""Share of those whose bytes are changed too."""


def mutated(
    seed: bytes, others: list[bytes], words: tuple[bytes, ...], grammar: Grammar | None, rng: random.Random
) -> bytes:
    """The seed after one to some changes; `words` are those of the format, `others` all seeds."""
    if grammar is not None and rng.random() < STRUCTURED:
        seed = grammar.changed(seed, others, rng)
        if rng.random() >= BOTH:
            return seed
    data = bytearray(seed)
    for _ in range(min(1 + int(rng.expovariate(0.7)), 8)):
        data = rng.choice(_CHANGES)(data, others, words, rng)
    return bytes(data[:MOST])


def _span(data: bytearray, rng: random.Random) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + int(rng.expovariate(0.1)))


def _flip(data, others, words, rng):
    if data:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return data


def _byte(data, others, words, rng):
    if data:
        data[rng.randrange(len(data))] = rng.choice((0, 1, 127, 128, 255, rng.randrange(256)))
    return data


def _integer(data, others, words, rng):
    size = rng.choice((2, 4, 8))
    start = rng.randrange(len(data) + 1)
    value = rng.choice((0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**63, 2**64 - 1, rng.getrandbits(64))) % 256**size
    data[start : start + size] = value.to_bytes(size, rng.choice(("little", "big")))
    return data


def _delete(data, others, words, rng):
    start, stop = _span(data, rng)
    del data[start:stop]
    return data


def _repeat(data, others, words, rng):
    start, stop = _span(data, rng)
    data[stop:stop] = bytes(data[start:stop]) * rng.choice((1, 1, 2, 10, 100))
    return data


def _cut(data, others, words, rng):
    return data[: rng.randrange(len(data) + 1)]


def _word(data, others, words, rng):
    start, stop = _span(data, rng)
    data[start : rng.choice((start, stop))] = rng.choice((*words, *JUNK))
    return data


def _number(data, others, words, rng):
    places = list(_NUMBER.finditer(data))
    if places:
        place = rng.choice(places)
        data[place.start() : place.end()] = rng.choice(NUMBERS)
    return data


def _line(data, others, words, rng):
    lines = data.split(b"\n")
    first, second = rng.randrange(len(lines)), rng.randrange(len(lines))
    change = rng.randrange(4)
    if change == 0:
        del lines[first]
    elif change == 1:
        lines.insert(second, lines[first])
    elif change == 2:
        lines[first], lines[second] = lines[second], lines[first]
    else:
        lines[first : first + rng.randrange(20)] = []
    return bytearray(b"\n".join(lines))


def _splice(data, others, words, rng):
    other = rng.choice(others)
    start, stop = _span(bytearray(other), rng)
    at = rng.randrange(len(data) + 1)
    return data[:at] + other[start : stop + rng.randrange(200)] + data[at + rng.choice((0, stop - start)) :]


_CHANGES = (
    _flip,
    _byte,
    _integer,
    _delete,
    _repeat,
    _cut,
    _word,
    _word,
    _number,
    _number,
    _number,
    _line,
    _line,
    _splice,
)
