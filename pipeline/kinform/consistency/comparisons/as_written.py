"""Axes, places and ranges of joints as the file writes them that states the joint, to be pasted there.

A manifest has the world's frame, its own unit and degrees; a description the frame that its format asks for, metres and
radians, or the degrees of an MJCF. Nothing is given of a joint that the manifest of a sub-assembly states, whose frame
is not known here, and of axes in an SDF from before 1.7, whose frames differ by version.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

import numpy as np
from lxml import etree

from kinform.consistency.context import Context
from kinform.formats.description.elements import xml_bytes
from kinform.formats.mjcf.reading.defaults import ranges_of
from kinform.foundation.units import metres_per
from kinform.foundation.words import number
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.descriptions import DescribedLink, Description
from kinform.model.function import Coupling, IntendedJoint

NOTHING = 1e-6
"""Share of the largest number below which another is written as zero: the digits that are written."""
EXPRESSED_SINCE = (1, 7)
"""Version of SDF from which on an axis may say in which frame it is."""


@dataclass(frozen=True, eq=False)
class _Stated:
    """The entry of a description that states a joint."""

    description: Description
    parent: DescribedLink
    child: DescribedLink

    @property
    def format(self) -> str:
        return self.description.format

    def own(self, name: str) -> str:
        """A name of the assembly as the description has it."""
        return name.removeprefix(f"{self.description.prefix}/")


def axis_as_written(context: Context, joint: IntendedJoint, axis: Array) -> str:
    """What states this axis (3,) of the world; "" where that is not known."""
    stated = _stated(context, joint)
    if stated is None:
        return f"`axis = [{_numbers(axis, ', ')}]`" if _in_top(context, joint) else ""
    local = _numbers(stated.child.rotation.T @ axis)
    if stated.format == "urdf":
        return f'`<axis xyz="{local}"/>`'
    if stated.format == "mjcf":
        return f'`axis="{local}"`'
    version = re.search(r"<sdf[^>]*\bversion\s*=\s*[\"'](\d+)\.(\d+)", stated.description.text)
    if version is None or (int(version[1]), int(version[2])) < EXPRESSED_SINCE:
        return ""
    return f'`<xyz expressed_in="{stated.own(stated.child.name)}">{local}</xyz>`'


def point_as_written(context: Context, joint: IntendedJoint, point: Array) -> str:
    """What places the joint at this point (3,) m of the world, and leaves all geometry where it is; "" where that is
    not known. A URDF places the link with its joint."""
    stated = _stated(context, joint)
    if stated is None:
        if not _in_top(context, joint):
            return ""
        return f"`point = [{_numbers(point / metres_per(context.units), ', ')}]`"
    parent, child = stated.parent, stated.child
    local = _numbers(child.rotation.T @ (point - child.position))
    if stated.format == "mjcf":
        return f'`pos="{local}"`'
    if stated.format == "sdf":
        return f"`{local}` as the first numbers of its <pose>, in the frame of link '{stated.own(child.name)}'"
    if joint.point is None:
        return ""
    moved = point - joint.point
    origin = _numbers(parent.rotation.T @ (child.position + moved - parent.position))
    back = _numbers(child.rotation.T @ -moved)
    return (
        f'`xyz="{origin}"` in its <origin>, and add `{back}` to the xyz of all origins in link '
        f"'{stated.own(child.name)}' and of the joints whose parent it is"
    )


def range_as_written(context: Context, joint: IntendedJoint, ends: tuple[float, float]) -> str:
    """What states this range (rad or m, in the designer's sense); "" where that is not known."""
    stated, slides = _stated(context, joint), joint.type == "prismatic"
    if stated is None:
        if slides and not _in_top(context, joint):
            return ""
        unit = metres_per(context.units) if slides else math.pi / 180.0
        return f"`range = [{_numbers((end / unit for end in ends), ', ')}]`"
    if not all(map(math.isfinite, ends)):
        return ""
    lower, upper = _numbers(ends).split()
    if stated.format == "urdf":
        return f'`lower="{lower}" upper="{upper}"`'
    if stated.format == "sdf":
        return f"`<lower>{lower}</lower><upper>{upper}</upper>`"
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    root = etree.fromstring(xml_bytes(stated.description.text), parser)
    found = [values for _, values in ranges_of(root, stated.own(joint.name), ends, slides=slides)]
    return f'`range="{_numbers(found[0])}"`' if found else ""


def pitch_as_written(context: Context, joint: IntendedJoint, pitch: float) -> str:
    """ ": `pitch = 2`": what states this lead (m a turn); "" where that is not known."""
    if not _in_top(context, joint) or _stated(context, joint) is not None:
        return ""
    return f": `pitch = {_numbers([pitch / metres_per(context.units)])}`"


def ratio_as_written(context: Context, coupling: Coupling, ratio: float) -> str:
    """ ": `ratio = -0.5`": what states this ratio of SI values between two joints; "" where that is not known."""
    if coupling.file == context.assembly.source.file and not _described(context, coupling.file):
        kinds = {joint.name: joint.type for joint in context.function.joints}
        first, second = (
            metres_per(context.units) if kinds.get(name) == "prismatic" else math.pi / 180.0 for name in coupling.joints
        )
        return f": `ratio = {_numbers([ratio * second / first])}`"
    return f': `multiplier="{_numbers([ratio])}"`' if _described(context, coupling.file) == "urdf" else ""


def _described(context: Context, file: str) -> str:
    """The format of the description that is in a file; "" where none is."""
    return next((one.format for one in context.assembly.descriptions if one.file == file), "")


def place_in_link(link: DescribedLink, place: Array) -> str:
    """Coordinates (m) of a point (3,) of the world in the frame of a link."""
    return f"`{_numbers(link.rotation.T @ (place - link.position))}`"


def _stated(context: Context, joint: IntendedJoint) -> _Stated | None:
    """The entry of the description that states the joint; None where a manifest does."""
    for description in context.assembly.descriptions:
        links = {link.name: link for link in description.links}
        for one in description.joints:
            if (one.name, one.file, one.line) == (joint.name, joint.file, joint.line):
                ends = [links.get(name) for name in one.between]
                if ends[0] is not None and ends[1] is not None and description.format:
                    return _Stated(description, ends[0], ends[1])
    return None


def _in_top(context: Context, joint: IntendedJoint) -> bool:
    """Whether the top manifest states it, in whose frame and unit the assembly is."""
    return joint.file == context.assembly.source.file


def _numbers(values: Iterable[float], between: str = " ") -> str:
    """With six digits; what is nothing beside the largest is 0."""
    given = np.array([*values], dtype=np.float64)
    most = float(np.abs(given[np.isfinite(given)]).max(initial=0.0))
    return between.join(number(0.0 if abs(value) < NOTHING * most else value, 6) for value in given.tolist())
