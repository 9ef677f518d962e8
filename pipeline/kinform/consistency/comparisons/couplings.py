"""The ratio that geometry gives two intended joints: through one contact, or through several one after the other."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kinform.foundation.constants import COVERAGE
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SOLVED
from kinform.foundation.words import rate
from kinform.frozen import dataclass
from kinform.function import resolve_joint
from kinform.kinematics import coupling_aside, is_higher
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import Coupling as Stated
from kinform.model.kinematics import Coupling, Joint, Kinematics

UNCOUNTED_TEETH = 1e-2
"""Relative: what the ratio of teeth at one pose may be off: facets of flanks change it from pose to pose. Chosen, not
measured."""
ROUNDED_RATIO = 1e-3
"""Relative: what a stated ratio of counted teeth, or a stated pitch, may be off: rounded to four digits."""
UNCERTAIN_RATIO = 0.05
"""Relative uncertainty, for each coupling of a chain, beyond which a ratio says nothing: gears of 20 and 21 teeth
differ by so much."""


@dataclass(frozen=True)
class Ratio:
    """value(first) over value(second) of intended joints, by the designer's signs, and by how much it may be off."""

    value: float
    allowed: float
    through: tuple[str, ...]
    links: tuple[tuple[float, float], ...] = ()
    """Of each coupling on the way, and the signs: what the first side turns by while the second turns by the other."""


def derived_ratio(
    assembly: Assembly, kinematics: Kinematics, stated: Stated, contacts: Contacts | None = None
) -> Ratio | str:
    """What the geometry gives for a stated coupling, or the reason why it gives nothing. Teeth whose contact was set
    aside, as the function states all joints, are counted in `contacts`."""
    ends = [resolve_joint(assembly, kinematics, name) for name in stated.joints]
    for end in ends:
        if end.joint is None:
            return end.reason
    first, second = (str(end.joint.name) for end in ends if end.joint is not None)
    if first == second:
        return "both names stand for one joint: name two"
    chain = _chain(kinematics, first, second) or _aside(assembly, kinematics, first, second, contacts)
    if chain is None:
        return "no gear, cam or screw contact between these joints: bring the teeth into contact"
    ratio, relative = float(ends[0].sign * ends[1].sign), 0.0
    links = [(ratio, 1.0)]
    for coupling, forward in chain:
        if coupling.status != "determined":
            return f"the contact '{coupling.through}' is {coupling.status}: export a finer mesh, or model all teeth"
        if coupling.kind == "cam":
            return f"'{coupling.through}' is a cam: its ratio is another in every pose"
        up, down = _turns(coupling)
        links.append((up, down) if forward else (down, up))
        if coupling.meshing is not None:
            ratio *= coupling.meshing.ratio if forward else 1.0 / coupling.meshing.ratio
            relative += ROUNDED_RATIO
            continue
        ratio *= coupling.ratio if forward else 1.0 / coupling.ratio
        spread = coupling.uncertainty / abs(coupling.ratio) if math.isfinite(coupling.uncertainty) else 0.0
        relative += max(
            COVERAGE * spread,
            ROUNDED_RATIO if coupling.kind == "screw" else UNCOUNTED_TEETH,
        )
    if relative > UNCERTAIN_RATIO * len(chain):
        return (
            f"the {shown_ratio(assembly, stated, ratio)} is uncertain by {100 * relative:.2g} %: model the teeth of "
            "both sides, or export a finer mesh"
        )
    through = tuple(str(coupling.through) for coupling, _ in chain)
    return Ratio(ratio, abs(ratio) * relative, through, tuple(links))


def _turns(coupling: Coupling) -> tuple[float, float]:
    """Values of both joints as one is in step with the other: teeth, where their numbers alone are the ratio."""
    if coupling.meshing is None:
        return coupling.ratio, 1.0
    ratio, (first, second) = coupling.meshing.ratio, coupling.meshing.teeth
    if first and abs(math.copysign(second / first, ratio) - ratio) <= SOLVED * abs(ratio):
        return math.copysign(second, ratio), float(first)
    return ratio, 1.0


def shown_ratio(assembly: Assembly, stated: Stated, ratio: float) -> str:
    """A ratio of SI values as the manifest has it, of degrees and lengths in the assembly's units:
    "ratio 0.02 mm/°"; with one for each further joint, where there are more than two."""
    first, *slides = (_slides(assembly, name) for name in stated.every)
    ratios = (ratio, *stated.others.values())
    shown = [rate(one, first, slide, assembly.units) for one, slide in zip(ratios, slides, strict=True)]
    return f"ratio {shown[0]}" if len(shown) == 1 else f"ratios {', '.join(shown)}"


def _slides(assembly: Assembly, name: str) -> bool:
    """Whether values of the joint are lengths."""
    return any(joint.name == name and joint.type == "prismatic" for joint in assembly.function.joints)


@dataclass(frozen=True)
class Difference:
    """How far the motions that contact leaves are from a coupling of three joints and more, at the pose of the
    meshes."""

    share: float
    """Of the greatest term of the sum that should be zero, in the motion where it is greatest."""
    found: float
    """Value of the first joint in that motion (rad or m, by the designer's sense), and as the ratios have it."""
    meant: float
    through: tuple[str, ...]
    """Joints carried by points and lines alone, which tie them."""
    terms: tuple[float, ...] = ()
    """Of the sum that should be zero, in the motion where it is farthest from it."""


