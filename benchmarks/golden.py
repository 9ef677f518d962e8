"""Compare the answers of two versions of kinform on every design at hand.

    python benchmarks/golden.py BEFORE AFTER [--designs FOLDER ...] [--robots FOLDER --score score.py] [--only TEXT]

BEFORE and AFTER are checkouts of the source, or folders that an earlier comparison saved (`--save FOLDER` keeps both
sides as FOLDER/before and FOLDER/after). Designs are the fixtures and examples of AFTER, every manifest, description
and CAD file below `--designs`, and the robots that `../shared/robots/make_robots.py` builds, with the manifests of its
`score.py`. Each is run by `kinform run` in a process of its own, exported to every format and reported as a page.

Compared are exit codes; all datasets and attributes of the results, numbers within `--tolerance` (relative to the
largest of the dataset, absolute below 1e-12); findings by code, severity, subject and the numbers in them; exports and
the page token by token, numbers within the tolerance. Texts of messages, versions of code and fingerprints are not
compared. What flipped is printed, one line each; the exit code is 1 where anything did.
"""

from __future__ import annotations

import argparse
import ast
import base64
import importlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

SOURCES = (".toml", ".urdf", ".xacro", ".sdf", ".xml", ".step", ".stp", ".glb", ".3mf", ".dae", ".obj", ".stl")
EXPORTS = ("mjcf", "urdf", "sdf", "modelica", "vhdl-ams", "dot", "json", "csv")
SKIPPED = {
    "fingerprint",
    "fingerprints",
    "lineage",
    "inputs",
    "key",
    "code_version",
    "version",
    "seal",
    "digest",
    "decisions",
}
"""Attributes and datasets that name the version of the code and not what it found; `decisions` is a cache that is
sorted by such names."""
PROSE = {"message", "remedy", "reason", "why", "note", "words", "statement", "found", "intended", "text", "description"}
"""Columns of tables, and keys of JSON, that are read by people: only the numbers in them are compared."""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
TOKEN = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[A-Za-z_][\w.~/#-]*|[^\s\w]")
TIMEOUT = 600.0


@dataclass(frozen=True)
class Design:
    """What to run, where, and under which name its results are kept."""

    name: str
    source: Path
    arguments: tuple[str, ...] = ()


def designs_of(tree: Path, folders: list[Path], robots: Path | None, score: Path | None) -> Iterator[Design]:
    """Every design that is to be run; the robots' manifests are written beside their meshes."""
    for folder in (tree / "fixtures", tree / "examples", *folders):
        label = folder.name
        for path in sorted(folder.rglob("*")):
            if path.suffix.lower() not in SOURCES or "meshes" in path.parts:
                continue
            if path.name.startswith("golden_"):
                continue
            loose = path.suffix.lower() in (".stl", ".obj")
            beside = [
                p
                for p in path.parent.iterdir()
                if p.suffix.lower() in SOURCES and p.suffix.lower() not in (".stl", ".obj")
            ]
            if loose and (beside or path.parent.name in ("meshes", "parts")):
                continue
            if loose and not re.search(r"single_file|strangers|crash", str(path)):
                continue
            name = f"{label}/{path.relative_to(folder)}".replace("/", "__")
            yield Design(name, path, ("--units", "mm") if loose else ())
    if robots is not None and score is not None:
        tree_of_score = ast.parse(score.read_text())
        kept = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.Assign)
        tree_of_score.body = [node for node in tree_of_score.body if isinstance(node, kept)]
        module: dict[str, Any] = {"__file__": str(score)}
        exec(compile(tree_of_score, str(score), "exec"), module)  # its functions, without the command at its end
        for truth in sorted(robots.glob("*/truth.json")):
            said = json.loads(truth.read_text())
            for track in ("function", "groups"):
                target = truth.parent / f"golden_{track}.toml"
                try:
                    made = module["manifest"](truth.parent, said, track)
                except TypeError:  # a joint of a link without geometry
                    continue
                target.write_text(made if isinstance(made, str) else made[0])
                yield Design(f"robots__{truth.parent.name}__{track}", target)


