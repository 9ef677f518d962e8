"""The structure of the code base, read from its imports: layers, circles, names, and what the docs say of it."""

from __future__ import annotations

import ast
import fnmatch
import functools
import gc
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = {"kinform": ROOT / "pipeline", "kinform_cli": ROOT / "cli"}
LAYERS = (
    ("version",), ("frozen",), ("errors",), ("model",), ("foundation",),
    ("form.tables", "form.constants"), ("requirements",),
    ("form", "formats", "formats.*.reading"), ("surfaces",), ("contacts",), ("mechanism",),
    ("kinematics",), ("mass",), ("function",), ("behaviour",), ("collisions",), ("simulation",), ("design",),
    ("statics",), ("replays",), ("consistency",), ("reuse",), ("results",), ("exports", "formats.*.writing"),
    ("reports",), ("changes",), ("catalog",), ("ahead",), ("stages",), ("api",), ("method",), ("batch",), ("study",),
    ("kinform",), ("kinform_cli",),
)  # fmt: skip
"""Packages from the lowest layer up: a module imports from its own layer and lower ones, never from a higher one."""


@functools.cache
def modules() -> dict[str, Path]:
    """Every module by its dotted name; a package has the name of its folder."""
    out = {}
    for package, source in SOURCES.items():
        for path in sorted((source / package).rglob("*.py")):
            parts = path.relative_to(source).with_suffix("").parts
            out[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return out


@functools.cache
def imports() -> dict[str, frozenset[str]]:
    """The modules that each module imports: at its head, inside functions, and for types only."""
    gc.disable()  # trees have no circles, and looking for some takes twice as long as parsing
    try:
        return {name: frozenset(facts(path).imported & modules().keys() - {name}) for name, path in modules().items()}
    finally:
        gc.enable()


@dataclass(frozen=True)
class Facts:
    """What the tests ask of a module, which is parsed once for all of them."""

    imported: set[str]
    docstring: str | None
    names: list[str]
    """Names that assignments at its top level give, as often as they do."""


@functools.cache
def facts(path: Path) -> Facts:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names: list[str] = []
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets += [node.target] if isinstance(node, ast.AnnAssign) else []
        names += [one.id for one in targets if isinstance(one, ast.Name)]
    return Facts(_imported(tree, path), ast.get_docstring(tree), names)


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """Statements in any depth: those of functions and classes too, and no expressions."""
    for inner in ast.iter_child_nodes(node):
        if isinstance(inner, (ast.stmt, ast.excepthandler, ast.match_case)):
            yield inner
            yield from _statements(inner)


def _imported(tree: ast.Module, path: Path) -> set[str]:
    out: set[str] = set()
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            out |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                out.add(whole if whole in modules() else str(node.module))
    return out


@functools.cache
def layer(module: str) -> int:
    """The number of the layer of a module: that of the longest name in `LAYERS` that matches it."""
    name = module.removeprefix("kinform.")
    found = [
        (len(pattern.split(".")), number)
        for number, patterns in enumerate(LAYERS)
        for pattern in patterns
        if fnmatch.fnmatchcase(".".join(name.split(".")[: len(pattern.split("."))]), pattern)
    ]
    assert found, f"{module} is in no layer"
    return max(found)[1]


def test_every_package_has_a_layer():
    tops = {name.removeprefix("kinform.").split(".")[0] for name in modules()}
    assert tops == {pattern.split(".")[0] for patterns in LAYERS for pattern in patterns}


def test_no_import_points_upwards():
    upwards = [
        f"{importer} → {target}"
        for importer, targets in sorted(imports().items())
        for target in sorted(targets)
        if layer(target) > layer(importer)
    ]
    assert upwards == []


@functools.cache
def packages() -> list[str]:
    return sorted(name for name, path in modules().items() if path.name == "__init__.py")


def sub_packages(package: str) -> list[str]:
    """The packages directly inside a package."""
    return [name for name in packages() if name.rpartition(".")[0] == package]


def listed(package: str) -> list[str]:
    """The sub-packages that the docstring of a package lists, in its order."""
    text = facts(modules()[package]).docstring or ""
    return [f"{package}.{name}" for name in re.findall(r"^- `([\w.]+)`:", text, flags=re.MULTILINE)]


WITH_PARTS = [name for name in packages() if name not in SOURCES and sub_packages(name)]


@pytest.mark.parametrize("package", WITH_PARTS)
def test_a_package_lists_its_sub_packages_in_the_order_in_which_they_import(package: str):
    order = listed(package)
    assert sorted(order) == sub_packages(package)
    place = {name: number for number, name in enumerate(order)}

    def part(module: str) -> str | None:
        return next((name for name in order if module == name or module.startswith(f"{name}.")), None)

    upwards = [
        f"{importer} → {target}"
        for importer, targets in sorted(imports().items())
        for target in sorted(targets)
        if (a := part(importer)) and (b := part(target)) and place[b] > place[a]
    ]
    assert upwards == []


def test_no_modules_import_each_other_in_a_circle():
    left = {name: set(targets) for name, targets in imports().items()}
    while leaves := [name for name, targets in left.items() if not targets]:
        for name in leaves:
            del left[name]
        for targets in left.values():
            targets.difference_update(leaves)
    assert sorted(left) == [], "these lie on circles of imports, or lead into one"


def test_no_module_hides_behind_an_underscore():
    dunder = {"__init__", "__main__"}
    assert [p for p in modules().values() if p.stem.startswith("_") and p.stem not in dunder] == []


def test_every_module_says_what_it_knows():
    assert [name for name, path in modules().items() if not facts(path).docstring] == []


def test_architecture_names_every_package():
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    tops = {name.split(".")[1] for name, path in modules().items() if path.stem == "__init__" and "." in name}
    named = set(re.findall(r"`(\w+)`", text))
    assert tops - named - {"commands", "views"} == set()
    assert len(text.splitlines()) <= 120


@pytest.mark.parametrize("page", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_pages_about_the_code_name_nothing_that_is_gone(page: str):
    text = (ROOT / page).read_text(encoding="utf-8")
    gone = []
    for path in re.findall(r"`([\w/]+/[\w/]*(?:\.py|/))`", text):
        if "NNN" in path:  # stands for any rule
            continue
        places = (ROOT, ROOT / "cli", SOURCES["kinform"] / "kinform")
        gone += [path] if not any((place / path).exists() for place in places) else []
    assert gone == []


def test_no_name_that_a_package_gives_on_first_use_is_that_of_a_module_in_it():
    """Once the module is imported it stands where the name was looked for."""
    for name, path in modules().items():
        if path.name == "__init__.py":
            calls = (node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if _first_used(node))
            given = {key.value for call in calls for key in call.args[1].keys}
            assert not {one for one in given if f"{name}.{one}" in modules()}, name


def _first_used(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "id", "") == "lazy_attributes"


def test_no_name_of_a_module_is_given_twice():
    """Of two constants of one name the second holds, where the first was meant too."""
    twice = []
    for module, path in modules().items():
        names = facts(path).names
        twice += [f"{module}.{name}" for name in sorted(set(names)) if names.count(name) > 1]
    assert twice == []
