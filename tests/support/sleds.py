"""A body without a mesh that slides along x."""

from __future__ import annotations

_SLED = """schema = 1
[assembly]
name = "sled"
units = "mm"
ground = "FIRST"
[[part]]
name = "FIRST"
[[part]]
name = "SECOND"
mass = MASS
centre_of_mass = [0, 0, 0]
inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]
[function]
[[function.joint]]
name = "slide"
between = BETWEEN
type = "prismatic"
axis = [1, 0, 0]
point = [0, 0, 0]
MORE
[simulation]
duration = 0.6
step = 0.02
[simulation.initial.slide]
velocity = VELOCITY
"""


def sled(first, second, more, *, velocity=1000, mass=2.0, turned=False):
    """The manifest; `more`: keys of the joint, or tables after it; `turned`: the joint names the second part first."""
    names = (second, first) if turned else (first, second)
    text = _SLED.replace("BETWEEN", f'["{names[0]}", "{names[1]}"]').replace("MASS", repr(mass))
    text = text.replace("MORE", more).replace("VELOCITY", str(velocity))
    return text.replace("FIRST", first).replace("SECOND", second)