def run_design(design: Design, out: Path) -> None:
    """Run, export and report one design with the kinform that can be imported; everything lands in `out`."""
    from kinform_cli.main import main as kinform

    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    os.chdir(design.source.parent)
    results, codes = out / "results.h5", {}
    log = os.open(out / "printed.txt", os.O_CREAT | os.O_WRONLY)
    os.dup2(log, 1), os.dup2(log, 2)

    def ran(name: str, *words: object) -> None:
        codes[name] = kinform([str(word) for word in words])
        (out / "codes.json").write_text(json.dumps(codes))

    found = f"--format=json={out / 'findings.json'}"
    ran("run", "run", "--quiet", "--jobs", 1, found, design.source, *design.arguments, "-o", results)
    if results.exists():
        for what in ("joints", "mobility"):
            ran(what, "show", results, what, "--format", "json")
        for target in EXPORTS:
            ran(target, "export", "--quiet", results, "--to", target, "-o", out / target)
        ran("report", "report", "--quiet", results, "-o", out / "page.html")


def run_designs(designs: list[Design], out: Path, jobs: int) -> None:
    """Run all designs, each in a fork of this process that is ended after `TIMEOUT` seconds."""
    import kinform_cli.main  # noqa: F401  before the forks, so that it is imported once

    for module in ("kinform.stages", "kinform.method", "kinform.exports.registry", "kinform.reports.page.html"):
        importlib.import_module(module)
    running: dict[int, tuple[str, float]] = {}
    left, done = list(reversed(designs)), 0
    while left or running:
        while left and len(running) < jobs:
            design = left.pop()
            pid = os.fork()
            if not pid:
                try:
                    run_design(design, out / design.name)
                finally:
                    os._exit(0)
            running[pid] = design.name, time.monotonic()
        pid, _ = os.waitpid(-1, os.WNOHANG)
        if pid:
            done += 1
            del running[pid]
            print(f"\r{out.name}: {done} of {len(designs)} ", end="", file=sys.stderr, flush=True)
            continue
        for one, (name, began) in running.items():
            if time.monotonic() - began > TIMEOUT:
                print(f"\n{name}: ended after {TIMEOUT:g} s", file=sys.stderr)
                os.kill(one, 9)
        time.sleep(0.02)
    print(file=sys.stderr)


def save(tree: Path, designs: list[Design], out: Path, jobs: int, python: str) -> Path:
    """Run all designs with a tree, in a process that imports kinform from there."""
    environment = {
        **os.environ, "PYTHONPATH": f"{tree / 'pipeline'}:{tree / 'cli'}", "OPENBLAS_NUM_THREADS": "1",
        "COLUMNS": "200", "GOLDEN_OUT": str(out), "GOLDEN_JOBS": str(jobs),
    }  # fmt: skip
    work = json.dumps([[d.name, str(d.source), list(d.arguments)] for d in designs])
    subprocess.run([python, __file__, "--worker"], input=work, text=True, env=environment, check=True)
    return out


def near(a: np.ndarray, b: np.ndarray, tolerance: float) -> float:
    """The largest difference as a share of the largest number; 0 where all is within rounding."""
    both = np.isnan(a) & np.isnan(b)
    same = (a == b) | both
    if same.all():
        return 0.0
    finite = np.isfinite(a) & np.isfinite(b)
    if not (finite | same).all():
        return float("inf")
    size = max(float(np.abs(a[finite]).max(initial=0.0)), float(np.abs(b[finite]).max(initial=0.0)), 1e-6)
    return float(np.abs(a[finite] - b[finite]).max(initial=0.0)) / size


def arrays_differ(name: str, a: np.ndarray, b: np.ndarray, tolerance: float) -> Iterator[str]:
    """How two datasets differ."""
    if a.shape != b.shape or a.dtype.names != b.dtype.names:
        yield f"{name}: shape {a.shape} → {b.shape}" if a.shape != b.shape else f"{name}: columns differ"
        return
    if a.dtype.names:
        for column in (name for name in a.dtype.names if name not in SKIPPED):
            yield from arrays_differ(f"{name}.{column}", a[column], b[column], tolerance)
        return
    if a.dtype.kind in "fc":
        apart = near(a.astype(float), b.astype(float), tolerance)
        if apart > tolerance:
            yield f"{name}: differs by {apart:.1e} of its largest"
    elif a.dtype.kind in "iub":
        if not np.array_equal(a, b):
            n = int(np.count_nonzero(a != b))
            where = tuple(int(x[0]) for x in np.nonzero(np.atleast_1d(a != b)))
            yield f"{name}: {n} of {a.size} differ, first {np.atleast_1d(a)[where]} → {np.atleast_1d(b)[where]}"
    else:
        words = name.rsplit(".", 1)[-1].rsplit("/", 1)[-1]
        for x, y in zip(a.ravel().tolist(), b.ravel().tolist(), strict=True):
            left, right = (v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v) for v in (x, y))
            if left == right:
                continue
            if words in PROSE:
                yield from numbers_differ(name, left, right, tolerance)
            elif any(ch.isspace() for ch in left) and numbers_same(left, right, tolerance):
                continue
            else:
                yield f"{name}: {left[:60]!r} → {right[:60]!r}"
                return