def derived_sum(
    assembly: Assembly, kinematics: Kinematics, stated: Stated, contacts: Contacts | None
) -> Difference | str:
    """What contact says of a stated coupling of three joints and more, or why it says nothing.

    Read out of all motions that contact leaves, each a ray of joint rates: the sum must be zero in every one.
    """
    ends = [resolve_joint(assembly, kinematics, name) for name in stated.every]
    for end in ends:
        if end.joint is None:
            return end.reason
    names = [str(end.joint.name) for end in ends if end.joint is not None]
    if len(set(names)) < len(names):
        return "two of its names stand for one joint"
    tied = [
        str(joint.name)
        for joint in kinematics.joints
        if contacts is not None and is_higher(joint, contacts.patches) and _on_the_way(kinematics, names, joint)
    ]
    if kinematics.mobility.by_contact is not None or not tied:
        return "no gear, cam or screw contact between these joints: bring the teeth into contact"
    moved = [{str(name): rate for name, _, rate in freedom.drives} for freedom in kinematics.mobility.named]
    terms = np.array([factor * end.sign for end, factor in zip(ends, stated.terms.values(), strict=True)])
    rates = np.array([[motion.get(name, 0.0) for name in names] for motion in moved]).reshape(-1, len(names)) * terms
    sizes = np.abs(rates).max(axis=1, initial=0.0)
    if not sizes.any():
        return "contact lets none of these joints move"
    shares = np.abs(rates.sum(axis=1)) / np.where(sizes > 0.0, sizes, 1.0)
    worst = int(shares.argmax())
    found, meant = float(rates[worst, 0]), -float(rates[worst, 1:].sum())
    doubtful = next((j for j in kinematics.joints if j.name in tied and j.status != "determined"), None)
    if doubtful is not None:
        at = "agrees with the ratios" if shares[worst] <= UNCOUNTED_TEETH else "is off by "
        off = "" if shares[worst] <= UNCOUNTED_TEETH else f"{100 * shares[worst]:.2g} % of its greatest term"
        return f"the contact '{doubtful.name}' is {doubtful.status}; as it stands, the motion at this pose {at}{off}"
    if UNCOUNTED_TEETH < shares[worst] <= UNCERTAIN_RATIO:
        return f"the motion at this pose is off by {100 * shares[worst]:.2g} %, which normals of teeth may be"
    return Difference(float(shares[worst]), found, meant, tuple(tied), tuple(map(float, rates[worst])))


def _on_the_way(kinematics: Kinematics, names: list[str], joint: Joint) -> bool:
    """Whether the joints of these names lead from the one body of the joint to the other."""
    number = {body.name: k for k, body in enumerate(kinematics.bodies)}
    met = UnionFind(len(number))
    for one in kinematics.joints:
        if one.name in names and one.name != joint.name:
            met.union(*(number[name] for name in one.bodies))
    return len({met.find(number[name]) for name in joint.bodies}) == 1


def coupled_through(assembly: Assembly, kinematics: Kinematics, stated: Stated) -> tuple[str, ...]:
    """Names of the joints, teeth, cams or screws, that a stated coupling goes through; none where there are none."""
    joints = [resolve_joint(assembly, kinematics, name).joint for name in stated.joints]
    names = [str(joint.name) for joint in joints if joint is not None]
    if len(names) < 2 or names[0] == names[1]:
        return ()
    return tuple(str(coupling.through) for coupling, _ in _chain(kinematics, names[0], names[1]) or [])


def _chain(kinematics: Kinematics, first: str, second: str) -> list[tuple[Coupling, bool]] | None:
    """The fewest couplings that lead from the one joint to the other, each with whether it is taken forwards."""
    links = (*kinematics.couplings, *_leads(kinematics))
    came: dict[str, tuple[str, Coupling, bool]] = {}
    queue = deque([first])
    while queue and second not in came:
        name = queue.popleft()
        for coupling in links:
            for here, there, forward in ((*coupling.joints, True), (*coupling.joints[::-1], False)):
                if here == name and there != first and there not in came:
                    came[str(there)] = (name, coupling, forward)
                    queue.append(str(there))
    if second not in came:
        return None
    out: list[tuple[Coupling, bool]] = []
    name = second
    while name != first:
        name, coupling, forward = came[name]
        out.append((coupling, forward))
    return out[::-1]


def _aside(
    assembly: Assembly, kinematics: Kinematics, first: str, second: str, contacts: Contacts | None
) -> list[tuple[Coupling, bool]] | None:
    """The coupling by teeth that constrain nothing, as the function states all joints."""
    if contacts is None or kinematics.mobility.by_contact is None:
        return None
    joints = {str(joint.name): joint for joint in kinematics.joints}
    found = coupling_aside(assembly, kinematics.bodies, contacts.patches, (joints[first], joints[second]))
    return None if found is None else [(found, True)]


def _leads(kinematics: Kinematics) -> Iterator[Coupling]:
    """Each screw with the slide that it moves: its own value is in as fixed a ratio to that of the slide as the turn
    beside it, where all freedoms have one ratio."""
    types = {joint.name: joint.type for joint in kinematics.joints}
    for coupling in kinematics.couplings:
        slides = [name for name in coupling.joints if types[name] == "prismatic"]
        if coupling.kind != "screw" or len(slides) != 1:
            continue
        rates = []
        for freedom in kinematics.mobility.named:
            moved = {name: rate for name, _, rate in freedom.drives}
            if coupling.through in moved or slides[0] in moved:
                rates.append((moved.get(slides[0], 0.0), moved.get(coupling.through, 0.0)))
        ratios = [slide / screw for slide, screw in rates if screw]
        if len(ratios) == len(rates) > 0 and ratios[0] and np.ptp(ratios) <= ROUNDED_RATIO * abs(ratios[0]):
            yield replace(coupling, joints=(slides[0], coupling.through), ratio=ratios[0])
