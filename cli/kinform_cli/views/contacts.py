"""Contacts: patches between surfaces, and overlaps between solids."""

from __future__ import annotations

from typing import Any

from rich.console import Group, RenderableType

from kinform.model.contacts import Contacts
from kinform.model.design import Design
from kinform_cli.text import Lengths, count, number, table

__all__ = ["data", "render"]


def _known(design: Design) -> Contacts:
    assert design.contacts is not None
    return design.contacts


def data(design: Design) -> dict[str, Any]:
    """Patches and interferences, SI; `index` is how joints and queries refer to a patch."""
    contacts = _known(design)
    return {
        "schema": "kinform/contacts/1",
        "assembly": design.assembly.name,
        "units": design.assembly.units,
        "patches": [
            {
                "index": index,
                "parts": patch.parts,
                "surfaces": patch.surfaces,
                "kind": patch.kind,
                "one_sided": patch.one_sided,
                "area": patch.area,
                "gap": patch.gap,
                "fit": patch.fit,
                "axis": patch.axis,
                "point": patch.point,
                "radii": patch.radii,
                "misalignment": patch.misalignment,
                "offset": patch.offset,
                "chord": patch.chord,
            }
            for index, patch in enumerate(contacts.patches)
        ],
        "interferences": [
            {
                "parts": overlap.parts,
                "volume": overlap.volume,
                "depth": overlap.depth,
                "place": overlap.place,
                "mated": overlap.mated,
                "method": overlap.method,
            }
            for overlap in contacts.interferences
        ],
        "pairs": [{"parts": pair, "tolerance": contacts.tolerance.get(pair)} for pair in contacts.candidates],
    }


def render(design: Design) -> RenderableType:
    """One row a patch, then one row an overlap."""
    contacts, lengths = _known(design), Lengths.of(design.assembly)
    unit = lengths.unit
    pairs = len({patch.parts for patch in contacts.patches})
    many = count(len(contacts.patches), "contact patch", "contact patches")
    title = f"{many} between {count(pairs, 'pair')} of parts"
    numeric = (f"area {unit}²", f"gap {unit}", "#")
    rows = table("#", "part", "part", "surface", numeric[0], numeric[1], "fit", title=title, right=numeric)
    for index, patch in enumerate(contacts.patches):
        kind = f"{patch.kind}, one side" if patch.one_sided else patch.kind
        rows.add_row(str(index), *patch.parts, kind, lengths.area(patch.area), lengths.length(patch.gap), patch.fit)
    items: list[RenderableType] = [rows]
    if contacts.interferences:
        sizes = (f"volume {unit}³", f"depth {unit}")
        overlaps = table("part", "part", *sizes, f"at {unit}", "kind", title="\nOverlapping solids", right=sizes)
        for overlap in contacts.interferences:
            overlaps.add_row(
                *overlap.parts,
                number(overlap.volume / lengths.metres**3),
                lengths.length(overlap.depth),
                lengths.point(overlap.place),
                "press fit" if overlap.mated else "collision",
            )
        items.append(overlaps)
    return Group(*items)
