"""A part, or a cluster of parts, is connected with the rest by no contact, group or assumption.

The connection is followed from the ground (without a known ground: from the largest cluster). Where the
function intends a joint between the cluster and the rest, KF401 reports it as missing and this rule
does not repeat it. Parts that overlap (KF201) touch. Where parts come as near each other as parts that touch do, and no
contact that is known says how (KF209), it is not known whether they overlap (KF210), or a part has play between two
others, less than the contact tolerance to either side, as balls and rollers between their races, the rule is
inconclusive: it denies nothing that it does not know.

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
from kinform.consistency.questions.captive_parts import CaptivePart
from kinform.consistency.questions.gaps import gap_between
from kinform.consistency.rule import Rule
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import quoted
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.findings import Finding, stated


def check(context: Context) -> Outcome:
    """Clusters of parts that are not connected with the ground."""
    touching = _clusters(context.assembly, context.contacts, unknown=True)
    apart, afloat = _apart(context, touching), list[CaptivePart]()
    if apart:
        near, afloat = _with_play(context, touching)
        apart = _apart(context, near)
    known = _apart(context, _clusters(context.assembly, context.contacts, unknown=False))
    sure = {name for cluster in apart for name in cluster}
    doubtful = [cluster for cluster in known if not sure.issuperset(cluster)]
    found = [_finding(context, cluster, touch=cluster in touching) for cluster in apart]
    return settled(found, _doubt(context, doubtful, afloat))


def _doubt(context: Context, clusters: list[tuple[str, ...]], afloat: list[CaptivePart]) -> str:
    """What is not known about some clusters, whether by parts with play or by contact of no known kind."""
    names, units = {name for cluster in clusters for name in cluster}, context.afloat.units if afloat else {}
    play = [one for one in afloat if any(units[name] in (one.name, *one.sides) for name in names)]
    reached = {unit for one in play for unit in (one.name, *one.sides)}
    others = [cluster[0] for cluster in clusters if not any(units.get(name) in reached for name in cluster)]
    words = [f"{quoted(others)}: no contact that is known, but see KF209 and KF210"] if others else []
    more = f" (and {len(play) - 1} more such)" if len(play) > 1 else ""
    return "; ".join(words + [f"{one.words()}{more}" for one in play[:1]])


def _with_play(context: Context, clusters: list[tuple[str, ...]]) -> tuple[list[tuple[str, ...]], list[CaptivePart]]:
    """The clusters, with those as one that parts with play are between, or may hold; and these parts."""
    units = context.afloat.units
    known = {units[name]: k for k, cluster in enumerate(clusters) for name in cluster}
    each = {unit: k for k, unit in enumerate(sorted(known))}
    sets, found = UnionFind(len(clusters)), list(context.afloat.between(each, known))
    for one in found:
        for side in one.sides:
            sets.union(known[one.name], known[side])
    joined: dict[int, list[str]] = {}
    for k, cluster in enumerate(clusters):
        joined.setdefault(sets.find(k), []).extend(cluster)
    return [tuple(sorted(names)) for names in joined.values()], found


def _apart(context: Context, clusters: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Those of the clusters that are not connected."""
    home = _home(context, clusters)
    return [cluster for cluster in clusters if cluster != home and not _intended(context.assembly, cluster)]


def _finding(context: Context, cluster: tuple[str, ...], *, touch: bool) -> Finding:
    alone, play = len(cluster) == 1, "" if touch else ", or have play between each other"
    part = context.assembly.part(cluster[0])
    return RULE.finding(
        cluster,
        f"{quoted(cluster)} {'touches' if alone else 'touch'} "
        f"{'no other part' if alone else f'each other{play}, but no other part'}",
        found=f"no contact {'' if alone else 'with the rest '}that is known, and no point that comes as near "
        f"{'another part' if alone else 'it'} as parts that touch do",
        intended="contact with the rest of the assembly",
        place=part.X_WP[:3, 3] if part.mesh is None else _middle(context.assembly, cluster[0]),
        declared=part.source,
        remedy="Check the pose, add the part that is missing between, or join it by [[group]] or [[assume]].",
        witness=gap_between(context.assembly, cluster, {str(p.name) for p in context.assembly.parts} - {*cluster})
        or stated(part.source, cluster[0].rpartition("/")[2]),
    )


def _clusters(assembly: Assembly, contacts: Contacts, *, unknown: bool) -> list[tuple[str, ...]]:
    """Parts connected by patches, overlaps, groups, assumptions, and stick bodies by their intended joints; contact of
    no known kind, and overlaps that are not sure, count or not."""
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
