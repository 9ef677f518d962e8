"""A robot with two legs as a URDF, whose every number is right: boxes of 1000 kg/m³, sides that are mirror images."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from lxml import etree

DENSITY = 1000.0


@dataclass
class Box:
    """A box of a link, in its frame (m)."""

    size: tuple[float, float, float]
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def geometry(self, tag: str) -> str:
        """As an element."""
        at, size = (" ".join(f"{v:.17g}" for v in values) for values in (self.at, self.size))
        return f'<{tag}><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></{tag}>'


@dataclass
class Link:
    """Boxes, their inertial and its changes."""

    boxes: list[Box]
    collision: list[Box] | None = None
    more: str = ""
    inertia_factor: float = 1.0
    mass_factor: float = 1.0
    centre_shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    products: dict[str, float] = field(default_factory=dict)

    def inertial(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Mass, centre (3,), inertia (3, 3) about it, by the closed forms of boxes."""
        masses = np.array([DENSITY * np.prod(box.size) for box in self.boxes])
        centres = np.array([box.at for box in self.boxes])
        centre = masses @ centres / masses.sum()
        inertia = np.zeros((3, 3))
        for m, c, box in zip(masses, centres, self.boxes, strict=True):
            a, b, d = np.square(box.size)
            o = c - centre
            inertia += m / 12.0 * np.diag([b + d, a + d, a + b]) + m * (o @ o * np.eye(3) - np.outer(o, o))
        return float(masses.sum()), centre, inertia

    def text(self, name: str) -> str:
        """As an element, one line."""
        mass, centre, inertia = self.inertial()
        c = np.array(centre) + self.centre_shift
        keys = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
        six = {key: self.inertia_factor * inertia[at] for key, at in keys.items()} | self.products
        inertial = (
            f'<inertial><origin xyz="{c[0]:.17g} {c[1]:.17g} {c[2]:.17g}"/>'
            f'<mass value="{mass * self.mass_factor:.17g}"/>'
            "<inertia " + " ".join(f'{key}="{value:.17g}"' for key, value in six.items()) + "/></inertial>"
        )
        shapes = "".join(box.geometry("visual") for box in self.boxes)
        shapes += "".join(box.geometry("collision") for box in self.collision or self.boxes)
        return f'<link name="{name}">{inertial}{shapes}{self.more}</link>'


def mirrored(boxes: list[Box]) -> list[Box]:
    """Across y = 0."""
    return [Box(box.size, (box.at[0], -box.at[1], box.at[2])) for box in boxes]


THIGH = [Box((0.05, 0.04, 0.20), (0.0, 0.0, -0.10)), Box((0.03, 0.03, 0.05), (0.02, 0.035, -0.05))]
SHIN = [Box((0.04, 0.03, 0.20), (0.0, 0.0, -0.11)), Box((0.10, 0.05, 0.02), (0.02, 0.01, -0.22))]


@dataclass
class Walker:
    """Links and joints; change them, then ask for the text."""

    links: dict[str, Link] = field(
        default_factory=lambda: {
            "torso": Link([Box((0.1, 0.2, 0.2), (0.0, 0.0, 0.1))]),
            "left_thigh": Link(list(THIGH)), "right_thigh": Link(mirrored(THIGH)),
            "left_shin": Link(list(SHIN)), "right_shin": Link(mirrored(SHIN)),
        }
    )  # fmt: skip
    hips: dict[str, tuple[float, float, float]] = field(
        default_factory=lambda: {"left": (0.0, 0.13, 0.05), "right": (0.0, -0.13, 0.05)}
    )
    limits: dict[str, str] = field(default_factory=dict)
    """By joint: the attributes of <limit>, or "" for none."""
    extra: str = ""

    def text(self) -> str:
        """The URDF, a link or joint a line."""
        lines = [link.text(name) for name, link in self.links.items()]
        for side in ("left", "right"):
            lines.append(self._joint(f"{side}_hip", "torso", f"{side}_thigh", self.hips[side]))
            lines.append(self._joint(f"{side}_knee", f"{side}_thigh", f"{side}_shin", (0.0, 0.0, -0.21)))
        return '<robot name="walker">\n' + "\n".join(lines) + f"\n{self.extra}</robot>\n"

    def _joint(self, name: str, parent: str, child: str, at: tuple[float, float, float]) -> str:
        limit = self.limits.get(name, 'lower="-0.5" upper="0.5" effort="5" velocity="3"')
        stated = f"<limit {limit}/>" if limit else ""
        return (
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{at[0]:.17g} {at[1]:.17g} {at[2]:.17g}"/><axis xyz="0 1 0"/>{stated}</joint>'
        )

    def sdf(self) -> str:
        """The same robot as an SDF, a link or joint a line."""
        places = {"torso": np.zeros(3)}
        for side, hip in self.hips.items():
            places |= {f"{side}_thigh": np.array(hip), f"{side}_shin": np.array(hip) + (0.0, 0.0, -0.21)}
        root = etree.fromstring(self.text())
        lines = ['<sdf version="1.9"><model name="walker">']
        for link in root.iter("link"):
            inner = "".join(_sdf_element(element, k) for k, element in enumerate(link))
            name = link.get("name")
            lines.append(f'<link name="{name}">{_pose(places[name])}{inner}</link>')
        for joint in root.iter("joint"):
            ends = "".join(f"<{end}>{joint.find(end).get('link')}</{end}>" for end in ("parent", "child"))
            limit = joint.find("limit")
            bounds = "" if limit is None else "".join(f"<{key}>{value}</{key}>" for key, value in limit.attrib.items())
            axis = f"<axis><xyz>{joint.find('axis').get('xyz')}</xyz><limit>{bounds}</limit></axis>"
            lines.append(f'<joint name="{joint.get("name")}" type="revolute">{ends}{axis}</joint>')
        return "\n".join([*lines, "</model></sdf>"]) + "\n"


def _pose(at: np.ndarray) -> str:
    return "<pose>" + " ".join(f"{v:.17g}" for v in at) + " 0 0 0</pose>"


def _sdf_element(element: Any, number: int) -> str:
    """A visual, collision or inertial of a URDF as an SDF has it."""
    pose = _pose(np.array(element.find("origin").get("xyz").split(), dtype=float))
    if element.tag == "inertial":
        six = "".join(f"<{key}>{value}</{key}>" for key, value in element.find("inertia").attrib.items())
        return f"<inertial>{pose}<mass>{element.find('mass').get('value')}</mass><inertia>{six}</inertia></inertial>"
    size = element.find("geometry/box").get("size")
    box = f"<geometry><box><size>{size}</size></box></geometry>"
    return f'<{element.tag} name="{element.tag} {number}">{pose}{box}</{element.tag}>'
