"""Scenes of the parts of a fixture, and what shows that they have its joints."""

from __future__ import annotations

import re

import numpy as np
import pytest
import trimesh


def scene_of(assembly, groups=None, factor=1.0):
    """A trimesh scene of the parts where they stand; `groups` gives the node that a part hangs below."""
    scene = trimesh.Scene(base_frame="world")
    for group in sorted(set((groups or {}).values())):
        X = trimesh.transformations.translation_matrix([0.1, 0.2, 0.3])
        scene.graph.update(frame_from="world", frame_to=group, matrix=X)
    for part in assembly.parts:
        parent = (groups or {}).get(part.name, "world")
        X = np.linalg.inv(scene.graph.get(parent)[0]) @ part.X_WP
        X[:3, 3] *= factor
        mesh = trimesh.Trimesh(part.mesh.vertices * factor, part.mesh.faces, process=False)
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name, parent_node_name=parent, transform=X)
    return scene


def joints(results):
    return {frozenset(body.rpartition("/")[2] for body in joint.bodies): joint for joint in results.joints.values()}


def over(manifest, path):
    """The manifest without meshes and poses, which the scene beside it gives."""
    meshes = re.compile(r"^(mesh|position|quaternion|rpy|units) = .*\n", re.MULTILINE)
    text = meshes.sub("", manifest.read_text()).replace("[assembly]", f'[assembly]\nunits = "mm"\nfrom = "{path.name}"')
    out = path.with_suffix(".toml")
    out.write_text(text)
    return out


def assert_same_joints(one, other):
    a, b = joints(one), joints(other)
    assert a.keys() == b.keys() and a
    for pair, joint in a.items():
        assert (joint.type, joint.status) == (b[pair].type, b[pair].status)
        if joint.axis is not None:
            assert abs(joint.axis @ b[pair].axis) == pytest.approx(1.0, abs=1e-6)
            assert np.linalg.norm(np.cross(joint.axis, joint.point - b[pair].point)) < 2e-6
    assert one.mobility.effective == other.mobility.effective
