"""xacro's macro processor with an evaluator, a lexer and a reader of files of kinform's own.

The package `xacro` (written for 2.1.1) expands macros, blocks, conditions and includes on an XML tree. What of it
evaluates, reads files or asks the system is replaced here (`_REPLACED`), for as long as one file is expanded:
expressions go to `expressions`, files come from `ask`, and the environment is not there. `unfit` says why a version of
the package cannot be confined in this way: a replaced function is not there with its parameters, or another one uses a
name of `_FORBIDDEN`.
"""

from __future__ import annotations

import io
import json
import keyword
import re
import sys
import unicodedata
import warnings
from collections.abc import Iterator, Mapping
from types import CodeType, FunctionType
from typing import Any

from kinform.formats.urdf.reading.expressions import (
    Budget,
    Function,
    Language,
    Names,
    NotAllowed,
    functions,
    maths,
    more_functions,
    too_large,
)
from kinform.formats.urdf.reading.yaml_data import load_plain
from kinform.foundation.confined import Ask

NODES = 100_000
"""Nodes (elements, texts, comments) that are expanded, at most: about two seconds. Public robots have up to 12,000."""
SIBLINGS = 10_000
"""Nodes inside one element, at most: adding one looks through all. Public robots have up to 250."""
TEXT_LENGTH = 1_000_000
"""Characters of one text or attribute. The longest of a public robot has some 1,000."""
TEXTS_LENGTH = 16_000_000
"""Characters of all texts together that are expanded; of a public robot up to 160,000."""
FRAMES = 3000
"""Calls inside each other, of which macros that are nested take some ten each."""
RUN_ALL = "allow this with --allow-xacro, which runs code of the file"
"""The remedy for what only xacro itself does."""
RUNS_CODE = f"write the value in its place, or {RUN_ALL}"
"""The remedy for what is only evaluated by xacro itself."""

_REPLACED: Mapping[str, tuple[str, ...]] = {
    "safe_eval": ("expr", "globals", "locals"),
    "eval_text": ("text", "symbols"),
    "eval_extension": ("s",),
    "eval_all": ("node", "macros", "symbols"),
    "get_include_files": ("filename_spec", "symbols"),
    "load_yaml": ("filename",),
    "parse": ("inp", "filename"),
    "parse_macro_arg": ("s",),
    "is_valid_name": ("name",),
    "create_global_symbols": (),
    "warning": (),
    "print_location": (),
}
"""Functions of xacro that are replaced, and their parameters."""
_UNUSED = ("_process", "process", "main", "open_output", "error", "message", "process_args", "QuickLexer")
"""What the expansion does not use."""
_USED: Mapping[str, tuple[str, ...]] = {"process_file": ("input_file_name",), "process_doc": ("doc", "mappings")}
_FORBIDDEN = frozenset(
    "eval exec compile __import__ import_module open glob iglob environ getenv getattr __builtins__ globals locals "
    "system popen subprocess socket load yaml getcwd listdir".split()
)
"""Names that the functions which are left in place do not use."""


class Refused(NotAllowed):
    """The file asks for what is not allowed, or for too much."""


def unfit(xacro: Any) -> str | None:
    """Why this xacro cannot be confined; None where it can."""
    import xacro.xmlutils as xmlutils

    for name, parameters in {**_REPLACED, **_USED}.items():
        code = getattr(getattr(xacro, name, None), "__code__", None)
        if code is None or code.co_varnames[: code.co_argcount] != parameters:
            return f"its function {name} is another one"
    for name in ("Table", "NameSpace", "YamlDictWrapper", "YamlListWrapper", "XacroException", "ConstructUnits"):
        if not isinstance(getattr(xacro, name, None), type):
            return f"its class {name} is not there"
    for module in (xacro, xmlutils):
        for name, value in vars(module).items():
            owner = getattr(value, "__module__", None)
            if owner not in (xacro.__name__, xmlutils.__name__) or name in _REPLACED or name in _UNUSED:
                continue
            inner = vars(value).values() if isinstance(value, type) else (value,)
            for one in inner:
                function = getattr(one, "__func__", one)
                strange = _names(function.__code__) & _FORBIDDEN if isinstance(function, FunctionType) else None
                if strange:
                    return f"its {name} uses {min(strange)}"
    return None


def _names(code: CodeType) -> set[str]:
    """Names that a function uses, those inside it too."""
    out = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            out |= _names(constant)
    return out


