"""Meshes without a manifest: their parts, and the manifest that is proposed."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from kinform.errors import InputError
from kinform.form import init_manifest, load, load_meshes

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


SIDES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip


def binary(corners, header=b"made by a test"):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(facet), 0) for facet in corners)
    return header.ljust(80, b"\0") + struct.pack("<I", len(corners)) + records


def test_a_file_of_several_shells_gives_a_part_each_and_keeps_cavities_inside(tmp_path):
    hollow = [CUBE[SIDES] * 3, CUBE[SIDES[:, ::-1]] + 1.0, CUBE[SIDES] + [9, 0, 0]]
    (tmp_path / "all.stl").write_bytes(binary(np.concatenate(hollow)))
    assembly = load_meshes([tmp_path / "all.stl"], units="mm")
    assert [p.name for p in assembly.parts] == ["shell 1", "shell 2"]
    assert [p.mesh.health.volume for p in assembly.parts] == pytest.approx([26e-9, 1e-9])


def test_init_writes_a_manifest_that_loads(tmp_path):
    (tmp_path / "a.stl").write_bytes(binary(CUBE[SIDES] * 20))
    (tmp_path / "b.stl").write_bytes(binary(CUBE[SIDES] * 20 + 40))
    text = init_manifest([tmp_path / "a.stl", tmp_path / "b.stl"], units="mm", relative_to=tmp_path)
    (tmp_path / "m.toml").write_text(text)
    assembly = load(tmp_path / "m.toml")
    assert [p.name for p in assembly.parts] == ["a", "b"]
    huge = [CUBE[SIDES] * 20_000, CUBE[SIDES] * 20_000 + 40_000]
    for name, corners in zip("ab", huge, strict=True):
        (tmp_path / f"{name}.stl").write_bytes(binary(corners))
    doubted = init_manifest([tmp_path / "a.stl", tmp_path / "b.stl"], units="m", relative_to=tmp_path)
    assert doubted.count("\n#") > text.count("\n#")


def test_an_unknown_unit_and_an_unknown_suffix_are_told_together(tmp_path):
    (tmp_path / "a.step").write_text("x")
    with pytest.raises(InputError) as caught:
        load_meshes([tmp_path / "a.step"], units="mile")
    assert len(caught.value.problems) == 2
