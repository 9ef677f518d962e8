"""Contacts: patches between surfaces, and overlaps between solids."""

from __future__ import annotations

from rich.console import RenderableType

from kinform.design import Design
from kinform.foundation.words import counted
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import Lengths


def render(design: Design) -> RenderableType:
    """One row a patch, then one row an overlap, then one row a suggestion."""
    contacts, lengths = design.contacts, Lengths.of(design.assembly)
    assert contacts is not None
    unit = lengths.small
    pairs = len({patch.parts for patch in contacts.patches})
    many = counted(len(contacts.patches), "contact patch", "contact patches")
    title = f"{many} between {counted(pairs, 'pair')} of parts"
    numeric = (f"area {unit}²", f"gap {unit}", "#")
    rows = Rows(
        "#",
        "part",
        "part",
        "surface",
        *numeric[:2],
        "fit",
        title=title,
        right=numeric,
        keys=3,
        shared=(1, 2),
        names=["part"],
    )
    for index, patch in enumerate(contacts.patches):
        kind = f"{patch.kind}, one side" if patch.one_sided else patch.kind
        rows.add(str(index), *patch.parts, kind, lengths.area(patch.area), lengths.length(patch.gap), patch.fit)
    items: list[RenderableType] = [rows]
    if contacts.interferences or contacts.possible_overlaps:
        sizes = (f"volume {unit}³", f"depth {unit}")
        title = "\nOverlapping solids"
        overlaps = Rows(
            "part", "part", *sizes, f"at {lengths.unit}", "kind", title=title, right=sizes, keys=2, names=["part"]
        )
        sure = [(overlap, "press fit" if overlap.mated else "collision") for overlap in contacts.interferences]
        for overlap, kind in [*sure, *((some, "not known: coarse facets") for some in contacts.possible_overlaps)]:
            volume, depth = lengths.volume(overlap.volume), lengths.length(overlap.depth)
            overlaps.add(*overlap.parts, volume, depth, lengths.point(overlap.place), kind)
        items.append(overlaps)
    if contacts.suggestions:
        applied = "not applied; [fasteners] infer = true does"
        if design.assembly.infer_fasteners:
            applied = "applied, except where contact decides, or groups or stated joints keep apart"
        title = f"\nSuggestions ({applied})"
        headings = ("part", "part", "suggests", "confidence", "evidence")
        hints = Rows(*headings, title=title, keys=2, names=["part"], texts=["evidence"])
        for hint in contacts.suggestions:
            hints.add(*hint.parts, "one body" if hint.fastens else "an axis", hint.confidence, hint.evidence)
        items.append(hints)
    return stacked(*items)
