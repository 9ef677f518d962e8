"""The tests of a module are found by its name: `tests/` mirrors `kinform`, and `tests/cli` the command.

`tests/PACKAGE/test_NAME.py` tests the module NAME of the package or of a sub-package, or the package where NAME is its
own; a second file about one module or package is `test_NAME_WHAT.py`. Whole runs are in `tests/system`.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.places import ROOT

TESTS = ROOT / "tests"
KINFORM, COMMAND = ROOT / "pipeline" / "kinform", ROOT / "cli" / "kinform_cli"
WITHOUT_PACKAGE = ("docs", "hostile", "structure", "support", "system")
"""Folders of tests that mirror nothing."""


def mirrored(folder: Path) -> Path:
    """The package whose tests are in a folder."""
    inside = folder.relative_to(TESTS)
    return COMMAND.joinpath(*inside.parts[1:]) if inside.parts[:1] == ("cli",) else KINFORM / inside


def offenders(folder: Path) -> list[str]:
    """Test files in a folder, in any depth, that are named after nothing in the package they mirror."""
    out = []
    for path in sorted(folder.rglob("test_*.py")):
        package = mirrored(path.parent)
        modules = {module.stem for module in package.rglob("*.py")} | {path.parent.name}
        modules |= {inner.parent.name for inner in package.rglob("__init__.py")}
        name = path.stem.removeprefix("test_")
        if not any(name == module or name.startswith(f"{module}_") for module in modules if module != "__init__"):
            out.append(path.relative_to(TESTS).as_posix())
    return out


FOLDERS = sorted(path.name for path in TESTS.iterdir() if path.is_dir() and any(path.rglob("test_*.py")))


@pytest.mark.parametrize("folder", [name for name in FOLDERS if name not in WITHOUT_PACKAGE])
def test_the_tests_of_a_package_are_named_after_its_modules(folder: str):
    assert mirrored(TESTS / folder).is_dir(), f"{folder} mirrors no package"
    assert offenders(TESTS / folder) == []


def test_tests_at_the_top_are_named_after_modules_at_the_top():
    modules = {path.stem for path in KINFORM.glob("*.py")}
    names = [path.stem.removeprefix("test_") for path in TESTS.glob("test_*.py")]
    assert [n for n in names if not any(n == module or n.startswith(f"{module}_") for module in modules)] == []
