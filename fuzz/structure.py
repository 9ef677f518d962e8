"""Changes XML and TOML as what they are, elements, attributes, tables, keys and values: parsers read the result.

A `Grammar` knows the words of a format: those of its seeds, and the texts and field names in the modules that read it.
"""

from __future__ import annotations

import ast
import functools
import random
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

NUMBERS = (
    "0", "-0", "1", "-1", "2", "0.5", "1e308", "-1e308", "1e309", "1e160", "1e-320", "1e18", "1e19", "1e-30",
    "nan", "inf",
    "-inf", "1_0", "0x10", "2147483648", "-2147483649", "9223372036854775808", "1" * 400, "1.0000000000000002", "360",
    "1e9", "1e-9", "3.14159265358979", "90", "1000", "100000", "\u0663", "1e", ".",
)  # fmt: skip
TEXTS = (
    "", " ", "a", "x" * 3000, "..", "/", "a/b", "a\\b", "/etc/hostname", "../a.stl", "file:///etc/hostname",
    "package://x/a.stl",
    "package://design/a.stl", "model://a", "a.stl", "a.obj", "%s%n", "{}", "\u00e4", "\u202e", "\U0001f600",
    "\ufeff", "\x7f",
    "true", "false", "world", "a::b", "__model__", "0 0 0", "1 2", "1 0 0 0", "0 0 0 0 0 0", "1 2 3 4 5 6 7", "0 0 1",
    "1e400 0 0", "#a", "CON", "a b", "none", "None", "-", "=1+1", "::error::x", "#", "*", "?", "~", "$HOME",
)  # fmt: skip
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
_WORD = re.compile(r"[A-Za-z_][\w:.-]{0,30}")
LONGEST = 20_000
"""Characters of a changed text: a longer one is given back as it was."""
MANY = 20
"""Copies of an element or a table that are made at once, at most."""


def words_of(modules: Iterable[Path]) -> tuple[str, ...]:
    """Texts and names of fields in modules: the words of the format that they read."""
    found: set[str] = set()
    for path in (file for place in modules for file in ([place] if place.is_file() else sorted(place.rglob("*.py")))):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and _WORD.fullmatch(node.value):
                found.add(node.value)
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                found.add(node.target.id)
    return tuple(sorted(found))


@dataclass(frozen=True)
class Grammar:
    """What a text of a format is made of, and words for it."""

    kind: Literal["xml", "toml"]
    words: tuple[str, ...]
    values: tuple[str, ...] = ()
    """Of the format, beside TEXTS."""

    def changed(self, data: bytes, others: list[bytes], rng: random.Random) -> bytes:
        """The text with one to some changes; as it was where it is no such text."""
        try:
            text = data.decode()
        except UnicodeDecodeError:
            return data
        known = _known(tuple(others), self.kind)
        edit = _Xml if self.kind == "xml" else _Toml
        made = edit(text, self, known, rng)
        for _ in range(min(1 + int(rng.expovariate(0.6)), 12)):
            made.change()
        out = made.text()
        return out.encode("utf-8", "replace") if len(out) <= LONGEST else data


@dataclass
class _Known:
    """What the seeds hold."""

    tags: list[str] = field(default_factory=list)
    names: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """By tag, names of its attributes; by header, its keys."""
    values: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    """By name of an attribute or key, or by tag the text inside."""
    pieces: list = field(default_factory=list)
    """Elements, or tables."""


@functools.lru_cache(maxsize=64)
def _known(seeds: tuple[bytes, ...], kind: str) -> _Known:
    known = _Known()
    for data in seeds:
        try:
            text = data.decode()
        except UnicodeDecodeError:
            continue
        if kind == "xml":
            for node, _ in _all(_parsed(text)):
                known.tags.append(node.tag)
                known.pieces.append(node)
                for name, value in node.attributes:
                    known.names[node.tag].append(name)
                    known.values[name].append(value)
                known.values[node.tag] += [inner for inner in node.inside if isinstance(inner, str) and inner.strip()]
        else:
            for table in _tables(text):
                known.tags.append(table.header)
                known.pieces.append(table)
                for name, value in table.entries:
                    known.names[table.header].append(name)
                    known.values[name].append(value)
    return known


