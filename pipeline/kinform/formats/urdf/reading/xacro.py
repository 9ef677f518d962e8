"""xacro: expanded by the macro processor of the package `xacro`, confined, then read as URDF.

The processor runs in a process of its own (`foundation.confined`), where expressions are evaluated by kinform
(`expansion`, `expressions`). It has no environment and no files but those that `_Host` hands it: the file itself, what
the `boundary` of the design allows, and files of packages that are found. With `--allow-xacro` the package expands the
file by itself, with everything that its expressions may do. Lines are those of the text as written, as far as an
element of that name stands there; else the first.
"""

from __future__ import annotations

import glob
import json
import os
import re
from collections.abc import Iterable
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

from kinform.form.constants import TEXT_BYTES
from kinform.form.problems import Problems
from kinform.formats.description.elements import declares_entities
from kinform.formats.description.mesh_files import MeshFiles, files_below, package_name
from kinform.formats.description.robot import Robot
from kinform.formats.urdf.reading import reader
from kinform.formats.urdf.reading.expansion import RUN_ALL, RUNS_CODE, expand, prepare, unfit
from kinform.foundation.confined import Confined, confined
from kinform.foundation.processes import Crash, in_own_process
from kinform.foundation.regular_files import not_a_file
from kinform.frozen import dataclass

