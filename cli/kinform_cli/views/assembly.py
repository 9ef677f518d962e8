"""The assembly: its parts as a tree of sub-assemblies, groups, and what was assumed."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text
from rich.tree import Tree

from kinform.model.assembly import Assembly, Part
from kinform.model.design import Design
from kinform_cli.text import count, number

__all__ = ["render"]


def render(design: Design) -> RenderableType:
    """The tree, then groups and notes."""
    assembly = design.assembly
    items: list[RenderableType] = [_tree(assembly)]
    if assembly.groups:
        items.append(Text("\nGroups", style="bold"))
        items += [f"  {group.name}: {', '.join(group.parts)}" for group in assembly.groups]
    if assembly.assumptions:
        items.append(Text("\nAssumed", style="bold"))
        for assumption in assembly.assumptions:
            what = "do not touch" if assumption.ignore else str(assumption.type)
            items.append(f"  {' and '.join(assumption.between)}: {what} ({assumption.reason})")
    if assembly.notes:
        items.append(Text("\nNotes", style="bold"))
        items += [f"  {note}" for note in assembly.notes]
    return Group(*items)


def _tree(assembly: Assembly) -> Tree:
    files = {sub.name: sub.file for sub in assembly.subassemblies}
    tree = Tree(
        Text.assemble((assembly.name, "bold"), f"  {count(len(assembly.parts), 'part')}, lengths in {assembly.units}")
    )
    branches: dict[str, Tree] = {"": tree}
    for part in assembly.parts:
        folder, _, leaf = part.name.rpartition("/")
        _branch(branches, folder, files).add(Text.assemble(leaf, (f"  {_describe(part)}", "dim")))
    return tree


def _branch(branches: dict[str, Tree], name: str, files: dict[str, str]) -> Tree:
    if name not in branches:
        above, _, leaf = name.rpartition("/")
        file = f"  {files[name]}" if name in files else ""
        branches[name] = _branch(branches, above, files).add(Text.assemble((leaf, "bold"), (file, "dim")))
    return branches[name]


def _describe(part: Part) -> str:
    facts = []
    if part.mesh is None:
        facts.append("stick body")
    else:
        file = part.mesh.path if part.mesh.body is None else f"{part.mesh.path} ({part.mesh.body})"
        facts += [file, count(len(part.mesh.faces), "facet")]
        if not part.mesh.health.watertight:
            facts.append("not watertight")
        if not part.solid:
            facts.append("surfaces only")
    if part.override is not None:
        facts.append(f"{number(part.override.mass)} kg (stated)")
    elif part.material is not None:
        facts.append(part.material)
    elif part.density is not None:
        facts.append(f"{number(part.density)} kg/m³")
    return ", ".join(facts)