def prepare() -> None:
    """Import whatever an expansion may need: afterwards nothing is imported."""
    import xml.dom.expatbuilder
    import xml.dom.minidom

    import xacro
    import xacro.substitution_args  # noqa: F401

    xml.dom.minidom.parseString("<a/>")
    warnings.simplefilter("ignore")
    sys.setrecursionlimit(max(FRAMES, sys.getrecursionlimit()))


def expand(path: str, text: bytes, ask: Ask) -> bytes:
    """What the file at `path` with this `text` expands to, as a reply in JSON; other files come from `ask`.

    The reply has `text`; or `words`, and where they are known `remedy`, `file`, `expression`.
    """
    import xacro

    work = _Expansion(xacro, path, text, ask)
    try:
        with work.in_place():
            reply: dict[str, Any] = {"text": str(xacro.process_file(path).toxml())}
            if len(reply["text"]) > 2 * TEXTS_LENGTH:
                raise too_large()
            reply["text"].encode()
    except RecursionError:
        reply = {"words": "macros or includes contain themselves", "remedy": "remove one of them"}
    except MemoryError:
        reply = {"memory": True}
    except UnicodeEncodeError:
        reply = {"words": "makes a text that is no Unicode", "remedy": "remove halves of surrogate pairs"}
    except (Exception, SystemExit) as error:  # xacro raises whatever its expressions raise
        reply = _fault(error)
    if "text" not in reply and xacro.filestack:
        reply["file"] = str(xacro.filestack[-1])
    return json.dumps(reply).encode()


def _fault(error: BaseException) -> dict[str, Any]:
    """What an exception says, that of the evaluator before what xacro makes of it."""
    for one in _causes(error):
        if isinstance(one, NotAllowed):
            return {"words": one.words, "remedy": one.remedy, "expression": one.expression, "refused": True}
        if isinstance(one, MemoryError):
            return {"memory": True}
        if isinstance(one, RecursionError):
            return {"words": "macros or includes contain themselves", "remedy": "remove one of them"}
    return {"words": " ".join(str(error).split()) or type(error).__name__}


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """The exception, and those that it was raised for."""
    for _ in range(100):
        if error is None:
            return
        yield error
        error = getattr(error, "exc", None) or error.__cause__ or error.__context__


_TOKEN = re.compile(r"(\$\$+[{(])|(\$\{[^}]*\})|(\$\([^)]*\))|([^$]+|\$[^{($]+|\$$)")
"""As xacro's: several $ before a bracket, an expression, a substitution, other text."""
_COMMANDS = ("find", "env", "optenv", "dirname", "arg")


