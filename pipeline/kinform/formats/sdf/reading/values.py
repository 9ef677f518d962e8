"""What SDF writes as the text of elements: numbers, poses in two formats, booleans, names."""

from __future__ import annotations

import math

import numpy as np

from kinform.form.constants import LARGEST_NUMBER
from kinform.formats.description.elements import Element, Xml, tag_of
from kinform.formats.description.poses import pose, quaternion, rpy
from kinform.foundation.name_hints import in_quotes
from kinform.model.arrays import Array


class Values:
    """Asks elements for what their children say; what is wrong is noted at their line."""

    def __init__(self, xml: Xml):
        self.xml = xml

    def text(self, element: Element | None, tag: str) -> str | None:
        """The text of a child; None where it is absent or empty."""
        child = self.xml.child(element, tag)
        return None if child is None else (child.text or "").strip() or None

    def number(self, element: Element | None, tag: str, default: float) -> float:
        """A number, which may be infinite where SDF has that for no bound; the default where it is absent or wrong."""
        child, text = self.xml.child(element, tag), self.text(element, tag)
        if child is None or text is None:
            return default
        if text.lower().lstrip("+-") in ("inf", "infinity"):
            return -math.inf if text.startswith("-") else math.inf
        try:
            if abs(float(text)) > LARGEST_NUMBER and math.isfinite(float(text)):
                return math.copysign(math.inf, float(text))
        except ValueError:
            pass
        values = self.xml.numbers(child, text, tag, 1)
        return default if values is None else values[0]

    def finite(self, element: Element | None, tag: str, default: float) -> float:
        """A finite number; the default where it is absent, and after noting that it is none."""
        child, value = self.xml.child(element, tag), self.number(element, tag, default)
        if child is not None and not math.isfinite(value):
            self.xml.complain(child, f"<{tag}> has {in_quotes(child.text or '')}, which is no finite number",
                              "give finite numbers")  # fmt: skip
            return default
        return value

    def vector(self, element: Element | None, tag: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Numbers of a child; the default where it is absent or wrong."""
        child = self.xml.child(element, tag)
        if child is None or not (child.text or "").strip():
            return default
        values = self.xml.numbers(child, child.text, tag, len(default))
        return default if values is None else values

    def true(self, element: Element | None, tag: str) -> bool:
        """Whether a child says that something is so."""
        return (self.text(element, tag) or "").lower() in ("1", "true")

    def pose(self, element: Element | None) -> tuple[Array, str]:
        """The `<pose>` of an element, (4, 4), and the frame that it names, "" for none."""
        child = self.xml.child(element, "pose")
        if child is None:
            return np.eye(4), ""
        frame = (child.get("relative_to") or child.get("frame") or "").strip()
        if not (child.text or "").strip():
            return np.eye(4), frame
        turned = child.get("rotation_format", "euler_rpy").strip()
        if turned not in ("euler_rpy", "quat_xyzw"):
            self.xml.complain(child, f"rotation_format {in_quotes(turned)} is not known", "give euler_rpy or quat_xyzw")
            return np.eye(4), frame
        values = self.xml.numbers(child, child.text, "pose", 7 if turned == "quat_xyzw" else 6)
        if values is None:
            return np.eye(4), frame
        if turned == "quat_xyzw":
            x, y, z, w = values[3:]
            return pose(quaternion((w, x, y, z)), values[:3]), frame
        degrees = child.get("degrees", "false").strip().lower() in ("1", "true")
        angles = [math.radians(a) for a in values[3:]] if degrees else values[3:]
        return pose(rpy(angles), values[:3]), frame

    def name(self, element: Element) -> str | None:
        """The name of an element, which must be there; "/" becomes "_", and "::" is of scopes."""
        name = self.xml.name(element)
        if name is not None and "::" in name and tag_of(element) != "joint":
            self.xml.complain(element, f"{in_quotes(name)} has '::' in it, which separates models", "rename it")
            return None
        return name
