"""What a sub-assembly stands for where a joint names it."""

from __future__ import annotations

import pytest
from support.solids import box, save

from kinform.form import load


@pytest.mark.parametrize(("longer", "stands"), [(0.0, "a"), (1e-6, "a"), (2e-4, "a"), (0.1, "b"), (-0.1, "a")])
def test_it_stands_for_its_largest_part_whichever_was_rounded_up(tmp_path, longer, stands):
    save(box(0, 10, 0, 10, 0, 10), tmp_path / "a.stl")
    save(box(20, 30, 0, 10, 0, 10 * (1 + longer)), tmp_path / "b.stl")
    save(box(0, 100, 0, 10, -10, 0), tmp_path / "c.stl")
    parts = "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\n' for name in "ab")
    (tmp_path / "sub.toml").write_text(f'schema = 1\n[assembly]\nname = "sub"\nunits = "mm"\n{parts}')
    (tmp_path / "top.toml").write_text(
        'schema = 1\n[assembly]\nname = "top"\nunits = "mm"\n[[part]]\nname = "c"\nmesh = "c.stl"\n'
        '[[subassembly]]\nname = "s"\nfile = "sub.toml"\n'
        '[[function.joint]]\nname = "j"\nbetween = ["c", "s"]\ntype = "fixed"\n'
    )
    (joint,) = load(tmp_path / "top.toml").function.joints
    assert joint.between == ("c", f"s/{stands}")
