"""Formats that are both read and written: one package each, with its reader, its writer and its facts.

    urdf  read in urdf/reading/reader.py    written in urdf/writing/writer.py    template urdf/writing/robot.urdf.j2
    sdf   read in sdf/reading/reader.py     written in sdf/writing/writer.py     template sdf/writing/model.sdf.j2
    mjcf  read in mjcf/reading/reader.py    written in mjcf/writing/writer.py    template mjcf/writing/model.mjcf.j2
    gltf  read in gltf/reading/reader.py    written in gltf/writing/writer.py

`registry` lists them, and the CAD and scene formats that are only read: name, suffixes, root element, reader, writer.
A reader makes a `description.robot.Robot` of a file, and `description.tables` the tables of a manifest of that. A
writer makes files of an export model; a description that was read is written back by `description.writing.write_back`,
with the edits of its format in `writing/edits.py`. Readers import no writers.

Sub-packages; each imports only those above it:

- `description`: what formats of robot descriptions share
- `urdf`: URDF and xacro
- `sdf`: SDF, the model format of Gazebo
- `mjcf`: MJCF, the model format of MuJoCo
- `gltf`: glTF 2.0, scenes and animations
"""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 2
"""Bumped when what readers make of the same file changes."""
