"""PLY and OFF: shells are parts, and the unit is asked for."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from tests.support.scenes import BOX

import kinform
from kinform import form
from kinform.errors import InputError


@pytest.mark.parametrize("kind", ["ply", "off"])
def test_shells_of_a_file_without_names_are_parts_and_its_unit_is_asked_for(tmp_path, kind):
    two = trimesh.util.concatenate([BOX, BOX.copy().apply_translation([10, 0, 0])])
    path = tmp_path / f"two.{kind}"
    two.export(path)
    with pytest.raises(InputError):
        form.load(path)
    with pytest.raises(InputError):
        kinform.run(path)
    assert [p.name for p in kinform.run(path, units="mm").assembly.parts] == ["shell 1", "shell 2"]
    (tmp_path / "m.toml").write_text(f'schema = 1\n[assembly]\nname = "m"\nunits = "cm"\nfrom = "two.{kind}"\n')
    assembly = form.load(tmp_path / "m.toml")
    assert [p.name for p in assembly.parts] == ["shell 1", "shell 2"]
    assert np.allclose(np.ptp(assembly.part("shell 2").mesh.vertices, axis=0), [0.01, 0.02, 0.03])
