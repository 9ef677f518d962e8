"""How many random faults the tests find: `python benchmarks/mutants.py [COUNT] [--seed 0] [--package NAME ...]`.

A mutant is one line of `pipeline/kinform` with one fault: a comparison swapped, + for − or the other way round, × for
÷ or the other way round, a number doubled, a condition negated, or None returned. Lines are drawn at random over all
packages, each package as often as it has lines that can be changed; `--package` draws from these alone. Each mutant is
made in a copy of the tree, and the tests of its package run (`tests/PACKAGE`; for a module at the top
`tests/test_NAME*`; where there are none, `tests/system`) without those marked slow or sweep, until the first fails, at
most `--limit` seconds (600). Tests that do not end in time have found it.

Prints a line a mutant, and found and survived by package. What survives is a line that no test of its package knows,
or a mutant that changes nothing. `--jobs` runs so many at once.
"""

from __future__ import annotations

import argparse
import ast
import collections
import copy
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = Path("pipeline/kinform")
COPIED = (
    "pipeline", "cli", "tests", "fixtures", "examples", "docs", "fuzz", "benchmarks", "validators", "pyproject.toml",
    "README.md", "Makefile", ".pre-commit-hooks.yaml", "requirements-dev.lock",
)  # fmt: skip
"""What tests read."""
SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult,
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One faulty line."""

    file: Path
    line: int
    before: str
    after: str

    @property
    def package(self) -> str:
        """The package, or the module at the top, that it is in."""
        return self.file.relative_to(SOURCE).parts[0].removesuffix(".py")


def mutants_of(file: Path) -> Iterator[Mutant]:
    """All mutants of a file below the root."""
    text = (ROOT / file).read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        for place, changed in _changes(node):
            line = lines[place.lineno - 1]
            if place.lineno != place.end_lineno or not line.isascii():  # columns count bytes
                continue
            new = line[: place.col_offset] + ast.unparse(changed) + line[place.end_col_offset :]
            if new != line:
                yield Mutant(file, place.lineno, line, new)


def _changes(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt, ast.AST]]:
    """The faults that one node can have: what is replaced, and by what."""
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in SWAPPED:
        yield node, _with(node, ops=[SWAPPED[type(node.ops[0])]()])
    elif isinstance(node, ast.BinOp) and type(node.op) in SWAPPED and not isinstance(node.left, ast.JoinedStr):
        yield node, _with(node, op=SWAPPED[type(node.op)]())
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        yield node, ast.Constant(2 * node.value if node.value else 1)
    elif isinstance(node, ast.If | ast.IfExp | ast.While) and isinstance(
        node.test, ast.Name | ast.Call | ast.Attribute
    ):
        yield node.test, ast.UnaryOp(ast.Not(), node.test)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node, node.operand
    elif isinstance(node, ast.BoolOp):
        yield node, ast.UnaryOp(ast.Not(), node)
    elif isinstance(node, ast.Return) and node.value is not None and not isinstance(node.value, ast.Constant):
        yield node, ast.Return(ast.Constant(None))


def _with(node: ast.AST, **fields: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in fields.items():
        setattr(changed, name, value)
    return changed


def drawn(count: int, seed: int, packages: Sequence[str]) -> list[Mutant]:
    """So many mutants; the same for the same source, seed and packages."""
    files = sorted(path.relative_to(ROOT) for path in (ROOT / SOURCE).rglob("*.py"))
    every = [mutant for file in files for mutant in mutants_of(file) if not packages or mutant.package in packages]
    return random.Random(seed).sample(every, min(count, len(every)))


def tests_of(package: str, root: Path) -> list[str]:
    """The tests of a package, relative to the root."""
    folder = root / "tests" / package
    found = [folder] if folder.is_dir() else sorted((root / "tests").glob(f"test_{package}*.py"))
    return [str(path.relative_to(root)) for path in found or [root / "tests" / "system"]]


def survives(mutant: Mutant, limit: float) -> bool:
    """Whether no test of its package fails."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        root = Path(folder)
        for name in COPIED:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
            elif (ROOT / name).exists():
                shutil.copy(ROOT / name, root / name)
        lines = (root / mutant.file).read_text(encoding="utf-8").splitlines()
        assert lines[mutant.line - 1] == mutant.before
        lines[mutant.line - 1] = mutant.after
        (root / mutant.file).write_text("\n".join(lines) + "\n", encoding="utf-8")
        paths = os.pathsep.join([str(root / "pipeline"), str(root / "cli")])
        environment = os.environ | {"PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": ""}
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            *tests_of(mutant.package, root),
        ]
        try:
            ran = subprocess.run(command, cwd=root, env=environment, timeout=limit, check=False, capture_output=True)
        except subprocess.TimeoutExpired:
            return False
        return ran.returncode == 0


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("count", nargs="?", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--package", action="append", default=[])
    parser.add_argument("--limit", type=float, default=600.0)
    parser.add_argument("--jobs", type=int, default=1)
    asked = parser.parse_args()
    tally: collections.Counter[tuple[str, str]] = collections.Counter()
    mutants = drawn(asked.count, asked.seed, asked.package)
    with ThreadPoolExecutor(asked.jobs) as pool:
        ends = pool.map(lambda mutant: survives(mutant, asked.limit), mutants)
        for mutant, end in zip(mutants, ends, strict=True):
            word = "SURVIVED" if end else "found"
            tally[mutant.package, word] += 1
            change = f"{mutant.before.strip()}  →  {mutant.after.strip()}"
            print(f"{word:<9} {mutant.file}:{mutant.line}: {change}", flush=True)
    print(f"\n{'package':<14}{'found':>8}{'survived':>10}")
    for package in sorted({package for package, _ in tally}):
        print(f"{package:<14}{tally[package, 'found']:>8}{tally[package, 'SURVIVED']:>10}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