class _Expansion:
    """What takes the places of functions of xacro while a file is expanded."""

    def __init__(self, xacro: Any, path: str, text: bytes, ask: Ask):
        self.xacro, self.path, self.text, self.ask = xacro, path, text, ask
        self.language = Language((xacro.YamlDictWrapper,), (xacro.YamlListWrapper,), (xacro.NameSpace,))
        self.budget = Budget()
        self.nodes = self.characters = 0
        self.eval_all_of_xacro = xacro.eval_all

    def in_place(self) -> _InPlace:
        """A context in which xacro has these functions."""
        by_name: dict[str, Any] = {name: getattr(self, name, None) for name in _REPLACED}
        by_name |= {"_global_symbols": self.symbols(), "all_includes": [], "substitution_args_context": {},
                    "verbosity": 0, "filestack": None, "macrostack": None, "root_dir": "."}  # fmt: skip
        return _InPlace(self.xacro, by_name)

    # what xacro calls

    def safe_eval(self, expr: str, globals: Any, locals: Any = None) -> Any:
        """The value of an expression."""
        try:
            return self.language.evaluate(expr, globals, self.budget)
        except NotAllowed as error:
            error.expression = error.expression or expr.strip()
            raise

    def eval_text(self, text: str | None, symbols: Any) -> Any:
        """The text with its expressions evaluated; the value itself where it is one expression and nothing else."""
        out: list[Any] = []
        position, text = 0, text or ""
        self.spend_characters(len(text))
        while position < len(text):
            token = _TOKEN.match(text, position)
            if token is None:
                raise self.xacro.XacroException("invalid expression: " + text[position:])
            position, said = token.end(), token[0]
            if token[2]:
                out.append(self.expression(said[2:-1], symbols))
            elif token[3]:
                out.append(self.eval_extension(f"$({self.eval_text(said[2:-1], symbols)})"))
            else:
                out.append(said[1:] if token[1] else said)
        if len(out) == 1:
            return out[0] if type(out[0]) is str else self.language.checked(out[0], self.budget)
        texts = [one if type(one) is str else self.written(one) for one in out]
        self.spend_characters(sum(map(len, texts)))
        return "".join(texts)

    def expression(self, said: str, symbols: Any) -> Any:
        """The value of an expression in braces, in which substitutions may stand."""
        try:
            inner = self.eval_text(said, symbols)
            if not isinstance(inner, str):
                raise TypeError("an expression is a text")
            return self.safe_eval(inner, symbols)
        except (NotAllowed, RecursionError, MemoryError):
            raise
        except Exception as error:
            suffix = f"\nwhen evaluating expression '{said}'"
            raise self.xacro.XacroException(exc=error, suffix=suffix) from error

    def written(self, value: Any) -> str:
        """As a text."""
        self.language.checked(value, self.budget)
        return str(value)

    def eval_extension(self, s: str) -> str:
        """A substitution: $(arg NAME), $(find PACKAGE), $(eval EXPRESSION), $(cwd)."""
        if s == "$(cwd)":
            return self.asked("cwd", "")
        if s.startswith("$(eval ") and s.endswith(")"):
            return self.written(self.safe_eval(s[7:-1], _Arguments(self.arguments())))
        return self.substituted(self.substituted(s, _COMMANDS), ("find",))

    def substituted(self, text: str, commands: tuple[str, ...]) -> str:
        """The text with these substitutions made."""
        try:
            stated = self.xacro.substitution_args._collect_args(text)
        except self.xacro.substitution_args.SubstitutionException as error:
            raise self.xacro.XacroException(str(error)) from None
        out = text
        for one in stated:
            command, *given = one.split() or [""]
            if command not in _COMMANDS:
                raise self.xacro.XacroException(f"Unknown substitution command [{one}]")
            if command in commands:
                out = out.replace(f"$({one})", self.substitution(one, command, given))
                self.spend_characters(len(out))
        return out

    def substitution(self, said: str, command: str, given: list[str]) -> str:
        """The value of one substitution."""
        if command in ("env", "optenv"):
            raise Refused(f"reads the environment: $({said})", RUNS_CODE)
        if command == "dirname":
            raise self.xacro.XacroException("Cannot substitute $(dirname), no file/directory information available.")
        if len(given) != 1:
            raise self.xacro.XacroException(f"$({command} NAME) takes one name [{said}]")
        if command == "find":
            return self.asked("package", given[0])
        try:
            return str(self.arguments()[given[0]])
        except KeyError:
            raise self.xacro.XacroException(f"Undefined substitution argument {given[0]}") from None

    def arguments(self) -> dict[str, Any]:
        """Values of xacro:arg."""
        out: dict[str, Any] = self.xacro.substitution_args_context.setdefault("arg", {})
        return out

    def eval_all(self, node: Any, macros: Any, symbols: Any) -> None:
        """As xacro's; counts what is expanded."""
        self.nodes += 1 + len(node.childNodes)
        siblings = max(len(node.childNodes), len(node.parentNode.childNodes) if node.parentNode else 0)
        if self.nodes > NODES or siblings > SIBLINGS:
            what = f"{NODES:,} nodes" if self.nodes > NODES else f"{SIBLINGS:,} nodes in one element"
            raise Refused(
                f"expands to more than {what}: do its macros call each other more than once?",
                "call them in turn; or expand it yourself: xacro F.urdf.xacro > F.urdf",
            )
        self.eval_all_of_xacro(node, macros, symbols)

    def get_include_files(self, filename_spec: str, symbols: Any) -> Iterator[str]:
        """Names of the files that an include means: one, or those that a pattern fits."""
        stated = self.written(self.eval_text(filename_spec, symbols))
        spec = self.xacro.abs_filename_spec(stated)
        names = json.loads(self.asked("glob", spec)) if re.search("[*[?]+", spec) else [spec]
        for name in names:
            yield str(name)

    def load_yaml(self, filename: str) -> Any:
        """The content of a YAML file as plain data."""
        filename = self.xacro.abs_filename_spec(filename)
        data = self.file("yaml", filename)
        if data is None:
            raise FileNotFoundError(2, "No such file or directory", filename)
        self.xacro.filestack.append(filename)
        try:
            units = {unit.value.tag: unit.value.conversion_constant for unit in self.xacro.ConstructUnits}
            value = load_plain(data, units, lambda text: self.safe_eval(text, self.xacro._global_symbols))
            return self.xacro.YamlListWrapper.wrap(self.language.checked(value, self.budget))
        finally:
            self.xacro.filestack.pop()

    def parse(self, inp: Any, filename: str | None = None) -> Any:
        """The XML tree of a file, which is asked for unless it is the first."""
        first = self.text is not None and filename == self.path
        data = self.text if first else self.file("xml", str(filename))
        if data is None:
            self.xacro.filestack.pop()  # the file at fault is the one that includes it
            missing = FileNotFoundError(2, "No such file or directory", filename)
            raise self.xacro.XacroException(f"No such file or directory: {filename}", exc=missing)
        stream = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8")
        return self.xacro.xml.dom.minidom.parse(stream)

    def parse_macro_arg(self, s: str) -> tuple[str, tuple[str | None, str | None] | None, str]:
        """The first parameter of a macro, its default, and the others, as xacro's."""
        self.spend_characters(len(s))
        return first_parameter(s, self.budget)

    def is_valid_name(self, name: str) -> bool:
        """Whether a property may have the name."""
        return name.isidentifier() and not keyword.iskeyword(name) and unicodedata.normalize("NFKC", name) == name

    def create_global_symbols(self) -> Names:
        """The functions and constants of expressions."""
        return self.symbols()

    def warning(self, *said: Any, **how: Any) -> None:
        """Nothing: a confined process has no terminal."""

    def print_location(self) -> None:
        """Nothing."""

    # what expressions call

    def symbols(self) -> Names:
        """All names that an expression knows without a property."""
        own = Names(
            {
                function.name: function
                for function in (
                    Function("load_yaml", self.load_yaml),
                    Function("abs_filename", self.xacro.abs_filename_spec),
                    Function("dotify", self.dotted),
                )
            }
        )
        said = {name: Function(name, lambda *_, **__: "") for name in ("message", "warning", "error", "print_location")}
        more = (Function("arg", self.argument), Function("fatal", self.fatal), Function("tokenize", self.tokens))
        out = Names({**functions(), **maths(), **own})
        out["math"], out["python"] = maths(), more_functions()
        out["xacro"] = Names({**own, **said, **{function.name: function for function in more}})
        return out

    def argument(self, name: str) -> Any:
        """The value of xacro:arg."""
        return self.arguments()[name]

    def fatal(self, *said: Any) -> None:
        """Raise what the file says is wrong."""
        raise self.xacro.XacroException(" ".join(map(self.written, said)))

    def dotted(self, mapping: Any) -> Any:
        """A mapping whose items are read with a dot."""
        if not isinstance(mapping, dict):
            raise TypeError("a dict is expected")
        return self.xacro.YamlDictWrapper(mapping)

    def tokens(self, s: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
        """The text parted at each of the characters `sep`."""
        if not isinstance(sep, str) or not sep or set(sep) & set("[]\\^") or len(sep) > 100:
            raise NotAllowed("splits a text at what kinform does not evaluate", "split it at plain characters")
        parts = re.split(f"[{sep}]", s)
        return [part for part in parts if part] if skip_empty else parts

    # what the parent answers

    def asked(self, kind: str, name: str) -> str:
        """What the parent says to a question other than for a file."""
        data = self._answer(kind, name)
        assert data is not None
        return data.decode("utf-8", "surrogateescape")

    def file(self, kind: str, name: str) -> bytes | None:
        """The content of a file of XML or YAML; None where there is none."""
        return self._answer(kind, name)

    def _answer(self, kind: str, name: str) -> bytes | None:
        at = self.xacro.filestack[-1] if self.xacro.filestack else None
        reply = self.ask(json.dumps({"kind": kind, "name": name, "at": at}).encode())
        if reply[:1] == b"-":
            said = json.loads(reply[1:])
            if said.get("missing"):
                return None
            raise Refused(said["words"], said["remedy"])
        return reply[1:]

    def spend_characters(self, many: int) -> None:
        """Raise NotAllowed for a text, or for texts, without end."""
        self.characters += many
        if many > TEXT_LENGTH or self.characters > TEXTS_LENGTH:
            most = TEXT_LENGTH if many > TEXT_LENGTH else TEXTS_LENGTH
            raise Refused(f"makes a text of more than {most:,} characters", "shorten it")


class _InPlace:
    """Attributes of a module for a while."""

    def __init__(self, module: Any, values: Mapping[str, Any]):
        self.module, self.values = module, values

    def __enter__(self) -> None:
        self.before = {name: getattr(self.module, name) for name in self.values}
        for name, value in self.values.items():
            setattr(self.module, name, value)

    def __exit__(self, *_: object) -> None:
        for name, value in self.before.items():
            if name != "filestack":  # says where it was
                setattr(self.module, name, value)


class _Arguments:
    """The names that $(eval …) knows: constants and functions, then the arguments, as numbers where they are such."""

    def __init__(self, arguments: Mapping[str, Any]):
        self.arguments = arguments
        self.names = Names({**functions(), **maths(), "true": True, "false": False})
        self.names["arg"] = Function("arg", lambda name: _number(self.arguments[name]))

    def __getitem__(self, name: str) -> Any:
        if name in ("env", "optenv", "find", "dirname"):
            raise Refused(f"uses {name} in $(eval …), which kinform does not evaluate", RUNS_CODE)
        return self.names[name] if name in self.names else _number(self.arguments[name])


def _number(text: Any) -> Any:
    """The value of an argument: a number, true or false, else the text."""
    text = str(text)
    try:
        return float(text) if "." in text else int(text)
    except ValueError:
        return {"true": True, "false": False, "1": True, "0": False}.get(text.lower(), text)


_PARAMETER = re.compile(r"\s*([^\s:=]+?)\s*:?=(\s*)(\^\|?)?")
_REST = re.compile(r"(?:\s+|$)(.*)")
_BREAK = re.compile(r"\s|$")
_PLAIN = re.compile(r"[^\s'\"]+")


def first_parameter(s: str, budget: Budget) -> tuple[str, tuple[str | None, str | None] | None, str]:
    """The first of the parameters of a macro, as in `name:=default`; what is forwarded and the default, None without;
    and the other parameters. It reads as xacro's pattern does, in square time where that takes exponential."""
    stated = _PARAMETER.match(s)
    if stated is not None:
        end = _end_of_default(s, stated.end(), budget)
        start, forwards = stated.end(), bool(stated[3])
        if end is None and stated[2]:  # no default can be read: it is empty, and what follows is a parameter
            start = end = stated.end(2) - 1
            forwards = False
        if end is not None:
            rest = _REST.match(s, end)
            assert rest is not None
            return stated[1], (stated[1] if forwards else None, s[start:end] or None), rest[1]
    first, *others = s.lstrip().split(None, 1)
    return first, None, others[0] if others else ""


def _end_of_default(s: str, start: int, budget: Budget) -> int | None:
    """Where the default ends that begins at `start`: after a braced expression, else after quoted and plain texts, of
    which a quote may go on beyond the next one; what follows is a space or the end. None where it ends nowhere."""
    for opening, closing in (("${", "}"), ("$(", ")")):
        if s.startswith(opening, start):
            for end in _ends(s, closing, start + 2):
                if _BREAK.match(s, end):
                    return end
    failed: set[int] = set()
    places, trail = [start], [_pieces(s, start)]
    while trail:
        end = next(trail[-1], -1)
        budget.spend(1)
        if end < 0:
            trail.pop()
            place = places.pop()
            if _BREAK.match(s, place):
                return place
            failed.add(place)
        elif end not in failed:
            trail.append(_pieces(s, end))
            places.append(end)
    return None


def _pieces(s: str, start: int) -> Iterator[int]:
    """Where a quoted or plain text that begins there may end, in the order in which they are tried."""
    if s[start : start + 1] in ("'", '"'):
        yield from _ends(s, s[start], start + 1)
        return
    plain = _PLAIN.match(s, start)
    if plain:
        yield plain.end()


def _ends(s: str, closing: str, start: int) -> Iterator[int]:
    """Places behind a closing character, in the same line."""
    line = s.find("\n", start)
    stop = len(s) if line < 0 else line
    place = s.find(closing, start, stop)
    while place >= 0:
        yield place + 1
        place = s.find(closing, place + 1, stop)
