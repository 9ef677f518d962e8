"""xacro: expanded by xacrodoc, an optional package, then read as URDF.

Lines are those of the text as written, as far as an element of that name stands there; else the first.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from kinform.form.constants import XACRO_FILES
from kinform.form.descriptions import urdf
from kinform.form.descriptions.meshes import MeshFiles, files_below
from kinform.form.descriptions.robot import Robot
from kinform.form.problems import Problems


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of a xacro file; None where nothing can be made of it, after noting why."""
    try:
        from xacrodoc import XacroDoc, packages
    except ImportError:
        remedy = "pip install 'kinform[xacro]', or expand it: xacro F.urdf.xacro > F.urdf"
        problems.add("is xacro, and the package that expands it is not installed", file, None, remedy)
        return None
    for name in _packages_of(data, meshes.home):
        folder = meshes.package(name)
        if folder is not None:
            packages.update_package_cache({name: folder})
    try:
        text = XacroDoc.from_file(str(path), resolve_packages=False).to_urdf_string()
    except (Exception, SystemExit) as error:  # xacro raises whatever its expressions raise
        words = " ".join(str(error).split()) or type(error).__name__
        problems.add(f"cannot be expanded by xacro: {words}", file, None, "correct it, or expand it yourself")
        return None
    robot = urdf.read_text(path, text.encode(), file, problems, meshes, data.decode("utf-8", "replace"))
    return None if robot is None else replace(robot, files=_included(data, path, meshes))


_FIND = re.compile(rb"\$\(find ([^)\s]+)\)")
_INCLUDE = re.compile(rb"include\s+filename\s*=\s*[\"']([^\"']+)")


def _packages_of(data: bytes, home: Path) -> list[str]:
    """Names of packages that the file, and the xacro files of its package, ask for."""
    beside = files_below(home, (".xacro",))
    texts = [data, *(path.read_bytes() for path in beside[:XACRO_FILES])]
    return sorted({name.decode("utf-8", "replace") for text in texts for name in _FIND.findall(text)})


def _included(data: bytes, path: Path, meshes: MeshFiles) -> tuple[Path, ...]:
    """Files that are included, and those that they include, as far as their names are plain."""
    found: dict[Path, None] = {}
    waiting = [(data, path.parent)]
    while waiting and len(found) < XACRO_FILES:
        text, folder = waiting.pop()
        for stated in _INCLUDE.findall(text):
            words = _FIND.sub(lambda m: str(meshes.package(m[1].decode()) or m[1].decode()).encode(), stated)
            name = Path(words.decode("utf-8", "replace"))
            other = name if name.is_absolute() else folder / name
            if other.is_file() and other not in found:
                found[other] = None
                waiting.append((other.read_bytes(), other.parent))
    return tuple(found)
