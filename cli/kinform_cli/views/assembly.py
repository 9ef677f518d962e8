"""The assembly: its parts as a tree of sub-assemblies, groups, and what was assumed."""

from __future__ import annotations

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from kinform.design import Design
from kinform.foundation.escapes import one_line
from kinform.foundation.words import counted
from kinform.model.assembly import Assembly, Part, Subassembly
from kinform_cli.shortened import beginning
from kinform_cli.tables import stacked
from kinform_cli.text import number


def render(design: Design, *, short: bool = False) -> RenderableType:
    """The tree, then groups and notes; with `short` no more parts than can be shown of it."""
    assembly = design.assembly
    items: list[RenderableType] = [_tree(assembly, short)]
    if assembly.groups:
        items.append(Text("\nGroups", style="bold"))
        items.append(_groups(assembly))
    if assembly.assumptions:
        items.append(Text("\nAssumed", style="bold"))
        for assumption in assembly.assumptions:
            what = "do not touch" if assumption.ignore else str(assumption.type)
            items.append(f"  {' and '.join(assumption.between)}: {what} ({assumption.reason})")
    if assembly.notes:
        items.append(Text("\nNotes", style="bold"))
        items += [f"  {note}" for note in assembly.notes]
    return stacked(*items)


def _tree(assembly: Assembly, short: bool) -> Tree:
    files = {sub.name: _describe_sub(sub) for sub in assembly.subassemblies}
    tree = Tree(
        Text.assemble(
            (one_line(assembly.name), "bold"), f"  {counted(len(assembly.parts), 'part')}, lengths in {assembly.units}"
        )
    )
    branches: dict[str, Tree] = {"": tree}
    group_of = {part: group.name for group in assembly.groups for part in group.parts}
    for part in beginning(assembly.parts, short):
        folder, _, leaf = part.name.rpartition("/")
        facts = _describe(part)
        if part.name in group_of:
            facts += f"; in {group_of[part.name]}"
        if assembly.ground is not None and assembly.ground in (part.name, group_of.get(part.name)):
            facts += " (ground)"
        _branch(branches, folder, files).add(_Leaf(leaf, part.mesh.path if part.mesh is not None else "", facts))
    return tree


class _Leaf:
    """A part on one line: the folders of its file give way first, then the line is wrapped."""

    def __init__(self, name: str, file: str, facts: str):
        self._name, self._file, self._facts = one_line(name), one_line(file), one_line(facts)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The line, or its pieces."""
        room = options.max_width - len(self._name) - len(self._facts) - 4
        file = self._file if len(self._file) <= room else f"…/{self._file.rpartition('/')[2]}"
        file = file if "/" in self._file else self._file
        known = [text for text in (file, self._facts) if text]
        yield from stacked(Text.assemble(self._name, (f"  {', '.join(known)}", "dim"))).renderables


def _groups(assembly: Assembly) -> Table:
    """Names, and beside them the parts: what does not fit in a line goes on below, not under the names."""
    grid = Table.grid(padding=(0, 2))
    for group in assembly.groups:
        grid.add_row(*map(one_line, (f"  {group.name}", ", ".join(group.parts))))
    return grid


def _branch(branches: dict[str, Tree], name: str, files: dict[str, str]) -> Tree:
    if name not in branches:
        above, _, leaf = name.rpartition("/")
        file = f"  {files[name]}" if name in files else ""
        branches[name] = _branch(branches, above, files).add(
            Text.assemble((one_line(leaf), "bold"), (one_line(file), "dim"))
        )
    return branches[name]


def _describe_sub(sub: Subassembly) -> str:
    return sub.file if sub.mobility is None else f"{sub.file}, {counted(sub.mobility, 'freedom')} stated"


def _describe(part: Part) -> str:
    facts = []
    if part.mesh is None:
        facts.append("stick body")
    else:
        if part.mesh.body is not None:
            facts.append(f"body {part.mesh.body}")
        facts += [counted(len(part.mesh.faces), "facet")]
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
