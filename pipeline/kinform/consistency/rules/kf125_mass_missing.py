"""A link of a robot description moves, and neither it nor what is fixed to it has a mass.

Looked at where a description states the mass of some link: one that states none is for looking at. Links that fixed
joints hold together share what they have. A warning of a link with geometry, a note of one without, which is there to
put two joints in a row. Bodies of MJCF get the mass of their geoms, so that only those without any geometry count.

Why it matters: loaders differ. PyBullet takes 1 kg where no mass is stated, Gazebo leaves the link out with all that
hangs on it, MuJoCo refuses the model.

What to do: state `<inertial>` with the mass, the centre of mass and the inertia of the link, as its CAD file has them.

Example: `<mass value="0"/>` in the forearm of an arm.
"""

from __future__ import annotations

from collections.abc import Iterator

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import counted, quoted
from kinform.model.assembly import Source
from kinform.model.descriptions import DescribedLink, Description

LOADERS = {
    "urdf": "Gazebo leaves it out with all that hangs on it",
    "sdf": "Gazebo takes 1 kg and 1 kg·m² for it",
    "mjcf": "MuJoCo refuses a body that moves without mass",
}
"""What a program that reads the format makes of such a link."""


def check(context: Context) -> Outcome:
    """The moving links of every description that states masses."""
    weighing = [d for d in context.assembly.descriptions if any(_mass(link) > 0.0 for link in d.links)]
    if not weighing:
        return skipped("no description states the mass of a link")
    ranked = [item for description in weighing for item in _of_description(description)]
    return decided(gathered(ranked, "link"), f"{counted(sum(len(d.links) for d in weighing), 'link')} looked at")


def _mass(link: DescribedLink) -> float:
    return 0.0 if link.stated is None else link.stated.value


def _of_description(description: Description) -> Iterator[Ranked]:
    links = {link.name: link for link in description.links}
    number = {name: k for k, name in enumerate(links)}
    joints = [joint for joint in description.joints if all(name in links for name in joint.between)]
    rigid = UnionFind(len(links))
    for joint in joints:
        if joint.kind == "fixed":
            rigid.union(*(number[name] for name in joint.between))
    bodies: dict[int, list[DescribedLink]] = {}
    for name, link in links.items():
        bodies.setdefault(rigid.find(number[name]), []).append(link)
    moved = {rigid.find(number[joint.between[1]]): joint for joint in joints if joint.kind != "fixed"}
    for body, joint in moved.items():
        members = bodies[body]
        shaped = any(link.visuals or link.collisions for link in members)
        # what is negative is KF121
        if any(_mass(link) for link in members) or (description.format == "mjcf" and shaped):
            continue
        link = links[joint.between[1]]
        zero = link.stated is not None
        others = [other.name for other in members if other is not link]
        beside = f", nor has {quoted(others)}, fixed to it" if others else ""
        text = (
            f"link '{link.name}' moves on joint '{joint.name}' and "
            f"{'states the mass 0' if zero else 'states no mass'}{beside}"
        )
        if description.format in LOADERS:
            text += f": {LOADERS[description.format]}"
        finding = RULE.at("warning" if shaped else "note").finding(
            [link.name], text,
            found="0 kg" if zero else "no mass",
            intended="a positive mass",
            place=link.position,
            declared=Source(link.file, link.stated.line if link.stated is not None else link.line),
            remedy="State <inertial> with mass, centre of mass and inertia"
            + ("." if shaped else ", or make one joint of the two."),
        )  # fmt: skip
        yield Ranked("shaped" if shaped else "bare", float(len(members)), finding)


RULE = Rule("KF125", "mass-missing", "warning", __doc__, check, needs=("descriptions",), also=("note",))
