"""What friction and gears lose is drawn, with its work."""

from __future__ import annotations

import kinform
from kinform.reports.page.curves import number
from kinform.reports.page.plots import plot_groups

MANIFEST = """
schema = 1
[assembly]
name = "axis"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "wheel"
mass = 1
centre_of_mass = [0, 0, 0]
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
[[function.joint]]
name = "axle"
between = ["frame", "wheel"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[simulation]
duration = 0.5
step = 0.02
[[function.drive]]
joint = "axle"
kind = "dc_motor"
resistance = 1
constant = 0.1
voltage = 3
gear = 20
rotor_friction = 0.01
efficiency = 0.8
[[function.drive]]
joint = "axle"
kind = "friction"
effort = 0.05
"""


def test_losses_are_drawn_with_their_work(tmp_path):
    path = tmp_path / "axis.toml"
    path.write_text(MANIFEST)
    done = kinform.run(path)
    groups = {heading: drawn for heading, drawn, _ in plot_groups(done.design)}
    captions = "".join(groups["Friction and losses"])
    assert len(groups["Friction and losses"]) == 3
    for use in done.simulation.drives:
        drawn = f"{use.kind.replace('_', ' ')}, {number(use.work)} J" in captions
        assert drawn == (use.kind in ("friction", "gear_loss", "rotor"))
