"""Two revisions of a design on one page: before and after in one view with a slider between, changed parts coloured,
beside what was done and what follows from it."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from kinform.changes.causes import Cause
from kinform.changes.comparison import Comparison
from kinform.changes.render import cause_lines, change_lines, new_lines, verdict_words
from kinform.design import Design
from kinform.foundation.algebra.displacements import displacement, inverse, twist_of
from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.units import metres_per
from kinform.model.assembly import Part
from kinform.reports.constants import EYE_RISE, EYE_TURN, FINDING_MARGIN, FINDING_SHIFT, FINDING_ZOOM, OVERLAP_COLOUR
from kinform.reports.page import Artist, Scene
from kinform.reports.page.html import environment, frame, image_url
from kinform.reports.page.meshes import shape_of
from kinform.reports.page.packing import Blob
from kinform.reports.page.scene_data import FIT_COLOURS, packed_frames, packed_mesh
from kinform.reports.values.plain import plain

REVISION_COLOURS = {
    "as it was": "#8b929c", "moved": "#3f7fbf", "other material": "#b08abf", "other shape, before": "#d39a5b",
    "other shape, after": "#2e9e76", "new": "#79ab83", "gone": "#c9807a",
}  # fmt: skip
"""Of parts on the page of two revisions; the legend and the text say the same in words."""


def diff_page(comparison: Comparison, before: Design, after: Design, files: tuple[str, str]) -> str:
    """The page of a comparison of two designs, which were read from these files."""
    drawn, blob, kinds = _drawn(comparison, before, after)
    numbers = {part["name"]: k for k, part in enumerate(drawn["parts"])}
    kind, sign = ("consistent", "✓") if comparison.code == 0 else ("unverified", "?" if comparison.code == 2 else "Δ")
    return (
        environment()
        .get_template("diff.html.j2")
        .render(
            **frame(drawn, blob),
            name=after.assembly.name,
            verdict=verdict_words(comparison).partition(" beyond ")[0],
            beyond=f"beyond {comparison.tolerance.in_words()}",
            kind=kind,
            sign=sign,
            files=f"before: {files[0]}, after: {files[1]}",
            overview=image_url(Artist(Scene(after)).overview()),
            groups=_groups(comparison, numbers),
            missing=comparison.missing,
            new=new_lines(comparison),
            legend=[(kind, colour, kinds[kind]) for kind, colour in REVISION_COLOURS.items() if kinds[kind]],
        )
    )


def _groups(comparison: Comparison, numbers: dict[str, int]) -> list[dict[str, Any]]:
    """Titles and changes, and the number of the part where a title is about one."""
    out = []
    groups = comparison.groups
    for group in groups:
        titles = cause_lines(group, comparison)
        own = {cause.part for cause in group.causes}
        number = numbers.get(next(iter(own)), -1) if len(own) == 1 else -1
        changes = [_split(change_lines(change, own)) for change in group.changes]
        if titles:
            out.append({"title": titles[0], "part": number, "changes": changes})
    if comparison.changes and not groups:
        changes = [_split(change_lines(change)) for change in comparison.changes]
        out.append({"title": "though no part was changed:", "part": -1, "changes": changes})
    return out


def _split(lines: list[str]) -> tuple[str, str]:
    return lines[0], lines[1].strip() if len(lines) > 1 else ""


def _drawn(comparison: Comparison, before: Design, after: Design) -> tuple[dict[str, Any], str, Counter[str]]:
    """The scene as the viewer takes it, its numbers, and how many parts are of each kind: each part a body of its
    own, those that are another or gone twice or once, with the revision in which they are."""
    causes: dict[str, list[Cause]] = {}
    for cause in comparison.causes:
        causes.setdefault(cause.part, []).append(cause)
    old = {str(part.name): part for part in before.assembly.parts}
    entries: list[tuple[str, Part, str, str, Cause | None]] = []
    for part in after.assembly.parts:
        of = {cause.kind: cause for cause in causes.get(str(part.name), ())}
        if "part-new" in of:
            entries.append((str(part.name), part, "new", "after", None))
        elif "part-shape" in of:
            entries.append((str(part.name), part, "other shape, after", "after", None))
            if str(part.name) in old:
                entries.append((f"{part.name} (before)", old[str(part.name)], "other shape, before", "before", None))
        elif "part-moved" in of:
            entries.append((str(part.name), part, "moved", "", of["part-moved"]))
        else:
            entries.append((str(part.name), part, "other material" if "part-material" in of else "as it was", "", None))
    entries += [(name, old[name], "gone", "before", None) for name, of in causes.items() if of[0].kind == "part-gone"]
    blob = Blob()
    shapes = {p.mesh.digest: p.mesh for _, p, _, _, _ in entries if p.mesh is not None}
    place = {digest: k for k, digest in enumerate(shapes)}
    lows, highs = np.array([Scene(side).box for side in (before, after)]).swapaxes(0, 1)
    drawn = {
        "name": after.assembly.name,
        "low": lows.min(axis=0),
        "high": highs.max(axis=0),
        "unit": after.assembly.units,
        "metres": metres_per(after.assembly.units),
        "meshes": [packed_mesh(blob, shape_of(mesh, None)) for mesh in shapes.values()],
        "bodies": [
            {"name": name, "ground": False, "colour": REVISION_COLOURS[kind]} for name, _, kind, _, _ in entries
        ],
        "parts": [
            {
                "name": name,
                "body": k,
                "mesh": -1 if part.mesh is None else place[part.mesh.digest],
                "pose": part.X_WP.T.ravel(),
                "when": when,
            }
            for k, (name, part, _, when, _) in enumerate(entries)
        ],
        "joints": [],
        "patches": {"items": [], "rows": 0, "offset": 0, "low": [0.0] * 7, "size": [1.0] * 7},
        "fits": FIT_COLOURS,
        "overlapColour": OVERLAP_COLOUR,
        "overlaps": [],
        "findings": [],
        "look": {
            "turn": EYE_TURN,
            "rise": EYE_RISE,
            "margin": FINDING_MARGIN,
            "zoom": FINDING_ZOOM,
            "shift": FINDING_SHIFT,
        },
        "motions": [_motion(blob, [(k, cause) for k, (*_, cause) in enumerate(entries) if cause is not None])],
    }
    return plain(drawn), blob.text(), Counter(kind for _, _, kind, _, _ in entries)


def _motion(blob: Blob, moved: list[tuple[int, Cause]]) -> dict[str, Any]:
    """From before to after: parts that moved go their way, the others change in the middle."""
    # Poses from before to after: enough for a turn of half a circle to look round.
    shares = np.linspace(0.0, 1.0, 17)
    poses = np.array(
        [[inverse(displacement((1.0 - s) * twist_of(cause.X))) for _, cause in moved if cause.X is not None]
         for s in shares]
    ).reshape(len(shares), -1, 4, 4)  # fmt: skip
    turns = quaternions(poses[..., :3, :3].reshape(-1, 3, 3)).reshape(*poses.shape[:2], 4)
    return {
        "kind": "revision",
        "name": "from before to after",
        "note": "",
        "marks": [],
        "time": shares,
        "ends": [0.0, 1.0],
        "unit": "",
        "moved": "before to after",
        "bodies": [k for k, _ in moved],
        **packed_frames(blob, poses[..., :3, 3], turns),
    }
