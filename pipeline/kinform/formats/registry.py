"""The formats that can stand in place of a manifest: robot descriptions, and CAD and scene files.

For each its name, suffixes, root element, reader and writer, all in one line. Readers and writers are named, not
imported: who reads imports no writer, and nothing is imported before it is used.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinform.form.constants import TEXT_BYTES
from kinform.frozen import dataclass

if TYPE_CHECKING:
    from kinform.form.problems import Problems
    from kinform.formats.description.mesh_files import MeshFiles
    from kinform.formats.description.robot import Robot

    Read = Callable[[Path, bytes, str, Problems, MeshFiles], Robot | None]
    """Reader of a format: path, content, the file as messages show it, problems, where meshes are."""


@dataclass(frozen=True)
class RobotFormat:
    """A format of robot descriptions.

    Its package `kinform.formats.NAME` has the modules `writing.writer`, with `export(model)`, and `writing.edits`,
    with `write_range`, `write_inertial` and `write_folder`.
    """

    title: str
    """As messages have it."""
    suffixes: tuple[str, ...]
    """Of files that may be of this format; several formats share .xml."""
    root: str
    """Name of the root element, which decides among formats that share a suffix."""
    reader: str
    """Module in `kinform.formats` with `read`."""
    name: str
    """As `kinform export --to` has it, and `Robot.format`: of what is read and written back."""
    ending: str = ""
    """Of files that are written; "": nothing is written in this format."""
    purpose: str = ""
    """What a file that is written is for."""

    @property
    def writer(self) -> str:
        """Module in `kinform` with `export`."""
        return f"formats.{self.name}.writing.writer"


ROBOT_FORMATS = (
    RobotFormat("URDF", (".urdf", ".xml"), "robot", "urdf.reading.reader", "urdf", ".urdf",
                "a tree of links and joints, for ROS and its relatives"),
    RobotFormat("xacro", (".xacro",), "robot", "urdf.reading.xacro", "urdf"),
    RobotFormat("MJCF", (".mjcf", ".xml"), "mujoco", "mjcf.reading.reader", "mjcf", ".xml",
                "bodies, joints, loops and drives, for MuJoCo"),
    RobotFormat("SDF", (".sdf", ".world", ".xml"), "sdf", "sdf.reading.reader", "sdf", ".sdf",
                "links and joints, for Gazebo and Drake"),
)  # fmt: skip


@dataclass(frozen=True)
class SceneFormat:
    """A CAD or scene format; the suffix decides, the reader confirms."""

    name: str
    """As messages have it."""
    suffixes: tuple[str, ...]
    module: str
    """In `kinform`, of the reader."""
    function: str
    """The reader: `function(data, path, reading)` gives a `Scene`."""
    unitless: bool = False
    """Whether its files have no unit of length."""


SCENE_FORMATS = (
    SceneFormat("glTF", (".glb", ".gltf"), "formats.gltf.reading.reader", "read_gltf"),
    SceneFormat("3MF", (".3mf",), "form.scenes.threemf", "read_3mf"),
    SceneFormat("DAE", (".dae",), "form.scenes.dae", "read_dae"),
    SceneFormat("PLY", (".ply",), "form.scenes.loose", "read_loose", unitless=True),
    SceneFormat("OFF", (".off",), "form.scenes.loose", "read_loose", unitless=True),
    SceneFormat("STEP", (".step", ".stp"), "form.scenes.step", "read_step"),
)

WRITTEN = {format.name: format for format in ROBOT_FORMATS if format.ending}
"""Formats with a writer, by name."""


def reader_of(path: Path, data: bytes) -> Read | None:
    """`read` of the format that a file has by its suffix and its root element; None where it is none of them. Where one
    format alone has the suffix it reads the file whatever the root, and says what is wrong with that."""
    fits = [format for format in ROBOT_FORMATS if path.suffix.lower() in format.suffixes]
    if len(fits) > 1:
        from kinform.foundation.xml_root import root_of

        root = root_of(data[: TEXT_BYTES + 1])
        fits = [format for format in fits if root is not None and format.root == root.name]
    return _read(fits[0].reader) if fits else None


def reader_of_text(name: str) -> Read:
    """`read` for the text of a `Robot` whose format has that name."""
    return _read(WRITTEN[name].reader)


def _read(module: str) -> Read:
    read: Read = importlib.import_module(f"kinform.formats.{module}").read
    return read


def edits_of(name: str) -> Any:
    """The module with the edits of a format."""
    return importlib.import_module(f"kinform.formats.{name}.writing.edits")
