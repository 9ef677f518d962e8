"""PLY and OFF: one mesh without names or units, whose shells are the parts."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kinform.form.constants import PARTS_MOST
from kinform.form.meshes.bodies import shell_bodies
from kinform.form.meshes.by_trimesh import read_by_trimesh
from kinform.form.meshes.raw import Fault, MeshError
from kinform.form.scenes.scene import Node, Scene
from kinform.form.sources import AS_IT_IS, Reading


def read_loose(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a file: a part for each shell. Raises MeshError."""
    raw = read_by_trimesh(data, path.suffix.lower()[1:])
    shells = shell_bodies(raw)
    if len(shells) > PARTS_MOST:
        raise MeshError([Fault(f"has {len(shells):,} shells, and {PARTS_MOST:,} are the most", "divide it")])
    meshes = tuple(shells.items()) if len(shells) > 1 else ((path.stem, raw),)
    nodes = tuple(Node(name, np.eye(4), k) for k, (name, _) in enumerate(meshes))
    return Scene(meshes, nodes, tuple(range(len(nodes))), None)
