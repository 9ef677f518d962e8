"""The formats of robot descriptions: one line each. The suffix decides, the root element confirms."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from pathlib import Path

from kinform.form.problems import Problems
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.robot import Robot
from kinform.frozen import dataclass

Read = Callable[[Path, bytes, str, Problems, MeshFiles], Robot | None]


@dataclass(frozen=True)
class Format:
    """A format, its suffixes, the name of its root element, and the module with its `read`."""

    name: str
    suffixes: tuple[str, ...]
    root: str
    module: str


FORMATS = (
    Format("URDF", (".urdf", ".xml"), "robot", "urdf.reading.reader"),
    Format("xacro", (".xacro",), "robot", "urdf.reading.xacro"),
    Format("MJCF", (".mjcf", ".xml"), "mujoco", "mjcf.reading.reader"),
    Format("SDF", (".sdf", ".world", ".xml"), "sdf", "sdf.reading.reader"),
)

_ROOT = re.compile(rb"<\s*([A-Za-z_][\w:.-]*)")


def reader_of(path: Path, data: bytes) -> Read | None:
    """`read` of the format that a file has by its name and its first element; None where it is none of them."""
    match = _ROOT.search(re.sub(rb"<!--.*?-->|<\?.*?\?>|<!DOCTYPE[^>]*>", b"", data[:65536], flags=re.DOTALL))
    root = match[1].decode() if match else ""
    fits = [format for format in FORMATS if path.suffix.lower() in format.suffixes]
    chosen = next((format for format in fits if format.root == root), None)
    if chosen is None:
        chosen = fits[0] if len(fits) == 1 else None
    if chosen is None:
        return None
    read: Read = importlib.import_module(f"kinform.formats.{chosen.module}").read
    return read
