"""Long texts a piece at a time: what Python makes of words takes twenty times their memory."""

from __future__ import annotations

import re
from collections.abc import Iterator

BLOCK_BYTES = 1 << 18
"""Bytes of a text that are taken apart at a time: where each line is a letter they take 40 MB then."""


SPACE = re.compile(rb"\s")
NEWLINE = re.compile(rb"\r\n|\r|\n")


def blocks(data: bytes, start: int, stop: int, end: re.Pattern[bytes]) -> Iterator[tuple[int, bytes]]:
    """Pieces of the bytes from `start` to `stop` with their positions, each but the last up to a match of `end`."""
    while start < stop:
        found = end.search(data, start + BLOCK_BYTES, stop) if stop - start > BLOCK_BYTES else None
        until = stop if found is None else found.end()
        yield start, data[start:until]
        start = until


def with_newlines(data: bytes) -> bytes:
    """The bytes with their lines ended as on Unix."""
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def coordinate(token: bytes) -> float:
    """The number that a word states; ValueError where it is none, as 1_000 is none outside Python."""
    if b"_" in token:
        raise ValueError("no number")
    return float(token)