XACRO_FILES = 500
"""Files that one file includes, and files of a package that are looked through for the names of other packages, at
most: a package has a few dozen. Chosen, not measured."""
XACRO_SECONDS = 10
"""Seconds of processor time that the expansion of a xacro file may take: robots take one or two."""
XACRO_MEMORY = 400 << 20
"""Bytes of memory that it may take beside what kinform has; robots take some 50 MB."""
UNCONFINED_MEMORY = 4 << 30
"""Bytes of memory that all of the process may take where xacro runs by itself."""
_QUESTIONS = 20 * XACRO_FILES
"""Questions of one expansion, most of which are for packages."""


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of a xacro file; None where nothing can be made of it, after noting why."""
    try:
        import xacro
    except ImportError:
        remedy = "pip install 'kinform[xacro]', or expand it: xacro F.urdf.xacro > F.urdf"
        problems.add("is xacro, and the package that expands it is not installed", file, None, remedy)
        return None
    if declares_entities(data, file, problems):
        return None
    host = _Host(path, data, file, problems, meshes)
    before = len(problems)
    why = None if meshes.runs_xacro else unfit(xacro)
    try:
        if why is not None:
            words = f"cannot be expanded safely by xacro {getattr(xacro, '__version__', '')}".rstrip() + f": {why}"
            done: _Expanded | _Fault = _Fault(words, f"pip install xacro==2.1.1, or {RUN_ALL}")
        elif meshes.runs_xacro:
            done = _by_xacro(path, data, meshes)
        else:
            done = host.expanded()
    except Confined:
        done = _Fault("does what kinform does not allow while it is expanded", RUNS_CODE)
    except Crash as crash:
        ended = any(signal in crash.cause for signal in ("SIGXCPU", "SIGKILL", "SIGALRM"))
        done = _too_long() if ended else _Fault(crash.cause)
    except MemoryError:
        done = _too_large()
    if isinstance(done, _Fault):
        if len(problems) == before:
            _complain(done, file, path, problems, host.texts)
        return None
    robot = reader.read_text(path, done.text.encode(), file, problems, meshes, data.decode("utf-8", "replace"))
    included = dict.fromkeys(Path(name) for name in done.includes)
    return (
        None if robot is None else replace(robot, files=tuple(included), unsettled=host.unsettled or meshes.runs_xacro)
    )


@dataclass(frozen=True)
class _Expanded:
    text: str
    includes: tuple[str, ...]


@dataclass(frozen=True)
class _Fault:
    words: str
    """What xacro says; or, with a remedy, what is told."""
    remedy: str | None = None
    at: str | None = None
    """The file that it was in."""
    expression: str | None = None
    """The text at which it is."""


def _too_long() -> _Fault:
    words = f"takes more than {XACRO_SECONDS} s to expand: do its macros call each other more than once?"
    return _Fault(words, "call them in turn; or expand it yourself: xacro F.urdf.xacro > F.urdf")


def _too_large() -> _Fault:
    words = "takes too much memory to expand: is there a text or a number without end?"
    return _Fault(words, "shorten what its expressions make; or expand it yourself: xacro F.urdf.xacro > F.urdf")


class _Host:
    """What an expansion is given by the process that asked for it. `texts` are the files that it had, by name."""

    def __init__(self, path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles):
        self.path, self.data, self.file, self.problems, self.meshes = path, data, file, problems, meshes
        self.texts = {str(path): data}
        self.questions = 0
        self.unsettled = False
        """Whether an answer hung on more than what the files hold."""

    def expanded(self) -> _Expanded | _Fault:
        """The text with macros expanded. Raises Crash."""
        reply = confined(lambda ask: expand(str(self.path), self.data, ask), self.answer, prepare,
                         seconds=XACRO_SECONDS, memory=XACRO_MEMORY)  # fmt: skip
        said = json.loads(reply)
        if "text" in said:
            return _Expanded(said["text"], tuple(name for name in self.texts if name != str(self.path)))
        if said.get("memory"):
            return _too_large()
        remedy = said.get("remedy")
        if said.get("refused") and remedy is None:
            remedy = RUNS_CODE
        return _Fault(said["words"], remedy, said.get("file"), said.get("expression"))

    def answer(self, question: bytes) -> bytes:
        """The answer to a question of the expansion: with + what it asks for, with - why not."""
        asked = json.loads(question)
        kind, name = str(asked["kind"]), str(asked["name"])
        self.questions += 1
        if self.questions > _QUESTIONS or len(self.texts) > XACRO_FILES:
            return _no(f"includes more than {XACRO_FILES} files, or asks for too many packages", "include fewer")
        if kind == "cwd":
            return b"+" + os.fsencode(Path.cwd())
        if kind == "package":
            return self._package(name)
        if "\0" in name:
            return _no("includes a file whose name no file can have", "correct the name")
        if kind == "glob":
            return self._fitting(name)
        return self._content(name, self.file_at(str(asked.get("at"))), xml=kind == "xml")

    def file_at(self, at: str) -> str:
        """A file as messages show it."""
        if at == str(self.path):
            return self.file
        return f"{Path(self.file).parent / os.path.relpath(at, self.path.parent)}"

    def _package(self, name: str) -> bytes:
        folder = _package(name, self.meshes)
        if folder is None:
            return _no(f"package {name} is not found", f"add --package {name}=FOLDER, or set ROS_PACKAGE_PATH")
        folder = folder.resolve()
        self.unsettled |= folder != self.meshes.home.resolve()  # a nearer one may come
        self.meshes.boundary.grant(folder)
        return b"+" + os.fsencode(folder.as_posix())

    def _outside(self, name: str) -> bytes:
        shown = Path(os.path.relpath(name, self.path.parent)).as_posix()
        return _no(f"includes {shown}, which lies outside of the design's folder",
                   f"copy it into that folder, name its package with --package, or {RUN_ALL}")  # fmt: skip

    def _fitting(self, pattern: str) -> bytes:
        """Names of the files that a pattern fits, sorted, in JSON."""
        self.unsettled = True  # others may come that it fits
        parts = pattern.split("/")
        first = next((k for k, part in enumerate(parts) if glob.has_magic(part)), len(parts))
        folder = "/".join(parts[:first]) or ("/" if pattern.startswith("/") else ".")
        if ".." in parts[first:] or not self.meshes.boundary.allows(folder):
            return self._outside(pattern)
        names = sorted(glob.glob(pattern))
        if not all(map(self.meshes.boundary.allows, names)):
            return self._outside(pattern)  # which tells no name of what is there
        return b"+" + json.dumps(names[: XACRO_FILES + 1]).encode()

    def _content(self, name: str, at: str, *, xml: bool) -> bytes:
        """The content of a file."""
        if not self.meshes.boundary.allows(name):
            return self._outside(name)
        path = Path(os.path.realpath(name))
        fault = not_a_file(path) or ("is a folder" if path.is_dir() else None)
        shown = Path(os.path.relpath(name, self.path.parent)).as_posix()
        if fault is not None:
            return _no(f"includes {shown}, which {fault}", "name a file")
        try:
            with self.meshes.boundary.open(path) as stream:
                data = stream.read(TEXT_BYTES + 1)
        except FileNotFoundError:
            self.unsettled = True
            return b"-" + json.dumps({"missing": True}).encode()
        except OSError as error:
            return _no(f"includes {shown}, which cannot be read: {error.strerror}", "check its permissions")
        if sum(map(len, self.texts.values())) + len(data) > TEXT_BYTES:
            return _no(f"includes more than {TEXT_BYTES:,} bytes", "include fewer files")
        self.texts[name] = data
        if xml and declares_entities(data, self.file_at(name), self.problems):
            return _no("", "")
        return b"+" + data


def _no(words: str, remedy: str) -> bytes:
    return b"-" + json.dumps({"words": words, "remedy": remedy}).encode()


def _by_xacro(path: Path, data: bytes, meshes: MeshFiles) -> _Expanded | _Fault:
    """What the package xacro itself makes of the file, in a fork that is bounded in time and memory only."""
    from xacrodoc import packages  # xacro asks it where packages are

    wanted = _packages_of(data, meshes.home)
    packages.update_package_cache({name: folder for name in wanted if (folder := _package(name, meshes)) is not None})
    return in_own_process(lambda: _in_the_fork(path))


def _in_the_fork(path: Path) -> _Expanded | _Fault:
    """The text, with macros expanded, and the files that it includes; bounded in time and memory."""
    import xacro

    _bound()
    xacro.all_includes.clear()
    try:
        text = str(xacro.process_file(str(path)).toxml())
    except RecursionError:
        return _Fault("macros or includes contain themselves", "remove one of them", _file_now(xacro))
    except MemoryError:
        return _too_large()
    except (Exception, SystemExit) as error:  # xacro raises whatever its expressions raise
        if isinstance(error.__cause__ or error.__context__, MemoryError):
            return _too_large()
        return _Fault(" ".join(str(error).split()) or type(error).__name__, None, _file_now(xacro))
    return _Expanded(text, tuple(map(str, xacro.all_includes)))


def _file_now(xacro: Any) -> str | None:
    return str(xacro.filestack[-1]) if xacro.filestack else None


def _bound() -> None:
    """This process may not take more than its share of time and memory."""
    try:
        import resource
    except ImportError:
        return
    for kind, most in ((resource.RLIMIT_CPU, XACRO_SECONDS), (resource.RLIMIT_AS, UNCONFINED_MEMORY)):
        soft, hard = resource.getrlimit(kind)
        if soft == resource.RLIM_INFINITY or soft > most:
            resource.setrlimit(kind, (most, hard))


def _complain(fault: _Fault, file: str, path: Path, problems: Problems, texts: dict[str, bytes]) -> None:
    """Note what went wrong, at the line of the file on which it is written as far as the message tells that."""
    words, remedy = fault.words, fault.remedy
    unknown = _NO_PACKAGE.search(words)
    if unknown is not None:
        words = f"package {unknown[1]} is not found"
        remedy = f"add --package {unknown[1]}=FOLDER, or set ROS_PACKAGE_PATH"
    elif remedy is None:
        words, remedy = _told(words, path)
    stated = _LINE.search(fault.words)
    patterns = (_EXPRESSION, _FILE, _NO_PACKAGE, _ABSENT, _INCLUDED, _ENVIRONMENT, *(pattern for pattern, *_ in _SAID))
    said = [m[1] for m in (pattern.search(fault.words) for pattern in patterns) if m is not None]
    if fault.expression is not None:
        said = [fault.expression]
    at = fault.at or str(path)
    if stated:
        name, line = at, int(stated[1])
    else:
        name, line = _place(said, at, texts)
    if name != str(path):
        file = f"{Path(file).parent / os.path.relpath(name, path.parent)}"
    problems.add(words, file, line, remedy)


def _place(said: Iterable[str], at: str, texts: dict[str, bytes]) -> tuple[str, int]:
    """The file and the line at which one of the texts is written, the file `at` before others; else its first line."""
    for name in sorted(texts, key=lambda name: name != at):
        written = texts[name].decode("utf-8", "replace")
        for text in said:
            text = Path(text).name if "/" in text and text not in written else text
            for spelled in (text, escape(text, quote=False), escape(text)):
                place = written.find(spelled) if spelled else -1
                if place >= 0:
                    return name, written.count("\n", 0, place) + 1
    return at, 1


def _told(words: str, path: Path) -> tuple[str, str]:
    """What xacro says, without what is of Python alone, and a remedy."""
    absent = _FILE.search(words)
    if absent is not None:
        return f"the file {os.path.relpath(absent[1], path.parent)} does not exist", "correct the name, or add the file"
    for pattern, said, remedy in _SAID:
        match = pattern.search(words)
        if match is not None:
            return said.format(match[1]), remedy.format(match[1])
    return f"cannot be expanded by xacro: {words}", "correct it, or expand it yourself"


_SAID = (
    (re.compile(r"environment variable '([^']+)' is not set"),
     "the environment variable {} is not set", "set it, or write $(optenv {} DEFAULT)"),
    (re.compile(r"Undefined substitution argument (\S+)"),
     "the argument {} has no value", 'give it one: <xacro:arg name="{}" default="…"/>'),
    (re.compile(r"unknown macro name: (\S+)"),
     "there is no macro {}", "include the file that defines it, or correct the name"),
    (re.compile(r"unbound prefix(): line"),
     "has elements of xacro, and does not declare its name space",
     'write <robot xmlns:xacro="http://www.ros.org/wiki/xacro">'),
)  # fmt: skip
"""What is often wrong: how xacro says it, how it is told, and what to do."""

_LINE = re.compile(r"line (\d+), column")
_EXPRESSION = re.compile(r"evaluating expression '(.+)'")
_FILE = re.compile(r"No such file or directory: '?([^' ]+)")
_NO_PACKAGE = re.compile(r"Package not found: (\S+)")
_ABSENT = re.compile(r"package (\S+) is not found")
_INCLUDED = re.compile(r"includes (.+), which ")
_ENVIRONMENT = re.compile(r"reads the environment: (\S+)")


def _package(name: str, meshes: MeshFiles) -> Path | None:
    """The folder of a package: that of the description, where its package.xml says so, else as for meshes; it has a
    package.xml, or the user names it."""
    if package_name(meshes.home, meshes.boundary) == name:
        return meshes.home
    folder = meshes.package(name)
    known = folder is not None and (name in meshes.packages or package_name(folder, meshes.boundary) is not None)
    return folder if known else None


_FIND = re.compile(rb"\$\(find ([^)\s]+)\)")


def _packages_of(data: bytes, home: Path) -> list[str]:
    """Names of packages that the file, and the xacro files of its package, ask for."""
    beside = files_below(home, (".xacro",))
    texts = [data, *(path.read_bytes() for path in beside[:XACRO_FILES])]
    return sorted({name.decode("utf-8", "replace") for text in texts for name in _FIND.findall(text)})