def _piece(text: str, rng: random.Random) -> str:
    """The text with one of its numbers, or of its words, changed, added or left out."""
    places = list(_NUMBER.finditer(text))
    if places and rng.random() < 0.7:
        place = rng.choice(places)
        return text[: place.start()] + rng.choice(NUMBERS) + text[place.end() :]
    words = text.split(" ")
    at, change = rng.randrange(len(words)), rng.randrange(4)
    if change == 0:
        del words[at]
    elif change == 1:
        words.insert(at, words[at])
    elif change == 2:
        words[at] = rng.choice(TEXTS)
    else:
        at, size = rng.randrange(len(text) + 1), rng.randrange(4)
        return text[:at] + rng.choice(("", "a", " ", "/", ".", "-", ":", "\u00e4")) + text[at + size :]
    return " ".join(words)


# XML


@dataclass(slots=True, eq=False)
class _Node:
    tag: str
    attributes: list[tuple[str, str]]
    inside: list  # of _Node and str

    def copy(self) -> _Node:
        inside = [inner if isinstance(inner, str) else inner.copy() for inner in self.inside]
        return _Node(self.tag, list(self.attributes), inside)

    def write(self, out: list[str]) -> None:
        if self.tag:
            said = "".join([f' {name}="{value}"' for name, value in self.attributes])
            out.append(f"<{self.tag}{said}>" if self.inside else f"<{self.tag}{said}/>")
        for inner in self.inside:
            if isinstance(inner, str):
                out.append(inner)
            else:
                inner.write(out)
        if self.tag and self.inside:
            out.append(f"</{self.tag}>")


