"""Contacts of one joint that lie apart, and what they hold more than once: the four hinges of a door.

Patches that lie close together make one site, such as a journal with its thrust faces. Each site on its own holds so
many directions; what their sum exceeds the joint's is redundant, however rigid both bodies are.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import numpy as np

from kinform.foundation.algebra.screws import Frame, rows, scaled, span
from kinform.foundation.algebra.vectors import cross, dot, norm
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SOLVED
from kinform.kinematics.joints.pair.evidence import COAXIAL
from kinform.kinematics.screws.wording import Locked, locked_text, locked_wrenches, rows_too_many
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Redundancy, RedundancyKind
from kinform.model.tolerances import Tolerances

FEW_OF_SITE = 4
"""One of so many samples is looked at before all are, where patches may lie together. Chosen, not measured."""


def redundancy(
    kind: RedundancyKind, text: str, rows: int, joints: Sequence[Joint], locked: Sequence[Locked], frame: Frame
) -> Redundancy:
    """A redundancy of these joints, with `locked` wrenches that are scaled in `frame`."""
    wrenches = np.array([wrench for _, wrench in locked]).reshape(-1, 6)
    # from (τ about the centre over the length; f) to (τ at the origin; f)
    moment = wrenches[:, :3] * frame.length + cross(frame.centre, wrenches[:, 3:])
    return Redundancy(
        kind=kind,
        text=text,
        rows=rows,
        joints=tuple(joint.name for joint in joints),
        patches=tuple(sorted({index for joint in joints for index in joint.patches})),
        directions=tuple(words for words, _ in locked),
        wrenches=np.hstack([moment, wrenches[:, 3:]]),
    )


def redundancy_within(joint: Joint, patches: Sequence[Patch], tolerances: Tolerances) -> Redundancy | None:
    """What the separate contacts of one joint hold more than once; None where there is one, or nothing is."""
    if len(joint.patches) < 2:
        return None
    members = [patches[k] for k in joint.patches]
    groups = sites(members)
    if len(groups) < 2:
        return None
    frame = Frame.of(np.concatenate([p.points for p in members]))
    spaces = [_held([members[k] for k in group], joint, frame, tolerances) for group in groups]
    each = [space.shape[1] for space in spaces]
    # what faces hold that stand off, as those that end its end play, is no contact of any site
    needed = min(6 - joint.freedoms, span(np.hstack(spaces)).shape[1])
    excess = sum(each) - needed
    if excess <= 0:
        return None
    twice = _twice(spaces)
    named = twice if len(twice) == excess else []
    plain = list(dict.fromkeys(word.removesuffix(" with a moment about it") for word, _ in named))
    which = f": {locked_text(plain)}" if named else ""
    held = str(each[0]) + " each" if len(set(each)) == 1 else " + ".join(map(str, each))
    text = (
        f"{len(groups)} {_noun(joint, members)} {joint.name} hold {held} where {needed} would do: "
        f"{rows_too_many(excess)}{which}{'; but the joint is ambiguous' if joint.status == 'ambiguous' else ''}"
    )
    return redundancy("pair", text, excess, [joint], named, frame)


def sites(patches: Sequence[Patch]) -> list[list[int]]:
    """Indices of patches that lie together, by their first."""
    sets = UnionFind(len(patches))
    centres = [np.full(len(p.points), 1.0 / len(p.points)) @ p.points for p in patches]
    radii = [_radius(p.points - c) for p, c in zip(patches, centres, strict=True)]
    for k in range(len(patches)):
        for n in range(k):
            if sets.find(k) == sets.find(n):
                continue
            # Patches whose gap is below this share of the radius of the smaller one belong together.
            near = 0.25 * min(radii[k], radii[n])
            if norm(centres[k] - centres[n]) - radii[k] - radii[n] > near:
                continue
            a, b = patches[k].points - centres[k], patches[n].points - centres[k]
            # where they lie together some of the samples mostly tell
            if _distance(a[::FEW_OF_SITE], b[::FEW_OF_SITE]) <= near or _distance(a, b) <= near:
                sets.union(k, n)
    groups: dict[int, list[int]] = {}
    for k in range(len(patches)):
        groups.setdefault(sets.find(k), []).append(k)
    return list(groups.values())


def _radius(points: Array) -> float:
    """Greatest distance of points (n, 3) from the origin."""
    return sqrt(float(dot(points, points).max()))


def _distance(a: Array, b: Array) -> float:
    """Least distance between points (n, 3) and (m, 3) near to the origin."""
    square = dot(a, a)[:, None] + dot(b, b) - 2.0 * (a @ b.T)
    return sqrt(max(float(square.min()), 0.0))


def _held(patches: Sequence[Patch], joint: Joint, frame: Frame, tolerances: Tolerances) -> Array:
    """(6, r) orthonormal wrenches, scaled in `frame`, that a site on its own holds."""
    points = np.concatenate([p.points for p in patches])
    site = Frame.of(points)
    share = np.concatenate([np.sqrt(p.area) * p.weights / p.weights.sum() for p in patches])
    weighted = rows(points, np.concatenate([p.normals for p in patches]), site) * np.sqrt(share / share.sum())[:, None]
    free = span(scaled(joint.twists.T, site))
    weighted = weighted - (weighted @ free) @ free.T
    _, values, right = np.linalg.svd(weighted, full_matrices=False)
    wrenches = right[values > tolerances.held]
    # (τ about the site's centre over its length; f) in the common frame
    force = wrenches[:, 3:]
    moment = wrenches[:, :3] * site.length + cross(site.centre - frame.centre, force)
    return span(np.hstack([moment / frame.length, force]).T)


def _twice(spaces: Sequence[Array]) -> list[Locked]:
    """What each site holds that those before it hold together."""
    twice: list[Locked] = []
    before = spaces[0]
    for space in spaces[1:]:
        left, cosines, _ = np.linalg.svd(space.T @ before, full_matrices=False)
        both = space @ left[:, cosines > 1.0 - SOLVED]
        if both.shape[1]:
            # Directions of contacts this near (sine) to an axis of the world have its name: contacts are not snapped.
            twice += locked_wrenches(both.T, 0.02)
        before = span(np.hstack([before, space]))
    return twice


def _noun(joint: Joint, patches: Sequence[Patch]) -> str:
    if joint.type in ("revolute", "cylindrical", "screw") and all(p.kind in (*COAXIAL, "plane") for p in patches):
        return "coaxial hinges of" if joint.type == "revolute" else "coaxial journals of"
    return "separate contacts of"
