"""A part, or a cluster of parts, is connected with the rest by no contact, group or assumption.

The connection is followed from the ground (without a known ground: from the largest cluster). Where the
function intends a joint between the cluster and the rest, KF401 reports it as missing and this rule
does not repeat it.

Why it matters: a part that nothing holds has six freedoms. Usually its pose is wrong, a part between is
missing, or the clearance is wider than the contact tolerance.

What to do: check `position` and rotation of the part; add what is missing; if the gap is meant, raise
`tolerances.contact`, or say how the parts are joined by `[[group]]` or `[[assume]]`.

Example: a camera whose bracket was left out hangs 3 mm above its ring.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import quoted
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts


def check(context: Context) -> Findings:
    """Clusters of parts that are not connected with the ground."""
    clusters = _clusters(context.assembly, context.contacts)
    home = _home(context, clusters)
    for cluster in clusters:
        if cluster == home or _intended(context.assembly, cluster):
            continue
        alone = len(cluster) == 1
        part = context.assembly.part(cluster[0])
        yield RULE.finding(
            cluster,
            f"{quoted(cluster)} {'touches' if alone else 'touch'} "
            f"{'no other part' if alone else 'each other, but no other part'}",
            found="no surface within the contact tolerance of another part",
            intended="contact with the rest of the assembly",
            place=part.X_WP[:3, 3] if part.mesh is None else _middle(context.assembly, cluster[0]),
            declared=part.source,
            remedy="Check the pose, add the part that is missing between, or join it by [[group]] or [[assume]].",
        )


def _clusters(assembly: Assembly, contacts: Contacts) -> list[tuple[str, ...]]:
    """Parts connected by patches, groups, assumptions, and stick bodies by their intended joints."""
    index = {str(part.name): k for k, part in enumerate(assembly.parts)}
    sets = UnionFind(len(index))

    def join(names: tuple[str, ...]) -> None:
        for other in names[1:]:
            sets.union(index[names[0]], index[other])

    for patch in contacts.patches:
        join(patch.parts)
    for group in assembly.groups:
        join(group.parts)
    pairs = [a.between for a in assembly.assumptions if not a.ignore]
    pairs += [j.between for j in assembly.function.joints if _has_stick(assembly, j.between)]
    for first, second in pairs:
        join((assembly.parts_of(first)[0], assembly.parts_of(second)[0]))
    members: dict[int, list[str]] = {}
    for name in sorted(index):
        members.setdefault(sets.find(index[name]), []).append(name)
    return sorted(tuple(names) for names in members.values())


def _has_stick(assembly: Assembly, between: tuple[str, str]) -> bool:
    return any(assembly.part(part).mesh is None for name in between for part in assembly.parts_of(name))


def _home(context: Context, clusters: list[tuple[str, ...]]) -> tuple[str, ...]:
    """The cluster that holds the ground; the largest when no ground is known."""
    ground: set[str] = set()
    if context.design.kinematics is not None:
        ground = {part for body in context.design.kinematics.bodies if body.ground for part in body.parts}
    elif context.assembly.ground is not None:
        ground = set(context.assembly.parts_of(context.assembly.ground))
    holding = [cluster for cluster in clusters if ground.intersection(cluster)]
    return holding[0] if holding else max(clusters, key=len)


def _intended(assembly: Assembly, cluster: tuple[str, ...]) -> bool:
    """Whether an intended joint leads out of the cluster: its absence is then reported as such."""
    inside = set(cluster)
    ends = [[inside.issuperset(assembly.parts_of(name)) for name in j.between] for j in assembly.function.joints]
    return any(first != second for first, second in ends)


def _middle(assembly: Assembly, name: str) -> Array:
    """Middle of the part's box in the world (m)."""
    part = assembly.part(name)
    assert part.mesh is not None
    low, high = part.mesh.placed_box(part.X_WP)
    return np.asarray(0.5 * (low + high))


RULE = Rule("KF203", "part-touches-nothing", "error", __doc__, check, needs=("several parts", "contacts"))