_TOKEN = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[.*?\]\]>|<!.*?>|</[^>]*>|<(?P<tag>[^\s/>]+)(?P<said>(?:\"[^\"]*\"|'[^']*'|[^>\"'])*?)(?P<end>/?)>|[^<]+|<",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"([\w:.-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")


@functools.lru_cache(maxsize=512)
def _parsed(text: str) -> _Node:
    """A node without a tag, in which everything is; not to be changed."""
    top = _Node("", [], [])
    stack = [top]
    for token in _TOKEN.finditer(text):
        said = token[0]
        if token["tag"]:
            attributes = [
                (m[1], (m[2] or m[3] or "").replace('"', "&quot;")) for m in _ATTRIBUTE.finditer(token["said"])
            ]
            node = _Node(token["tag"], attributes, [])
            stack[-1].inside.append(node)
            if not token["end"]:
                stack.append(node)
        elif said.startswith("</"):
            if len(stack) > 1:
                stack.pop()
        else:
            stack[-1].inside.append(said)
    return top


def _all(top: _Node) -> Iterator[tuple[_Node, _Node]]:
    """Every element below, and that around it."""
    stack = [top]
    while stack:
        around = stack.pop()
        for inner in around.inside:
            if not isinstance(inner, str):
                yield inner, around
                stack.append(inner)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


class _Xml:
    """A tree that is changed."""

    def __init__(self, text: str, grammar: Grammar, known: _Known, rng: random.Random):
        self.top, self.grammar, self.known, self.rng = _parsed(text).copy(), grammar, known, rng

    def text(self) -> str:
        """As written."""
        out: list[str] = []
        self.top.write(out)
        return "".join(out)

    def change(self) -> None:
        """Once."""
        nodes = list(_all(self.top))
        if nodes:
            node, around = self.rng.choice(nodes)
            self.rng.choice(_XML_CHANGES)(self, node, around, nodes)

    def value(self, name: str, old: str) -> str:
        """Another value of an attribute, or text of an element."""
        rng, kind = self.rng, self.rng.randrange(10)
        if kind < 3:
            return _piece(old, rng)
        if kind == 3:
            return rng.choice(NUMBERS)
        if kind == 4:
            return _escaped(rng.choice((*TEXTS, *self.grammar.values)))
        if kind == 5 and self.grammar.words:
            return rng.choice(self.grammar.words)
        if kind == 6 and (others := self.known.values.get(name)):
            return rng.choice(others)
        if kind == 7:
            return _escaped(rng.choice(self.grammar.values or TEXTS))
        node, _ = rng.choice(list(_all(self.top)))
        return rng.choice(node.attributes)[1] if node.attributes else old

    def delete(self, node, around, nodes):
        around.inside.remove(node)

    def double(self, node, around, nodes):
        copies = self.rng.choice((1, 1, 1, 1, 1, 1, 2, 3, MANY))
        at = around.inside.index(node)
        around.inside[at:at] = [node.copy() for _ in range(copies)]

    def move(self, node, around, nodes):
        to, _ = self.rng.choice(nodes)
        if all(other is not to for other, _ in [(node, None), *_all(node)]):
            around.inside.remove(node)
            to.inside.insert(self.rng.randrange(len(to.inside) + 1), node)

    def copy_into(self, node, around, nodes):
        to, _ = self.rng.choice(nodes)
        to.inside.insert(self.rng.randrange(len(to.inside) + 1), node.copy())

    def of_another(self, node, around, nodes):
        piece = self.rng.choice(self.known.pieces).copy()
        node.inside.insert(self.rng.randrange(len(node.inside) + 1), piece)

    def beside_another(self, node, around, nodes):
        """Put in an element of a seed where one of its tag stands."""
        piece = self.rng.choice(self.known.pieces)
        places = [place for place in nodes if place[0].tag == piece.tag] or [(node, around)]
        beside, around = self.rng.choice(places)
        at = around.inside.index(beside)
        around.inside[at : at + self.rng.randrange(2)] = [piece.copy()]

    def wrap(self, node, around, nodes):
        at = around.inside.index(node)
        around.inside[at] = _Node(self.tag(), [], [node])

    def unwrap(self, node, around, nodes):
        at = around.inside.index(node)
        around.inside[at : at + 1] = node.inside

    def turn(self, node, around, nodes):
        self.rng.shuffle(around.inside)

    def rename(self, node, around, nodes):
        node.tag = self.tag()

    def tag(self) -> str:
        words = self.grammar.words
        word = self.rng.choice(words if words and self.rng.random() < 0.4 else self.known.tags)
        return word if _NAME.fullmatch(word) else "a"

    def new(self, node, around, nodes):
        tag = self.tag()
        made = _Node(tag, [], [])
        for name in set(self.known.names.get(tag, ())):
            made.attributes.append((name, self.rng.choice(self.known.values[name])))
        node.inside.insert(self.rng.randrange(len(node.inside) + 1), made)

    def attribute(self, node, around, nodes):
        if not node.attributes:
            return self.content(node, around, nodes)
        at = self.rng.randrange(len(node.attributes))
        name, value = node.attributes[at]
        node.attributes[at] = (name, self.value(name, value))

    def no_attribute(self, node, around, nodes):
        if node.attributes:
            del node.attributes[self.rng.randrange(len(node.attributes))]

    def other_attribute(self, node, around, nodes):
        """Add one, or put one in the place of another."""
        names = self.known.names.get(node.tag)
        name = self.rng.choice(names if names and self.rng.random() < 0.5 else self.grammar.words or ["name"])
        if not _NAME.fullmatch(name):
            return
        values = self.known.values.get(name)
        value = self.rng.choice(values) if values and self.rng.random() < 0.7 else self.value(name, "1")
        keep = [pair for pair in node.attributes if pair[0] != name]
        if keep and self.rng.random() < 0.3:
            keep.pop(self.rng.randrange(len(keep)))
        node.attributes = [*keep, (name, value)]

    def exchange(self, node, around, nodes):
        """Two elements of a tag exchange their attributes, or the values of one."""
        alike = [other for other, _ in nodes if other.tag == node.tag and other is not node]
        if alike:
            other = self.rng.choice(alike)
            node.attributes, other.attributes = other.attributes, node.attributes

    def same(self, node, around, nodes):
        """Give an attribute the value of one of its name elsewhere: names that are there twice, circles."""
        if node.attributes:
            at = self.rng.randrange(len(node.attributes))
            name = node.attributes[at][0]
            others = [v for other, _ in nodes for n, v in other.attributes if n == name or n == "name"]
            if others:
                node.attributes[at] = (name, self.rng.choice(others))

    def content(self, node, around, nodes):
        texts = [k for k, inner in enumerate(node.inside) if isinstance(inner, str)]
        if texts:
            at = self.rng.choice(texts)
            node.inside[at] = self.value(node.tag, node.inside[at])
        elif not node.inside:
            node.inside.append(self.value(node.tag, "1"))

    def strange(self, node, around, nodes):
        """Put in what parsers know beside elements."""
        node.inside.insert(self.rng.randrange(len(node.inside) + 1), self.rng.choice(_STRANGE))


_NAME = re.compile(r"[A-Za-z_][\w.-]*(?::[A-Za-z_][\w.-]*)?")
_STRANGE = (
    "<!-- -->", "<?x y?>", "<![CDATA[1 2 3]]>", "&#10;", "&#x20;", "&amp;", "text", " ", "&lt;",
    "<a:b xmlns:a='c'/>", "&#0;",
    "<b xmlns='http://www.collada.org/2005/11/COLLADASchema'/>", "\u00e4",
)  # fmt: skip
_Change = Callable[[_Xml, _Node, _Node, list], None]
_XML_CHANGES: tuple[_Change, ...] = (
    *(6 * [_Xml.attribute]), *(2 * [_Xml.content]), _Xml.same, _Xml.same, _Xml.no_attribute, _Xml.other_attribute,
    _Xml.other_attribute, _Xml.delete, _Xml.double, _Xml.move, _Xml.copy_into, _Xml.of_another, _Xml.beside_another,
    _Xml.beside_another, _Xml.wrap, _Xml.unwrap, _Xml.turn, _Xml.rename, _Xml.new, _Xml.exchange, _Xml.strange,
)  # fmt: skip


# TOML


@dataclass(slots=True, eq=False)
class _Table:
    header: str
    entries: list[tuple[str, str]]
    """Keys and the texts of their values; a line that is neither has no key."""


_HEADER = re.compile(r"\[.*\]\s*(?:#.*)?")
_ENTRY = re.compile(r"\s*([\w.\"'-]+)\s*=\s*(.*)")


@functools.lru_cache(maxsize=1024)
def _tables(text: str) -> tuple[_Table, ...]:
    """Not to be changed."""
    out = [_Table("", [])]
    open_brackets = 0
    for line in text.split("\n"):
        if open_brackets > 0 and out[-1].entries:
            key, value = out[-1].entries[-1]
            out[-1].entries[-1] = key, f"{value}\n{line}"
        elif _HEADER.fullmatch(line):
            out.append(_Table(line, []))
            continue
        elif entry := _ENTRY.fullmatch(line):
            out[-1].entries.append((entry[1], entry[2]))
        elif line.strip():
            out[-1].entries.append(("", line))
        if out[-1].entries:
            value = out[-1].entries[-1][1]
            open_brackets = value.count("[") + value.count("{") - value.count("]") - value.count("}")
    return tuple(out)


_VALUES = (
    "true", "false", '""', '"a"', "[]", "{}", "[1, 2, 3]", "[0, 0, 0]", "[[1, 2], [3]]", "[1, 0, 0, 0]",
    '["a", "b"]', '["a", "a"]',
    '["a"]', "1979-05-27", "1979-05-27T07:32:00Z", "07:32:00",
    '{x = 1}', '{type = "sine"}', '{type = "table", file = "p.csv"}',
    '"""\n\n"""', "'''a'''", "[" * 30 + "]" * 30, "0x10", "0b1", "1_000", "+inf", "-nan",
    '"\\u202e"', '"a/b"', '[inf, -inf]',
    '{type = "expression", expression = "t"}', '[{}]', '[[]]',
)  # fmt: skip


class _Toml:
    """Tables that are changed."""

    def __init__(self, text: str, grammar: Grammar, known: _Known, rng: random.Random):
        self.tables = [_Table(table.header, list(table.entries)) for table in _tables(text)]
        self.grammar, self.known, self.rng = grammar, known, rng

    def text(self) -> str:
        """As written."""
        out: list[str] = []
        for table in self.tables:
            if table.header:
                out.append(table.header)
            out += [f"{key} = {value}" if key else value for key, value in table.entries]
        return "\n".join([*out, ""])

    def change(self) -> None:
        """Once."""
        first = 2 if len(self.tables) > 2 and self.rng.random() < 0.9 else 0  # those without which nothing else is read
        at = self.rng.randrange(first, len(self.tables))
        self.rng.choice(_TOML_CHANGES)(self, self.tables[at], at)
        if not self.tables:
            self.tables = [_Table("", [])]

    def value(self, name: str, old: str) -> str:
        """Another value of a key."""
        rng, kind = self.rng, self.rng.randrange(8)
        if kind < 3 and old[:1] == old[-1:] == '"':
            return f'"{_piece(old[1:-1], rng)}"'
        if kind < 3:
            return _piece(old, rng)
        if kind == 3:
            return rng.choice(NUMBERS)
        if kind == 4:
            word = rng.choice((*TEXTS, *self.grammar.values))
            return '"' + word.replace("\\", "\\\\").replace('"', '\\"').replace("\x7f", "\\u007f") + '"'
        if kind == 5:
            return f'"{rng.choice(self.grammar.words or ("a",))}"'
        if kind == 6:
            return rng.choice(_VALUES)
        return rng.choice(self.known.values.get(name) or _VALUES)

    def entry(self, table, at):
        if table.entries:
            k = self.rng.randrange(len(table.entries))
            name, value = table.entries[k]
            table.entries[k] = (name, self.value(name, value))

    def same(self, table, at):
        """Give a key the value of one elsewhere."""
        entries = [entry for other in self.tables for entry in other.entries]
        if table.entries and entries:
            k = self.rng.randrange(len(table.entries))
            name = table.entries[k][0]
            alike = [value for other, value in entries if other in (name, "name")]
            table.entries[k] = (name, self.rng.choice(alike or [self.rng.choice(entries)[1]]))

    def no_entry(self, table, at):
        if table.entries:
            del table.entries[self.rng.randrange(len(table.entries))]

    def other_entry(self, table, at):
        """Add a key, or put one in the place of another."""
        names = self.known.names.get(table.header)
        name = self.rng.choice(names if names and self.rng.random() < 0.5 else self.grammar.words or ["name"])
        values = self.known.values.get(name)
        value = self.rng.choice(values) if values and self.rng.random() < 0.7 else self.value(name, "1")
        if not re.fullmatch(r"[\w-]+", name):
            return
        keep = [entry for entry in table.entries if entry[0] != name]
        if keep and self.rng.random() < 0.3:
            keep.pop(self.rng.randrange(len(keep)))
        table.entries = [*keep, (name, value)]

    def delete(self, table, at):
        if len(self.tables) > 1:
            del self.tables[at]

    def double(self, table, at):
        copies = self.rng.choice((1, 1, 1, 1, 1, 1, 2, 3, MANY))
        self.tables[at:at] = [_Table(table.header, list(table.entries)) for _ in range(copies)]

    def move(self, table, at):
        del self.tables[at]
        self.tables.insert(self.rng.randrange(len(self.tables) + 1), table)

    def of_another(self, table, at):
        piece = self.rng.choice(self.known.pieces)
        self.tables.insert(at + 1, _Table(piece.header, list(piece.entries)))

    def header(self, table, at):
        table.header = self.rng.choice([tag for tag in self.known.tags if tag.startswith("[[")] or ["[[a]]"])

    def new_header(self, table, at):
        words = [word for word in self.grammar.words if re.fullmatch(r"[\w-]+", word)] or ["a"]
        name = ".".join(self.rng.choice(words) for _ in range(self.rng.choice((1, 1, 2))))
        table.header = self.rng.choice((f"[{name}]", f"[[{name}]]", f"[[function.{name}]]"))


_TOML_CHANGES = (
    *(6 * [_Toml.entry]), *(2 * [_Toml.same]), _Toml.no_entry, *(3 * [_Toml.other_entry]), _Toml.delete, _Toml.double,
    _Toml.move, *(2 * [_Toml.of_another]), _Toml.header, _Toml.new_header,
)  # fmt: skip
