"""Formats of robot descriptions: one package each, with its reader, its writer and the edits of files it has read.

Sub-packages; each imports only those above it:

- `description`: the record of a robot, its XML and its tables, which all readers share
- `urdf`: URDF and xacro
- `sdf`: SDF, the model format of Gazebo
- `mjcf`: MJCF, the model format of MuJoCo
"""

__all__ = ["CODE_VERSION"]

CODE_VERSION: int = 1
"""Bumped when what readers make of the same file changes."""