def numbers_same(a: str, b: str, tolerance: float) -> bool:
    """Whether two texts hold the same numbers."""
    first, second = ([float(x) for x in NUMBER.findall(text)] for text in (a, b))
    return len(first) == len(second) and near(np.array(first), np.array(second), tolerance) <= max(tolerance, 1e-3)


def numbers_differ(name: str, a: str, b: str, tolerance: float) -> Iterator[str]:
    """How the numbers in two texts differ."""
    if not numbers_same(a, b, tolerance):
        yield f"{name}: numbers of {a[:80]!r} → {b[:80]!r}"


def results_differ(a: Path, b: Path, tolerance: float) -> Iterator[str]:
    """How two results files differ."""
    import h5py

    def content(path: Path) -> dict[str, object]:
        out: dict[str, object] = {}

        def visit(name: str, item: object) -> None:
            if isinstance(item, h5py.Dataset) and name.rsplit("/", 1)[-1] not in SKIPPED:
                out[name] = item[()]
            for key, value in item.attrs.items():  # type: ignore[attr-defined]
                if key not in SKIPPED:
                    out[f"{name}@{key}"] = value

        with h5py.File(path) as file:
            file.visititems(visit)
        return out

    before, after = content(a), content(b)
    for name in sorted(before.keys() - after.keys()):
        yield f"{name}: gone"
    for name in sorted(after.keys() - before.keys()):
        yield f"{name}: new"
    for name in sorted(before.keys() & after.keys()):
        yield from arrays_differ(name, np.asarray(before[name]), np.asarray(after[name]), tolerance)


def findings_differ(a: Path, b: Path, tolerance: float) -> Iterator[str]:
    """How the findings of two runs differ: by code, severity, subject and numbers."""

    def read(path: Path) -> dict[tuple[str, ...], list[str]]:
        said = json.loads(path.read_text())
        out: dict[tuple[str, ...], list[str]] = {}
        for finding in said.get("findings", []):
            subjects = finding.get("subjects") or finding.get("subject") or ""
            key = (finding.get("code", ""), finding.get("severity", ""), json.dumps(subjects, sort_keys=True))
            out.setdefault(key, []).append(" ".join(str(finding.get(k, "")) for k in ("found", "intended")))
        for rule in said.get("rules", []):
            out["rule", rule["code"], rule["outcome"]] = [""]
        out["verdict", str(said.get("verdict")), json.dumps(said.get("counts"))] = [""]
        return out

    before, after = read(a), read(b)
    for key in sorted(before.keys() | after.keys()):
        first, second = sorted(before.get(key, [])), sorted(after.get(key, []))
        if len(first) != len(second):
            yield f"finding {' '.join(key)}: {len(first)} → {len(second)}"
            continue
        for x, y in zip(first, second, strict=True):
            yield from numbers_differ(f"finding {' '.join(key)}", x, y, tolerance)


def texts_differ(name: str, a: str, b: str, tolerance: float) -> Iterator[str]:
    """How two exports differ, comments left out, token by token."""
    plain = [re.sub(r"<!--.*?-->|//[^\n]*|--[^\n]*", "", text, flags=re.DOTALL) for text in (a, b)]
    plain = (
        [re.sub(r'"(?:[^"\\]|\\.)*\s(?:[^"\\]|\\.)*"', '"prose"', text) for text in plain]
        if name.endswith((".mo", ".json"))
        else plain
    )
    first, second = (TOKEN.findall(text) for text in plain)
    if len(first) != len(second):
        yield f"{name}: {len(first)} tokens → {len(second)}"
        return
    apart = 0
    for x, y in zip(first, second, strict=True):
        if x == y:
            continue
        if NUMBER.fullmatch(x) and NUMBER.fullmatch(y):
            p, q = float(x), float(y)
            if abs(p - q) <= tolerance * max(abs(p), abs(q), 1e-3):
                continue
        apart += 1
        example = f"{x} → {y}"
    if apart:
        yield f"{name}: {apart} tokens differ, last {example}"


