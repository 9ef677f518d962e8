"""Writes the STEP files beside it, by build123d: three fixtures in exact surfaces of the same sizes, and one of names.

Another program is to have written what is read. Run it in an environment with build123d 0.13: `python write.py`. The
times in the headers are taken out.
"""

from __future__ import annotations

import copy
import math
import re
from pathlib import Path

from build123d import (
    Box,
    Color,
    Compound,
    Cylinder,
    Location,
    Polyline,
    Pos,
    Solid,
    export_step,
    extrude,
    make_face,
)

HERE = Path(__file__).parent
PIN, BORE, WIDTH, COLLAR, PLAY = 4.0, 4.05, 10.0, 8.0, 0.05
LOWER, UPPER = 1.0 + PLAY, 8.0 + 2 * PLAY


def rod(radius: float, z0: float, z1: float, x: float = 0.0):
    """A cylinder about z."""
    return Pos(x, 0, (z0 + z1) / 2) * Cylinder(radius, z1 - z0)


def prism(points, z0: float, z1: float):
    """A polygon between two heights."""
    return Pos(0, 0, z0) * extrude(make_face(Polyline(*points, close=True)), z1 - z0, dir=(0, 0, 1))


def placed(solid, label: str, position=(0, 0, 0), rpy=(0, 0, 0)) -> Solid:
    """An instance of a solid with a name and a pose: Rz·Ry·Rx, degrees."""
    out = copy.copy(solid if isinstance(solid, Solid) else solid.solids()[0])
    roll, pitch, yaw = (Location((0, 0, 0), [float(k == n) for k in range(3)], a) for n, a in enumerate(rpy))
    out.label, out.location = label, Location(position) * yaw * pitch * roll
    return out


def write(name: str, *children) -> None:
    """One assembly, without the time at which it was written."""
    path = HERE / f"{name}.step"
    export_step(Compound(label=name, children=children), path)
    path.write_text(re.sub(r"'20[\d-]*T[\d:]*'", "'2026-01-01T00:00:00'", path.read_text()))


def collars() -> None:
    """`pairs/revolute_collars`."""
    block = Box(40, 40, 30) - rod(10.05, -20, 20)
    shaft = rod(14, -19, -15.05) + rod(10, -30, 40) + rod(14, 15.05, 19)
    pose = (-60, 15, 200), (0, 70, -20)
    write("revolute_collars", placed(block, "block", *pose), placed(shaft, "shaft", *pose))


def dovetail() -> None:
    """`pairs/prismatic_dovetail`."""
    lean, wide = math.tan(math.radians(30)), 0.05 / math.cos(math.radians(30))
    foot, roof, far = 10 + wide + 0.05 * lean, 10 + wide + 11 * lean, 10 + 10 * lean
    rail = [(-25, -10), (25, -10), (25, 0), (10, 0), (far, 10), (-far, 10), (-10, 0), (-25, 0)]
    slide = [(-25, 0.05), (-foot, 0.05), (-roof, 11), (roof, 11), (foot, 0.05), (25, 0.05), (25, 22), (-25, 22)]
    pose = (0, 0, 0), (15, 40, 0)
    write(
        "prismatic_dovetail", placed(prism(rail, -60, 60), "rail", *pose), placed(prism(slide, -10, 30), "slide", *pose)
    )


def bar(length: float, radius: float, bosses: tuple[bool, bool]):
    """As in the generator of `mechanisms/four_bar`."""
    out = rod(WIDTH, 0, 6) + rod(WIDTH, 0, 6, length) + Pos(length / 2, 0, 3) * Box(length, 2 * WIDTH, 6)
    for x, boss in ((0, bosses[0]), (length, bosses[1])):
        out = out + rod(COLLAR, 6, 7, x) if boss else out
    return (out - rod(radius, -1, 9) - rod(radius, -1, 9, length)).solids()[0]


def four_bar() -> None:
    """`mechanisms/four_bar`; two pins are instances each of one solid."""
    top = UPPER + 6 + PLAY
    low = (rod(PIN, -6 - PLAY, LOWER + 6) + rod(COLLAR, -9 - PLAY, -6 - PLAY)).solids()[0]
    high = (rod(PIN, LOWER, top) + rod(COLLAR, top, top + 3)).solids()[0]
    b, c = (15, 25.980762114), (93.660951307, 69.712383847)
    write(
        "four_bar",
        placed(bar(100, BORE, (True, True)), "base", (0, 0, -6)),
        placed(bar(30, PIN, (False, True)), "crank", (0, 0, LOWER), (0, 0, 60)),
        placed(bar(70, PIN, (False, True)), "rocker", (100, 0, LOWER), (0, 0, 95.195699932)),
        placed(bar(90, BORE, (False, False)), "coupler", (*b, UPPER), (0, 0, 29.071907662)),
        placed(low, "pin_a"),
        placed(high, "pin_b", (*b, 0)),
        placed(high, "pin_c", (*c, 0)),
        placed(low, "pin_d", (100, 0, 0)),
    )


def names() -> None:
    """A sub-assembly with two parts of one name, a part of that name beside it, a name with "/", a colour."""
    pin = Cylinder(3, 10).solids()[0]
    pins = Compound(label="pins", children=[placed(pin, "pin"), placed(pin, "pin", (0, 20, 0))])
    pins.location = Location((100, 0, 0))
    box = placed(Box(10, 10, 10), "a/b")
    box.color = Color("red")
    write("names", box, pins, placed(pin, "pin", (0, 0, 50), (0, 30, 0)))


if __name__ == "__main__":
    for make in (collars, dovetail, four_bar, names):
        make()
