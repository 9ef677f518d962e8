"""`<actuator>` of an MJCF: the most that joints are given."""

from __future__ import annotations

import math

from kinform.formats.description.elements import Element, Xml
from kinform.formats.mjcf.reading.defaults import ACTUATOR, Compiler, Defaults


def efforts(xml: Xml, root: Element, defaults: Defaults, compiler: Compiler) -> dict[str, float]:
    """By joint the most (N·m, N) that all its actuators can give it together; none where one of them has no limit."""
    out: dict[str, float] = {}
    for group in xml.children(root, "actuator"):
        for element in xml.children(group):
            said = defaults.said(element, None, ACTUATOR)
            force = xml.numbers(element, said.get("forcerange", ""), "forcerange", None) or ()
            gear = xml.numbers(element, said.get("gear", "1"), "gear", None) or (1.0,)
            limited = said.get("forcelimited", "auto")
            off = limited == "false" or (limited == "auto" and not compiler.autolimits)
            most = max(map(abs, force)) if len(force) == 2 and not off else 0.0
            for key in ("joint", "jointinparent"):
                if key in said:
                    name = said[key].replace("/", "_")
                    out[name] = out.get(name, 0.0) + (most * abs(gear[0]) if most > 0.0 else math.inf)
    return {name: effort for name, effort in out.items() if math.isfinite(effort)}
