"""`<equality>` of an MJCF: loops that are closed, bodies that are welded, joints that keep a ratio."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from kinform.formats.description.elements import Element, Xml, tag_of
from kinform.formats.description.poses import place, pose, quaternion
from kinform.formats.description.robot import Link, Ratio, RobotJoint
from kinform.formats.description.tree import Count
from kinform.formats.mjcf.reading.defaults import Defaults
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

LOOP_GAP = 1e-4
"""Metres, and radians times ten, by which the two ends of a loop that an MJCF closes may miss each other in its pose:
sites are printed to four or more digits. What is further apart is closed in another pose than that of the meshes."""


_WORLD = "world"


def _active(xml: Xml, root: Element, defaults: Defaults, *tags: str) -> Iterator[Element]:
    for group in xml.children(root, "equality"):
        for element in xml.children(group, *tags):
            if defaults.said(element, None, "equality").get("active", "true") != "false":
                yield element


def closures(
    xml: Xml,
    root: Element,
    links: Mapping[str, Link],
    sites: Mapping[str, tuple[str, Array]],
    defaults: Defaults,
    left: Count,
) -> list[RobotJoint]:
    """Joints that `<connect>` and `<weld>` make: a ball at one point, a hinge through two, else fixed. What they close
    in another pose than that of the file is none: what holds there is not known here."""
    between: dict[tuple[str, str], list[tuple[Element, Array | None]]] = {}
    for element in _active(xml, root, defaults):
        if tag_of(element) not in ("connect", "weld"):
            if tag_of(element) != "joint":
                left.add(f"<{tag_of(element)}> of <equality>")
            continue
        ends = _ends(xml, element, links, sites)
        if ends is not None and (open_by := _open_by(xml, element, links, sites)) is not None:
            left.add(f"<{tag_of(element)}> that is open by {open_by} in the pose of the file")
        elif ends is not None and ends[0] != ends[1]:
            point = None if tag_of(element) == "weld" else ends[2]
            key = (ends[0], ends[1]) if ends[0] < ends[1] else (ends[1], ends[0])
            between.setdefault(key, []).append((element, point))
    out = []
    for (first, second), items in between.items():
        element = items[0][0]
        name = (element.get("name") or f"{tag_of(element)} {first} {second}").replace("/", "_").replace("~", "-")
        points = [point for _, point in items if point is not None]
        far = [point for point in points[1:] if float(np.linalg.norm(point - points[0])) > SOLVED]
        if len(points) < len(items) or len(far) > 1:
            out.append(RobotJoint(name, "fixed", (first, second), xml.at(element)))
        elif far:
            axis = (far[0] - points[0]) / np.linalg.norm(far[0] - points[0])
            out.append(RobotJoint(name, "revolute", (first, second), xml.at(element), axis=axis, point=points[0]))
        else:
            pair, at = (first, second), xml.at(element)
            out.append(RobotJoint(name, "spherical", pair, at, point=points[0], closure=True))
    return out


def _ends(
    xml: Xml, element: Element, links: Mapping[str, Link], sites: Mapping[str, tuple[str, Array]]
) -> tuple[str, str, Array] | None:
    """The two bodies and the point (3,) in F."""
    if element.get("site1") is not None:
        for key in ("site1", "site2"):
            if element.get(key) not in sites:
                wrong = f"<{tag_of(element)}>: there is no site {in_quotes(element.get(key))}"
                xml.complain(element, wrong, did_you_mean(element.get(key) or "", sites, "the sites"))
                return None
        (first, X), (second, _) = sites[element.get("site1")], sites[element.get("site2")]
        return first, second, X[:3, 3]
    first, second = (element.get("body1") or "").replace("/", "_"), (element.get("body2") or _WORLD).replace("/", "_")
    for name in (first, second):
        if name not in links:
            wrong = f"<{tag_of(element)}>: there is no body {in_quotes(name)}"
            xml.complain(element, wrong, did_you_mean(name, links, "the bodies"))
            return None
    return first, second, place(links[first].X_FL, xml.vector(element, "anchor", (0.0, 0.0, 0.0)))


def _open_by(
    xml: Xml, element: Element, links: Mapping[str, Link], sites: Mapping[str, tuple[str, Array]]
) -> str | None:
    """By how much the two sides miss each other, in words; None where they meet, as one anchor always does."""
    welds = tag_of(element) == "weld"
    if element.get("site1") is not None:
        first, second = sites[element.get("site1")][1], sites[element.get("site2")][1]
    else:
        stated = xml.vector(element, "relpose", (0.0,) * 7) if welds else (0.0,) * 7
        if not any(stated[3:]):  # no pose is stated: that of the file
            return None
        ends = [links[(element.get(key) or _WORLD).replace("/", "_")].X_FL for key in ("body1", "body2")]
        first, second = ends[0] @ pose(quaternion(stated[3:]), stated[:3]), ends[1]
    gap = float(np.linalg.norm(first[:3, 3] - second[:3, 3]))
    cosine = 0.5 * (float(np.trace(first[:3, :3].T @ second[:3, :3])) - 1.0) if welds else 1.0
    angle = math.acos(min(max(cosine, -1.0), 1.0))
    if gap > LOOP_GAP:
        return f"{1e3 * gap:.3g} mm"
    return f"{math.degrees(angle):.3g}°" if angle > 10.0 * LOOP_GAP else None


def ratios(
    xml: Xml, root: Element, joints: Mapping[str, RobotJoint], defaults: Defaults, left: Count
) -> Iterator[Ratio]:
    """`<joint>` of `<equality>`, where it is linear in the other joint and goes through zero."""
    for element in _active(xml, root, defaults, "joint"):
        first, second = ((element.get(key) or "").replace("/", "_") for key in ("joint1", "joint2"))
        polynomial = (*(xml.numbers(element, element.get("polycoef", "0 1 0 0 0"), "polycoef", None) or ()), 0.0, 0.0)
        for name in (first, second):
            if name and name not in joints:
                wrong = f"<joint> of <equality>: there is no joint {in_quotes(name)}"
                xml.complain(element, wrong, did_you_mean(name, joints, "the joints"))
                return
        if not second or any(polynomial[2:]) or not polynomial[1]:
            left.add("<joint> of <equality> that is no ratio")
            continue
        if polynomial[0]:
            left.add("offset of <joint> of <equality>")
        yield Ratio((first, second), polynomial[1], xml.at(element), polynomial[0])
