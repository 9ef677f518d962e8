"""The names of the parts that native code works on, in memory shared with the process that supervises this one.

Native code that crashes or hangs leaves no other trace. Without a supervisor nothing is written.
"""

from __future__ import annotations

import mmap

BYTES = 1024
"""Size of the shared memory. Its first two bytes are the length of the text; the rest holds two names of the 255
characters that file systems allow. Longer texts are cut."""

board: mmap.mmap | None = None
"""Memory that is shared with the supervisor; None without one."""


_text = ""
"""The text on the board."""


class working_on:
    """Context in which native code works on these parts; afterwards the board has its former text. Takes about a
    microsecond."""

    __slots__ = ("_before", "_names")

    def __init__(self, *names: str):
        self._names, self._before = names, ""

    def __enter__(self) -> None:
        global _text
        if board is not None:
            self._before, _text = _text, " and ".join(self._names)
            write(board, _text)

    def __exit__(self, *_: object) -> None:
        global _text
        if board is not None:
            _text = self._before
            write(board, _text)


def write(target: mmap.mmap, text: str) -> None:
    """Write a text to a board."""
    data = text.encode("utf-8", "replace")[: BYTES - 2]
    target[2 : 2 + len(data)] = data
    target[:2] = len(data).to_bytes(2, "little")


def read(source: mmap.mmap) -> str:
    """The text on a board, "" if it is empty."""
    return source[2 : 2 + int.from_bytes(source[:2], "little")].decode("utf-8", "replace")
