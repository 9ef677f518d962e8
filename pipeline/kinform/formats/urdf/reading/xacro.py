"""xacro: expanded by the program of that name, which the optional package xacrodoc brings, then read as URDF.

It runs in a process of its own, which is bounded in time and memory: a few macros can ask for more than there is.
Lines are those of the text as written, as far as an element of that name stands there; else the first.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from kinform.form.problems import Problems
from kinform.formats.description.elements import declares_entities
from kinform.formats.description.mesh_files import MeshFiles, files_below, package_name
from kinform.formats.description.robot import Robot
from kinform.formats.urdf.reading import reader
from kinform.foundation.processes import Crash, in_own_process
from kinform.frozen import dataclass

XACRO_FILES = 500
"""Files of a package that are looked through for the names of other packages, at most: a package has a few dozen.
Chosen, not measured."""
XACRO_SECONDS = 20
"""Seconds of processor time that the expansion of a xacro file may take: robots take one or two, and macros that call
each other twice, thirty deep, never end."""
XACRO_MEMORY = 4 << 30
"""Bytes of memory that it may take, which an expression can ask for with a few letters; robots take some MB."""


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of a xacro file; None where nothing can be made of it, after noting why."""
    try:
        import xacro  # noqa: F401
        from xacrodoc import packages  # xacro asks it where packages are
    except ImportError:
        remedy = "pip install 'kinform[xacro]', or expand it: xacro F.urdf.xacro > F.urdf"
        problems.add("is xacro, and the package that expands it is not installed", file, None, remedy)
        return None
    if declares_entities(data, file, problems):
        return None
    wanted = _packages_of(data, meshes.home)
    folders = {name: folder for name in wanted if (folder := _package(name, meshes)) is not None}
    packages.update_package_cache(folders)
    try:
        done = in_own_process(lambda: _in_the_fork(path))
    except Crash as crash:
        done = _too_long() if "SIGXCPU" in crash.cause or "SIGKILL" in crash.cause else _Fault(crash.cause)
    except MemoryError:
        done = _too_large()
    if isinstance(done, _Fault):
        _complain(done, file, path, problems)
        return None
    robot = reader.read_text(path, done.text.encode(), file, problems, meshes, data.decode("utf-8", "replace"))
    included = dict.fromkeys(Path(name) for name in done.includes)
    return None if robot is None else replace(robot, files=tuple(included))


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


def _too_long() -> _Fault:
    words = f"takes more than {XACRO_SECONDS} s to expand: do its macros call each other more than once?"
    return _Fault(words, "call them in turn; or expand it yourself: xacro F.urdf.xacro > F.urdf")


def _too_large() -> _Fault:
    words = f"takes more than {XACRO_MEMORY >> 30} GB of memory to expand: is there a text or a number without end?"
    return _Fault(words, "shorten what its expressions make; or expand it yourself: xacro F.urdf.xacro > F.urdf")


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
    for kind, most in ((resource.RLIMIT_CPU, XACRO_SECONDS), (resource.RLIMIT_AS, XACRO_MEMORY)):
        soft, hard = resource.getrlimit(kind)
        if soft == resource.RLIM_INFINITY or soft > most:
            resource.setrlimit(kind, (most, hard))


def _complain(fault: _Fault, file: str, path: Path, problems: Problems) -> None:
    """Note what went wrong, at the line of the file on which it is written as far as the message tells that."""
    at = path if fault.at is None else Path(fault.at)
    if at != path:
        file = f"{Path(file).parent / os.path.relpath(at, path.parent)}"
    words, remedy = fault.words, fault.remedy
    unknown = _NO_PACKAGE.search(words)
    if unknown is not None:
        words = f"package {unknown[1]} is not found"
        remedy = f"add --package {unknown[1]}=FOLDER, or set ROS_PACKAGE_PATH"
    elif remedy is None:
        words, remedy = _told(words, path)
    try:
        written = at.read_text("utf-8", "replace")
    except OSError:
        written = ""
    stated = _LINE.search(fault.words)
    searched = (_EXPRESSION, _FILE, _NO_PACKAGE, *(pattern for pattern, *_ in _SAID))
    said = [m[1] for m in (pattern.search(fault.words) for pattern in searched) if m is not None]
    said += [unknown[1]] if unknown is not None else []
    places = [written.find(Path(text).name if "/" in text else text) for text in said]
    line = int(stated[1]) if stated else next((written.count("\n", 0, k) + 1 for k in places if k >= 0), 1)
    problems.add(words, file, line, remedy)


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


def _package(name: str, meshes: MeshFiles) -> Path | None:
    """The folder of a package: that of the description, where its package.xml says so, else as for meshes."""
    return meshes.home if package_name(meshes.home) == name else meshes.package(name)


_FIND = re.compile(rb"\$\(find ([^)\s]+)\)")


def _packages_of(data: bytes, home: Path) -> list[str]:
    """Names of packages that the file, and the xacro files of its package, ask for."""
    beside = files_below(home, (".xacro",))
    texts = [data, *(path.read_bytes() for path in beside[:XACRO_FILES])]
    return sorted({name.decode("utf-8", "replace") for text in texts for name in _FIND.findall(text)})
