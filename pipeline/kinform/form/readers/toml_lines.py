"""Lines of tables and keys in a TOML text.

tomllib gives values without their places. This scanner walks a text that tomllib has accepted, and keeps
only the line on which each key, table and array element begins. It follows TOML 1.0 and checks nothing. What a value
holds that ends on the line on which it begins is not entered: all of it is on the line of its key.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from collections.abc import Collection, Iterator

Path = tuple[str | int, ...]

_BLANK = re.compile(r"[ \t]*")
_GAP = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}\n#]+")
_BASIC = re.compile(r'"(?:[^"\\]|\\.)*"')
_LITERAL = re.compile(r"'[^']*'")
_LONG_BASIC = re.compile(r'"""(?:[^"\\]|\\.|"(?!"")|\\\n)*"{3,5}', re.DOTALL)
_LONG_LITERAL = re.compile(r"'''(?:[^']|'(?!''))*'{3,5}", re.DOTALL)
_SHORT = r"""(?:"(?:[^"\\\n]|\\.)++"|'[^'\n]++'|""(?!")|''(?!'))"""
"""A string on one line, of one quotation mark at either end."""
_PLAIN = re.compile(rf"""([A-Za-z0-9_-]++)[ \t]*+=[ \t]*+(?:{_SHORT}|[^\s,\[\]{{}}"'#]++)[ \t]*+(?=\n|\Z)""")
"""A line with one key, not dotted, and one value, which holds no others; a date is not divided from its time."""
_BRACKET = re.compile(rf"""[^\[\]{{}}"'#\n]++|{_SHORT}|([\[{{])|([\]}}])""")
"""What is in an array or an inline table, piece by piece, as far as its line goes."""


class LineTable:
    """The 1-based line of each path, such as ("part", 2, "mesh")."""

    def __init__(self, text: str):
        """Scan a text that tomllib accepts."""
        self._text = text.replace("\r\n", "\n")
        self._position = 0
        self._line = 1
        self._counted_to = 0
        self._lines: dict[Path, int] = {}
        self._elements: dict[Path, int] = {}
        self._scan()

    def line(self, path: Path) -> int:
        """Line of the path, or of the closest table or key around it (1 for an empty path)."""
        for length in range(len(path), 0, -1):
            if path[:length] in self._lines:
                return self._lines[path[:length]]
        return 1

    def file(self, path: Path) -> str | None:
        """None: all lines are of the manifest itself."""
        return None

    def items(self) -> Iterator[tuple[Path, int]]:
        """Each path with its line."""
        yield from self._lines.items()

    def _scan(self) -> None:
        table: Path = ()
        while True:
            self._skip(_GAP)
            if self._position >= len(self._text):
                return
            if self._peek("["):
                table = self._header()
            else:
                self._pair(table)

    def _header(self) -> Path:
        line = self._here()
        many = self._text.startswith("[[", self._position)
        self._position += 2 if many else 1
        keys = self._keys()
        self._position += 2 if many else 1
        path: Path = ()
        for key in keys[:-1]:
            path = self._enter((*path, key), line)
        path = (*path, keys[-1])
        if many:
            self._lines.setdefault(path, line)
            self._elements[path] = self._elements.get(path, -1) + 1
            path = (*path, self._elements[path])
        else:
            path = self._enter(path, line)
        self._lines[path] = line
        return path

    def _enter(self, path: Path, line: int) -> Path:
        self._lines.setdefault(path, line)
        return (*path, self._elements[path]) if path in self._elements else path

    def _pair(self, table: Path) -> None:
        line = self._here()
        plain = _PLAIN.match(self._text, self._position)
        if plain is not None:
            self._position = plain.end()
            self._lines.setdefault((*table, plain[1]), line)
            return
        path = table
        for key in self._keys():
            path = (*path, key)
            self._lines.setdefault(path, line)
        self._position += 1
        self._skip(_BLANK)
        self._value(path)

    def _keys(self) -> list[str]:
        keys = []
        while True:
            self._skip(_BLANK)
            keys.append(self._key())
            self._skip(_BLANK)
            if not self._peek("."):
                return keys
            self._position += 1

    def _key(self) -> str:
        for pattern in (_BASIC, _LITERAL):
            text = self._skip(pattern)
            if text:
                return str(tomllib.loads("k = " + text)["k"])
        return self._skip(_BARE)

    def _value(self, path: Path) -> None:
        for pattern in (_LONG_BASIC, _LONG_LITERAL, _BASIC, _LITERAL):
            if self._skip(pattern):
                return
        if not (self._peek("[") or self._peek("{")):
            self._skip(_SCALAR)
        elif not self._passes_line():
            (self._array if self._peek("[") else self._inline)(path)

    def _passes_line(self) -> bool:
        """Go behind the brackets that begin here, if they end on this line and hold no long strings. As often as the
        answer is no, brackets are open at the end of the line."""
        depth, position = 0, self._position
        while piece := _BRACKET.match(self._text, position):
            position = piece.end()
            if piece.lastindex is not None:
                depth += 1 if piece.lastindex == 1 else -1
                if depth == 0:
                    self._position = position
                    return True
        return False

    def _array(self, path: Path) -> None:
        for index, _ in enumerate(self._entries("]")):
            self._lines[(*path, index)] = self._here()
            self._value((*path, index))

    def _inline(self, path: Path) -> None:
        for _ in self._entries("}"):
            self._pair(path)

    def _entries(self, closing: str) -> Iterator[None]:
        """Stops at each entry between brackets, which whoever asks reads, and behind the closing one."""
        self._position += 1
        while True:
            self._skip(_GAP)
            if self._peek(closing):
                break
            if self._peek(","):
                self._position += 1
                continue
            yield
        self._position += 1

    def _peek(self, character: str) -> bool:
        return self._text.startswith(character, self._position)

    def _skip(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self._text, self._position)
        if not match:
            return ""
        self._position = match.end()
        return match[0]

    def _here(self) -> int:
        self._line += self._text.count("\n", self._counted_to, self._position)
        self._counted_to = self._position
        return self._line


class Removed:
    """Tables that are taken out of a manifest: where the elements that move up in their arrays were before."""

    def __init__(self, dropped: Collection[Path]):
        self._passed: dict[Path, list[int]] = {}
        for path in dropped:
            if isinstance(path[-1], int):
                self._passed.setdefault(path[:-1], []).append(path[-1])
        for passed in self._passed.values():
            passed.sort()
            passed[:] = [place - n for n, place in enumerate(passed)]

    def before(self, path: Path) -> Path:
        """The path that an element had, by the one that it has now."""
        out: Path = ()
        for step in path:
            passed = self._passed.get(out, ()) if isinstance(step, int) else ()
            out = (*out, step + bisect_right(passed, step) if isinstance(step, int) else step)
        return out
