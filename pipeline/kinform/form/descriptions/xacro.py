"""xacro: expanded by the program of that name, which the optional package xacrodoc brings, then read as URDF.

Lines are those of the text as written, as far as an element of that name stands there; else the first.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

from kinform.form.constants import XACRO_FILES
from kinform.form.descriptions import urdf
from kinform.form.descriptions.elements import declares_entities
from kinform.form.descriptions.meshes import MeshFiles, files_below
from kinform.form.descriptions.robot import Robot
from kinform.form.problems import Problems


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of a xacro file; None where nothing can be made of it, after noting why."""
    try:
        import xacro
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
    xacro.all_includes.clear()
    try:
        text = str(xacro.process_file(str(path)).toxml())
    except (Exception, SystemExit) as error:  # xacro raises whatever its expressions raise
        at = Path(xacro.filestack[-1]) if xacro.filestack else path
        _complain(
            error, file if at == path else f"{Path(file).parent / os.path.relpath(at, path.parent)}", at, problems
        )
        return None
    robot = urdf.read_text(path, text.encode(), file, problems, meshes, data.decode("utf-8", "replace"))
    included = dict.fromkeys(Path(name) for name in xacro.all_includes)
    return None if robot is None else replace(robot, files=tuple(included))


def _complain(error: BaseException, file: str, at: Path, problems: Problems) -> None:
    """Note what went wrong, at the line of the file on which it is written as far as the message tells that."""
    words = " ".join(str(error).split()) or type(error).__name__
    unknown = _NO_PACKAGE.search(words)
    if unknown is not None:
        words = f"package {unknown[1]} is not found"
        remedy = f"add --package {unknown[1]}=FOLDER, or set ROS_PACKAGE_PATH"
    elif isinstance(error, RecursionError):
        words, remedy = "macros or includes contain themselves", "remove one of them"
    else:
        words, remedy = f"cannot be expanded by xacro: {words}", "correct it, or expand it yourself"
    try:
        written = at.read_text("utf-8", "replace")
    except OSError:
        written = ""
    stated = _LINE.search(words)
    said = [m[1] for m in (pattern.search(words) for pattern in (_EXPRESSION, _FILE, _NO_PACKAGE)) if m is not None]
    said += [unknown[1]] if unknown is not None else []
    places = [written.find(Path(text).name if "/" in text else text) for text in said]
    line = int(stated[1]) if stated else next((written.count("\n", 0, k) + 1 for k in places if k >= 0), 1)
    problems.add(words, file, line, remedy)


_LINE = re.compile(r"line (\d+), column")
_EXPRESSION = re.compile(r"evaluating expression '(.+)'")
_FILE = re.compile(r"No such file or directory: '?([^' ]+)")
_NO_PACKAGE = re.compile(r"Package not found: (\S+)")


def _package(name: str, meshes: MeshFiles) -> Path | None:
    """The folder of a package: that of the description, where its package.xml says so, else as for meshes."""
    own = meshes.home / "package.xml"
    stated = re.search(rb"<name>\s*([^<\s]+)\s*</name>", own.read_bytes()) if own.is_file() else None
    return meshes.home if stated is not None and stated[1].decode("utf-8", "replace") == name else meshes.package(name)


_FIND = re.compile(rb"\$\(find ([^)\s]+)\)")


def _packages_of(data: bytes, home: Path) -> list[str]:
    """Names of packages that the file, and the xacro files of its package, ask for."""
    beside = files_below(home, (".xacro",))
    texts = [data, *(path.read_bytes() for path in beside[:XACRO_FILES])]
    return sorted({name.decode("utf-8", "replace") for text in texts for name in _FIND.findall(text)})
