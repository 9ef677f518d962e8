"""Two links of a robot description touch like a joint that would close a loop, and the description leaves it open.

A tree of links cannot close a loop, so the joint where a linkage closes is left out, and the tree has more freedoms
than the mechanism. Contact of this kind is reported where the loop still moves when a joint closes it there, which is
computed. Contact that would lock the links is KF406.

Why it matters: a simulator lets the links of the loop move apart, and controllers see freedoms that are not there.

What to do: close the loop by what the format or the simulator has for it: `<equality><connect>` of MJCF, a joint with
two parents of SDF, a loop joint of Gazebo or Drake beside a URDF. If the links only pass each other, give them a gap.

Example: the coupler and the rocker of a four-bar, which has three joints in a URDF.
"""

from __future__ import annotations

from kinform.consistency.comparisons.links import described_links
from kinform.consistency.context import Context
from kinform.consistency.questions.open_loops import OpenLoop
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import axis, counted, number, place, quoted
from kinform.model.assembly import Source
from kinform.model.descriptions import DescribedLink
from kinform.model.findings import Finding


def check(context: Context) -> Findings:
    """Every open loop."""
    return [_finding(context, loop) for loop in context.open_loops]


def _finding(context: Context, loop: OpenLoop) -> Finding:
    joint, names = loop.joint, {str(c.joint.name): c.intended.name for c in context.intended if c.joint is not None}
    about = " a centre" if joint.axis is None else f" {axis(joint.axis)}"
    at = "" if joint.point is None or joint.type == "prismatic" else f" at {place(joint.point, context.units)}"
    through = [names.get(name, name) for name in loop.along]
    left = counted(loop.closed, "freedom")
    link = next((link for link in described_links(context.assembly) if link.name == loop.aside.bodies[1]), None)
    return RULE.finding(
        loop.aside.bodies,
        f"{quoted(loop.aside.bodies)} touch like a {joint.type} joint about{about}{at}, and no joint is stated there: "
        f"the loop through {quoted(through)} is open. As stated it has {counted(loop.stated, 'freedom')}, closed it "
        f"has {loop.closed}",
        found=f"{counted(loop.stated, 'freedom')} as stated, {loop.closed} with the {joint.type} joint{at}",
        intended=f"a closed loop of {left}",
        place=joint.point if joint.type != "prismatic" else None,
        declared=context.assembly.source if link is None else Source(link.file, link.line),
        remedy=_remedy(loop, link, str(next((d.format for d in context.assembly.descriptions), ""))),
    )


def _remedy(loop: OpenLoop, link: DescribedLink | None, form: str) -> str:
    """How to close it, with the place in the frame of the link (m)."""
    first, second = loop.aside.bodies
    joint, local = loop.joint, "0 0 0"
    if link is not None and joint.point is not None:
        local = " ".join(number(round(float(v), 7), 6) for v in link.rotation.T @ (joint.point - link.position))
    if form == "mjcf" and joint.type != "prismatic":
        return f'Add <connect body1="{second}" body2="{first}" anchor="{local}"/> to <equality>, or give the two a gap.'
    where = "" if joint.type == "prismatic" else f" at {local} m in the frame of '{second}'"
    return (
        f"Close the loop by a {joint.type} joint{where}, which a tree of links cannot state: by a second parent in "
        "SDF, <equality> in MJCF, or a constraint of the simulator; or give the two a gap."
    )


RULE = Rule("KF419", "loop-open", "warning", __doc__, check, needs=("descriptions", "comparisons"))
