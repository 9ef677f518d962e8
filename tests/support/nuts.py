"""A nut of 20 kg on a screw that stands, and what it takes to turn it (Shigley's Mechanical Engineering Design,
equations 8-1 and 8-2)."""

from __future__ import annotations

import math

G, MASS, INERTIA, RADIUS, LEAD, FLANK = 9.81, 20.0, 0.002, 0.01, 0.02, math.radians(14.5)
"""m/s², kg, kg·m² about the axis; m: mean radius of the thread, and its lead; half its angle."""

_NUT = """schema = 1
[assembly]
name = "jack"
units = "mm"
ground = "BASE"
[[part]]
name = "BASE"
[[part]]
name = "NUT"
mass = 20
centre_of_mass = [0, 0, 0]
inertia = [[0.001, 0, 0], [0, 0.001, 0], [0, 0, 0.002]]
[function]
[[function.joint]]
name = "thread"
between = ["BASE", "NUT"]
type = "screw"
axis = [0, 0, 1]
point = [0, 0, 0]
pitch = LEAD
[[function.drive]]
joint = "thread"
kind = "friction"
coefficient = MU
static = REST
radius = 10
flank = 14.5
"""


def nut(base="base", name="nut", *, mu=0.08, static=None, lead=LEAD):
    """The manifest, without any drive but the friction."""
    text = _NUT.replace("LEAD", repr(1e3 * lead)).replace("MU", repr(mu)).replace("REST", repr(static or mu))
    return text.replace("BASE", base).replace("NUT", name)


def arm(mu, way, lead=LEAD):
    """m: torque on the nut by its load, where it climbs (1) or comes down (−1)."""
    slope = math.atan(lead / (2.0 * math.pi * RADIUS))
    normal = math.atan(math.tan(FLANK) * math.cos(slope))
    return RADIUS * math.tan(slope + way * math.atan(mu / math.cos(normal)))
