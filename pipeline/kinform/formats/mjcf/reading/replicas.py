"""`<replicate>` of an MJCF: copies of what is in it, each in a frame, their names with a number, as in MuJoCo."""

from __future__ import annotations

import copy

import numpy as np
from lxml import etree

from kinform.formats.description.elements import FILE, Element, Xml, tag_of
from kinform.formats.description.poses import pose
from kinform.formats.mjcf.reading.attach import COPIES_MOST, SUFFIX
from kinform.formats.mjcf.reading.defaults import Compiler
from kinform.foundation.algebra.spatial import quaternions
from kinform.model.arrays import Array


class Replicas:
    """Puts frames with copies in the place of `<replicate>`."""

    def __init__(self, xml: Xml, compiler: Compiler):
        self._xml, self._compiler = xml, compiler
        self._made = 0

    def expand(self, element: Element) -> bool:
        """All of them below an element, the inner ones first; whether there are any."""
        before = self._made
        for child in list(element):
            if not isinstance(child.tag, str):
                continue
            self.expand(child)
            if tag_of(child) == "replicate":
                self._replicate(child)
        return self._made > before

    def _replicate(self, element: Element) -> None:
        count = int(self._xml.number(element, "count", 0.0) or 0)
        size = sum(1 for _ in element.iter())
        if count < 1:
            self._xml.complain(element, "<replicate> has no count of at least 1", 'give count="2"')
        elif self._made + count * size > COPIES_MOST:
            self._xml.complain(element, f"<replicate> makes more than {COPIES_MOST:,} elements", "make fewer")
        else:
            self._made += count * size
            for k, X in enumerate(self._poses(element, count)):
                suffix = f"{element.get('sep', '')}{k:0{len(str(count - 1))}d}"
                element.addprevious(self._copy(element, X, suffix))
        element.getparent().remove(element)

    def _poses(self, element: Element, count: int) -> list[Array]:
        """(4, 4) of each copy: turned by so many times the angles, and moved by the offset as the one before is turned,
        as MuJoCo has it; which for angles about one axis is the same step each time."""
        angles = np.array(self._xml.vector(element, "euler", (0.0, 0.0, 0.0)))
        offset = np.array(self._xml.vector(element, "offset", (0.0, 0.0, 0.0)))
        out, place = [], np.zeros(3)
        for k in range(count):
            said = {"euler": " ".join(repr(float(k * angle)) for angle in angles)}
            R = self._compiler.rotation(self._xml, element, said)
            out.append(pose(R, place))
            place = place + R @ offset
        return out

    def _copy(self, element: Element, X: Array, suffix: str) -> Element:
        frame = etree.Element("frame")
        frame.set("pos", " ".join(repr(float(v)) for v in X[:3, 3]))
        frame.set("quat", " ".join(repr(float(v)) for v in quaternions(X[None, :3, :3])[0]))
        if element.get(FILE) is not None:
            frame.set(FILE, element.get(FILE))
        frame.sourceline = element.sourceline
        for child in element:
            twin = copy.deepcopy(child)
            for inner in twin.iter():
                if isinstance(inner.tag, str) and inner.get("name") is not None:
                    inner.set("name", inner.get("name") + suffix)
                if isinstance(inner.tag, str) and tag_of(inner) == "attach":
                    inner.set(SUFFIX, inner.get(SUFFIX, "") + suffix)
            frame.append(twin)
        return frame