def pages_differ(a: Path, b: Path, tolerance: float) -> Iterator[str]:
    """How what two pages draw differs: the numbers packed in them."""

    def packed(path: Path) -> np.ndarray:
        blobs = re.findall(r"[\"'>]([A-Za-z0-9+/]{400,}={0,2})[\"'<]", path.read_text())
        data = b""
        for blob in blobs:
            try:
                data += zlib.decompress(base64.b64decode(blob))
            except (zlib.error, ValueError):
                continue
        return np.frombuffer(data[: len(data) // 4 * 4], "<f4")

    x, y = packed(a), packed(b)
    if len(x) != len(y):
        yield f"page: {len(x)} words of geometry and motion → {len(y)}"
        return
    other = x.view("<u4") != y.view("<u4")
    if other.any():
        with np.errstate(all="ignore"):
            close = np.abs(x[other].astype(float) - y[other].astype(float)) <= max(tolerance, 1e-4) * np.maximum(
                np.abs(x[other]), 1e-3
            )
        if not close.all():
            yield f"page: {int(np.count_nonzero(~close))} of {len(x)} words of geometry and motion differ"


def compare(before: Path, after: Path, name: str, tolerance: float) -> Iterator[str]:
    """How the answers to one design differ."""
    a, b = before / name, after / name
    if not a.exists() or not b.exists():
        yield f"run on one side only: {'after' if b.exists() else 'before'}"
        return
    codes = [json.loads((side / "codes.json").read_text()) for side in (a, b)]
    if codes[0] != codes[1]:
        changed = {k for k in codes[0].keys() | codes[1].keys() if codes[0].get(k) != codes[1].get(k)}
        yield "exit codes: " + ", ".join(f"{k} {codes[0].get(k)} → {codes[1].get(k)}" for k in sorted(changed))
    for file, differ in (
        ("findings.json", findings_differ),
        ("results.h5", results_differ),
        ("page.html", pages_differ),
    ):
        if (a / file).exists() and (b / file).exists():
            yield from differ(a / file, b / file, tolerance)
    for target in EXPORTS:
        files = {p.relative_to(side) for side in (a, b) for p in (side / target).rglob("*") if p.is_file()}
        for file in sorted(files):
            x, y = a / file, b / file
            if not x.exists() or not y.exists():
                yield f"{file}: {'new' if y.exists() else 'gone'}"
            elif file.suffix in (".stl", ".glb", ".png"):
                if x.read_bytes() != y.read_bytes():
                    yield f"{file}: bytes differ"
            else:
                yield from texts_differ(
                    str(file), x.read_text(errors="replace"), y.read_text(errors="replace"), tolerance
                )


def main() -> int:
    """Save what has to be run, and print what flipped."""
    if sys.argv[1:] == ["--worker"]:
        todo = [Design(name, Path(source), tuple(words)) for name, source, words in json.load(sys.stdin)]
        run_designs(todo, Path(os.environ["GOLDEN_OUT"]), int(os.environ["GOLDEN_JOBS"]))
        return 0
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--designs", type=Path, action="append", default=[], help="a folder with more designs")
    parser.add_argument("--robots", type=Path, help="the folder that make_robots.py has filled")
    parser.add_argument("--score", type=Path, help="score.py, whose manifests the robots are run with")
    parser.add_argument("--only", default="", help="a regular expression that names of designs have to match")
    parser.add_argument("--save", type=Path, help="keep what both sides wrote")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--show", type=int, default=8, help="lines a design")
    options = parser.parse_args()
    keep = options.save or Path(tempfile.mkdtemp(prefix="golden-"))
    sides = []
    tree = next((side for side in (options.after, options.before) if (side / "pipeline").is_dir()), None)
    designs = (
        []
        if tree is None
        else list(
            designs_of(
                tree.resolve(),
                [d.resolve() for d in options.designs],
                options.robots and options.robots.resolve(),
                options.score,
            )
        )
    )
    designs = [d for d in designs if re.search(options.only, d.name)]
    for label, side in (("before", options.before), ("after", options.after)):
        saved = not (side / "pipeline").is_dir()
        sides.append(
            side if saved else save(side.resolve(), designs, (keep / label).resolve(), options.jobs, options.python)
        )
    names = sorted(
        {p.parent.name for side in sides for p in side.glob("*/codes.json") if re.search(options.only, p.parent.name)}
    )
    if designs:
        names = [name for name in names if name in {d.name for d in designs}]
    flipped: Counter[str] = Counter()
    for name in names:
        lines = list(compare(sides[0], sides[1], name, options.tolerance))
        if lines:
            flipped[name] = len(lines)
            print(
                name,
                *lines[: options.show],
                *([f"… {len(lines) - options.show} more"] if len(lines) > options.show else []),
                sep="\n    ",
            )
    print(f"{len(names)} designs compared, {len(flipped)} differ, {sum(flipped.values())} differences")
    return 1 if flipped else 0


if __name__ == "__main__":
    sys.exit(main())
