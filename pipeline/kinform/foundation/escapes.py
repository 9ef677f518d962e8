"""Text that strangers may have written, made safe for its reader: one function a kind of reader.

Names of parts, joints, files and materials, and sentences that contain them, come from files of other people. Terminals
obey control characters; direction marks reorder what people read; CI runners obey lines of a log; spreadsheets compute
cells; Make runs commands; parsers reject characters. Every text that leaves kinform passes one of these functions:

- `one_line`: a name or sentence within a line of text
- `lines`: whole text for terminals and logs, last before it is printed or written; `of_terminal` with colours in it
- `json_text`, `xml_text`: documents that are complete, of which nothing changes for their parsers
- `xml`, `html`, `csv_cell`, `quoted`, `toml`: a value in such a document; `make_name`: a file in a rule of Make

Markdown has its own in `reports.markdown`, identifiers and names of files in `exports.names`.

Runners of GitHub, Gitea and Azure obey `::name …::` at the beginning of a line and `##[name]` or `##vso[name]` anywhere
in it (actions/runner, `ActionCommand.cs`; azure-pipelines-agent, `Command.cs`).
"""

from __future__ import annotations

import re
from collections.abc import Callable

_OTHER = re.compile(r"[^\n\x20-\x7e]+")
"""What may hold characters that are not printable; a line end is not looked at."""
_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 forbids, also as references."""
_COMMANDS = (
    "add-mask|add-matcher|add-path|debug|echo|endgroup|error|group|internal-set-repo-path|notice|remove-matcher|"
    "save-state|set-env|set-output|stop-commands|warning"
)
_COMMAND = re.compile(
    rf"^(?P<before>(?:[ \t]|\x1b\[[0-9;]*m)*):(?=:)|:(?=:(?:{_COMMANDS})(?:[ \t]|::))|#(?=#\w*\[)",
    re.IGNORECASE | re.MULTILINE,
)
"""The first character of what a runner obeys, with what stands before it on its line. In the middle of a line commands
of GitHub are found too: what wraps or cuts the line later may bring them to its beginning."""
_XML = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}
_IN_XML = str.maketrans(_XML | {"\n": "&#10;", "\t": "&#9;"})
_IN_HTML = str.maketrans(_XML | {"'": "&#x27;"})
"""References for what markup is made of, also within attributes; the latter as `html.escape` has them."""
_FORMULA = re.compile(r"(^\s*|;)(?=[=+\-@＝＋－＠])")
"""Where a spreadsheet finds a formula: at the beginning of a cell, and of what is a cell where semicolons separate."""
_UNSAFE_IN_MAKE = re.compile(r"[^\w ./+,@^{}'!()\-#$%:~]|\$.*\(|\)$| $")
"""What no escape carries through Make into a recipe: `=` assigns, `;` begins a command, `|`, `&`, `*`, `?`, `[`, quotes
and backslashes have meanings of their own, `x(y)` is a member of an archive, a blank at the end is lost, and `$(` is a
command where a recipe has `$^`."""
_WORDS_OF_MAKE = frozenset(
    "define else endef endif export ifdef ifeq ifndef ifneq include load override private sinclude undefine unexport "
    "vpath".split()
)


def one_line(text: str) -> str:
    """The text on one line: control characters, ends of lines, direction marks, characters without width and halves of
    characters are escaped as in Python."""
    return text if text.isprintable() else "".join(c if c.isprintable() else _as_in_python(c) for c in text)


def harmless(text: str) -> str:
    """As `one_line`, but lines and tabs stay."""
    return _spelt(text, lambda c: c if c == "\t" else _as_in_python(c))


def lines(text: str) -> str:
    """The text line by line as `one_line`, and no line is a command of a CI runner: the character with which one begins
    is escaped as in Python."""
    return _broken(harmless(text), _as_in_python)


def of_terminal(text: str) -> str:
    """As `lines`, for text whose control characters are escaped already, but for those of our own colours."""
    return _broken(text, _as_in_python)


def json_text(text: str) -> str:
    """A JSON document with the same value that is printed safely: what `lines` escapes stands as \\uXXXX."""
    return _broken(_spelt(text, _as_in_json), _as_in_json)


def xml_text(text: str) -> str:
    """An XML document without comments and sections of CDATA, with the same value, that is printed safely: what `lines`
    escapes stands as references."""
    return _broken(_spelt(text, lambda c: c if c == "\t" else _as_reference(c)), _as_reference)


def xml_legal(text: str) -> str:
    """The text with what XML 1.0 cannot carry escaped as in Python."""
    return _NOT_XML.sub(lambda match: _as_in_python(match[0]), text)


def xml(text: str) -> str:
    """A value in XML that programs read back, for text and for attributes in double quotes; what XML cannot carry is
    escaped as in Python."""
    return xml_text(xml_legal(text).translate(_IN_XML))


def html(text: str) -> str:
    """A text for people in HTML and SVG, also within attributes: on one line as `one_line`."""
    return lines(one_line(text)).translate(_IN_HTML)


def csv_cell(text: str) -> str:
    """A text for a cell of a table: on one line, no formula (an apostrophe goes before what would begin one), and
    quoted where commas or quotes are in it."""
    flat = lines(_FORMULA.sub(r"\1'", one_line(text)))
    return '"' + flat.replace('"', '""') + '"' if set(flat) & set(',"') else flat


def quoted(text: str) -> str:
    """A string of Modelica and DOT, with its quotes, on one line."""
    return '"' + lines(one_line(text)).replace("\\", "\\\\").replace('"', '\\"') + '"'


def toml(text: str) -> str:
    """A basic string of TOML, with its quotes, on one line that is printed safely."""
    quoted = text.replace("\\", "\\\\").replace('"', '\\"')
    for character, short in {"\b": "b", "\t": "t", "\n": "n", "\f": "f", "\r": "r"}.items():
        quoted = quoted.replace(character, "\\" + short)
    return '"' + _broken(_spelt(quoted, _as_in_toml), _as_in_toml) + '"'


def make_name(name: str, *, target: bool = False) -> str | None:
    """The name of a file as Make reads it as a prerequisite or a target; None where no escape makes it one."""
    bare = re.sub(r"^(?:\./+)+", "", name)
    unsafe = _UNSAFE_IN_MAKE.search(name) or not name.isprintable() or bare in _WORDS_OF_MAKE
    # special targets as .IGNORE begin with a dot, and commands that include with a hyphen
    if unsafe or not bare or bare[0] in "-~" or (bare[0] == "." and "/" not in bare):
        return None
    escaped = re.sub(r"([ #:])", r"\\\1", name.replace("$", "$$"))
    # only a target with % is a pattern, and only there the escape is taken off
    return escaped.replace("%", "\\%") if target else escaped


def _spelt(text: str, spell: Callable[[str], str]) -> str:
    """The text with every character but line ends that is not printable spelt otherwise."""

    def of(match: re.Match[str]) -> str:
        found = match[0]
        return found if found.isprintable() else "".join(c if c.isprintable() else spell(c) for c in found)

    return _OTHER.sub(of, text)


def _broken(text: str, spell: Callable[[str], str]) -> str:
    """The text with the first character of each command of a runner spelt otherwise."""
    return _COMMAND.sub(lambda match: (match["before"] or "") + spell(match[0][-1]), text)


def _as_in_python(character: str) -> str:
    return _ESCAPED.get(character) or character.encode("unicode_escape").decode("ascii")


_ESCAPED = {character: f"\\x{ord(character):02x}" for character in ":#"}
"""Printable characters that are escaped."""


def _as_in_json(character: str) -> str:
    code = ord(character)
    if code < 0x10000:
        # halves of characters are no text, and some parsers refuse them
        return "\\ufffd" if 0xD800 <= code < 0xE000 else f"\\u{code:04x}"
    return f"\\u{0xD800 + (code - 0x10000 >> 10):04x}\\u{0xDC00 + (code & 0x3FF):04x}"


def _as_in_toml(character: str) -> str:
    code = ord(character)
    # TOML has no halves of characters, and no escape for them
    return "\\uFFFD" if 0xD800 <= code < 0xE000 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _as_reference(character: str) -> str:
    return f"&#{ord(character)};"
