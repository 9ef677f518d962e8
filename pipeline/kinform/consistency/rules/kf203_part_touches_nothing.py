"""A part, or a cluster of parts, is connected with the rest by no contact, group or assumption.

The connection is followed from the ground (without a known ground: from the largest cluster). Where the
function intends a joint between the cluster and the rest, KF401 reports it as missing and this rule
does not repeat it. Parts that overlap (KF201) touch. Where parts come as near each other as parts that touch do, and no
contact that is known says how (KF209), or it is not known whether they overlap (KF210), the rule is inconclusive: it
denies nothing that it does not know.

Why it matters: a part that nothing holds has six freedoms. Usually its pose is wrong, a part between is
missing, or the clearance is wider than the contact tolerance.

What to do: check `position` and rotation of the part; add what is missing; if the gap is meant, raise
`tolerances.contact`, or say how the parts are joined by `[[group]]` or `[[assume]]`.

Example: a camera whose bracket was left out hangs 3 mm above its ring.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import quoted
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.findings import Finding


def check(context: Context) -> Outcome:
    """Clusters of parts that are not connected with the ground."""
    apart = _apart(context, unknown=True)
    sure = {name for cluster in apart for name in cluster}
    doubtful = [cluster for cluster in _apart(context, unknown=False) if not sure.issuperset(cluster)]
    names = quoted([cluster[0] for cluster in doubtful])
    doubt = f"{names}: no contact that is known, but see KF209 and KF210" if doubtful else ""
    return settled([_finding(context, cluster) for cluster in apart], doubt)


def _apart(context: Context, *, unknown: bool) -> list[tuple[str, ...]]:
    """The clusters that are not connected; contact of no known kind, and overlaps that are not sure, count or not."""
    clusters = _clusters(context.assembly, context.contacts, unknown=unknown)
    home = _home(context, clusters)
    return [cluster for cluster in clusters if cluster != home and not _intended(context.assembly, cluster)]


def _finding(context: Context, cluster: tuple[str, ...]) -> Finding:
    alone = len(cluster) == 1
    part = context.assembly.part(cluster[0])
    return RULE.finding(
        cluster,
        f"{quoted(cluster)} {'touches' if alone else 'touch'} "
        f"{'no other part' if alone else 'each other, but no other part'}",
        found=f"no contact {'' if alone else 'with the rest '}that is known, and no point that comes as near "
        f"{'another part' if alone else 'it'} as parts that touch do",
        intended="contact with the rest of the assembly",
        place=part.X_WP[:3, 3] if part.mesh is None else _middle(context.assembly, cluster[0]),
        declared=part.source,
        remedy="Check the pose, add the part that is missing between, or join it by [[group]] or [[assume]].",
    )


def _clusters(assembly: Assembly, contacts: Contacts, *, unknown: bool) -> list[tuple[str, ...]]:
    """Parts connected by patches, overlaps, groups, assumptions, and stick bodies by their intended joints."""
    index = {str(part.name): k for k, part in enumerate(assembly.parts)}
    sets = UnionFind(len(index))

    def join(names: tuple[str, ...]) -> None:
        for other in names[1:]:
            sets.union(index[names[0]], index[other])

    for patch in contacts.patches:
        if unknown or not patch.unknown:
            join(patch.parts)
    for overlap in (*contacts.interferences, *(contacts.possible_overlaps if unknown else ())):
        join(overlap.parts)
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
