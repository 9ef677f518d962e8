"""Import, surfaces and contacts beside their floors, in one run: `python benchmarks/geometry.py [--quick] [ROBOTS]`.

ROBOTS, or KINFORM_ROBOTS, is a folder of robots (so100, so101, dog, sigmaban2019) as `../shared/robots/make_robots.py`
makes it and `score.py` leaves it: without it, those two of `../shared/data`; one that is not there is left out, and
said so. Each robot and each size is measured in a process of its own:

- import: kinform reads, welds and checks the meshes, against `trimesh.load(process=True)` of the same files;
- surfaces: seconds of the processor for 100,000 facets, of each distinct shape once;
- contacts after surfaces, against bare FCL trees of all distinct meshes;
- contacts of many small parts: pins in the bores of one plate, and bars bolted to each other, all as files of their
  own;
- contacts of two blocks that meet in a wavy face, from four sizes, with the exponent of the growth; `--large` adds the
  size of 5.4 million facets, and its memory;
- the same of a ball in its socket and of a shaft in its bore, with the same facets, and turned against each other.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[:0] = [str(HERE), str(ROOT / "pipeline")]

from change import chain  # noqa: E402
from scale import bvh, plate_with_pins  # noqa: E402
from table import Row, show  # noqa: E402

ROBOTS = ("so100", "so101", "dog", "sigmaban2019")
SURFACES, IMPORT, PAIR, EXPONENT, LARGE_MB = 1.0, 1.2, 4.0, 1.1, 4000.0
"""Aims: s per 100,000 facets, ratio, ms, power, MB."""
CONTACTS = {"so100": 3.0, "dog": 1.0, "sigmaban2019": 1.0}
"""Aims of contacts, in bare FCL trees."""
WAVY = (60_000, 180_000, 540_000, 1_620_000)
"""Facets of the two blocks together."""
SEGMENTS = (128, 224, 400, 700)
"""Facets round a ball and a shaft."""
LARGE = 5_400_000


def least(*works: Callable[[], Any], repeats: int = 3) -> list[tuple[float, Any]]:
    """(least seconds of the processor, result) of each, one after the other in each repeat."""
    out: list[tuple[float, Any]] = [(float("inf"), None)] * len(works)
    for _ in range(repeats):
        for k, work in enumerate(works):
            start = time.process_time()
            result = work()
            out[k] = min(out[k][0], time.process_time() - start), result
    return out


def manifest_of(folder: Path) -> Path | None:
    """The manifest of a robot."""
    every = [folder / f"{folder.name}.toml", folder / "score-groups.toml"]
    return next((path for path in every if path.exists()), None)


def one(manifest: Path, repeats: int) -> dict[str, float]:
    """Everything of one assembly."""
    import trimesh

    from kinform import contacts, surfaces
    from kinform.form.readers.assembly import load

    out: dict[str, float] = {}
    paths = sorted({manifest.parent / part.mesh.path for part in load(manifest).parts})
    (out["import"], assembly), (out["trimesh"], loaded) = least(
        lambda: load(manifest), lambda: [trimesh.load(path, process=True) for path in paths], repeats=repeats
    )
    del loaded
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts}
    out["parts"], out["facets"] = len(assembly.parts), sum(len(mesh.faces) for mesh in meshes.values())

    def recovered() -> Any:
        copies = surfaces.rigid_copies(meshes)
        shapes = [key for key in meshes if key not in copies]
        found = {}
        for pack in surfaces.packs([len(meshes[key].faces) for key in shapes]):
            keys = [shapes[k] for k in pack]
            every = surfaces.recover_all([meshes[key] for key in keys], assembly.tolerances)
            found |= dict(zip(keys, every, strict=True))
        return found | {key: surfaces.surfaces_of_copy(found[c.of], key, c) for key, c in copies.items()}

    ((out["surfaces"], found),) = least(recovered, repeats=1)
    out["surfaces MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0

    def in_contact() -> Any:
        result = contacts.find(assembly, found)
        # before the trees beside it are made, which take as much
        out.setdefault("MB", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return result

    (out["contacts"], touching), (out["fcl"], _) = least(
        in_contact, lambda: [bvh(mesh) for mesh in meshes.values()], repeats=repeats
    )
    out["pairs"], out["patches"] = len(touching.candidates), len(touching.patches)
    return out


def measured(manifest: Path, repeats: int = 2) -> dict[str, float]:
    """The same in a process of its own."""
    command = [sys.executable, __file__, "--one", str(manifest), str(repeats)]
    single = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    ran = subprocess.run(command, capture_output=True, text=True, check=True, env=single)
    found: dict[str, float] = json.loads(ran.stdout)
    return found


def of_robots(robots: Path | None) -> Iterator[Row]:
    for name in ROBOTS:
        folders = [*([robots / name] if robots else []), ROOT.parent / "shared" / "data" / name]
        manifest = next((m for folder in folders if (m := manifest_of(folder)) is not None), None)
        if manifest is None:
            print(f"{name}: not there; name the folder of the robots", flush=True)
            continue
        found = measured(manifest)
        floor = f"trimesh.load {found['trimesh']:.2f} s of {found['facets']:,.0f} facets"
        yield Row(f"{name}: import", found["import"] / found["trimesh"], IMPORT, "× trimesh", floor)
        each = 1e5 * found["surfaces"] / found["facets"]
        words = f"{found['surfaces']:.2f} s; bare FCL trees {found['fcl']:.2f} s"
        yield Row(f"{name}: surfaces", each, SURFACES, "s / 100,000", words, found["surfaces MB"])
        words = f"{found['contacts']:.2f} s, {found['pairs']:.0f} pairs; trees {found['fcl']:.2f} s"
        ratio = found["contacts"] / found["fcl"]
        yield Row(f"{name}: contacts after surfaces", ratio, CONTACTS.get(name), "× FCL trees", words, found["MB"])


def of_small_parts(quick: bool) -> Iterator[Row]:
    for parts in (100,) if quick else (100, 1000):
        with tempfile.TemporaryDirectory() as folder:
            found = measured(plate_with_pins(Path(folder), parts, 24), 1)
        words = f"{found['pairs']:.0f} pairs, {found['patches']:.0f} patches; bare FCL trees {found['fcl']:.2f} s"
        each = 1e3 * found["contacts"] / found["pairs"]
        yield Row(f"contacts of a plate with {parts} pins", each, PAIR, "ms a pair", words, found["MB"])
    for links in (10,) if quick else (200,):
        with tempfile.TemporaryDirectory() as folder:
            found = measured(chain(Path(folder), links)[0], 1)
        words = f"{found['pairs']:.0f} pairs, {found['patches']:.0f} patches; bare FCL trees {found['fcl']:.2f} s"
        each = 1e3 * found["contacts"] / found["pairs"]
        yield Row(f"contacts of a chain of {5 * links} bars, pins, bolts", each, PAIR, "ms a pair", words, found["MB"])


def write(path: Path, points: Any, faces: Any) -> None:
    """A binary STL of points (n, 3) and faces (m, 3)."""
    record = np.zeros(len(faces), np.dtype([("n", "<3f4"), ("v", "<9f4"), ("a", "<u2")]))
    record["v"] = points[faces].reshape(-1, 9)
    path.write_bytes(b"\0" * 80 + np.uint32(len(faces)).tobytes() + record.tobytes())


def wavy_blocks(folder: Path, facets: int) -> Path:
    """Two blocks that meet in one wavy face: each has a grid on that face and a grid on the other side."""
    side = round(np.sqrt(facets / 8)) + 1
    x, y = np.meshgrid(*[np.linspace(0.0, 100.0, side)] * 2, indexing="ij")
    face = 2.0 * np.sin(0.11 * x + 0.3) * np.cos(0.07 * y) + 1.1 * np.sin(0.05 * x * y / 20.0)
    grid = np.arange(side * side).reshape(side, side)
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    up = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    rim = np.concatenate([grid[:, 0], grid[-1, 1:], grid[-2::-1, -1], grid[0, -2:0:-1]])
    after, lower = np.roll(rim, -1), side * side
    walls = np.concatenate([np.stack([rim, rim + lower, after + lower], 1), np.stack([rim, after + lower, after], 1)])
    lines = ["schema = 1", "[assembly]", 'name = "waves"', 'units = "mm"']
    for name, high, low in (("lower", face, np.full_like(face, -10.0)), ("upper", np.full_like(face, 10.0), face)):
        points = np.concatenate([np.stack([x, y, z], 2).reshape(-1, 3) for z in (high, low)])
        faces = np.concatenate([up, up[:, ::-1] + lower, walls])
        write(folder / f"{name}.stl", points, faces)
        lines += ["[[part]]", f'name = "{name}"', f'mesh = "{name}.stl"']
    (folder / "waves.toml").write_text("\n".join(lines) + "\n")
    return folder / "waves.toml"


def seated(folder: Path, kind: str, segments: int, turned: float) -> Path:
    """A ball in its socket or a shaft in its bore, with so many facets round; `turned` in facets against each other."""
    from manifold3d import Manifold

    if kind == "ball":
        inner, block = Manifold.sphere(20.0, segments), Manifold.cube((60, 60, 30), True).translate((0, 0, -15))
    else:
        inner = Manifold.cylinder(50.0, 10.0, 10.0, segments, True).refine(8)
        block = Manifold.cube((40, 40, 30), True)
    lines = ["schema = 1", "[assembly]", f'name = "{kind}"', 'units = "mm"']
    for name, solid in ((kind, inner.rotate((0, 0, 360.0 * turned / segments))), ("block", block - inner)):
        mesh = solid.to_mesh64()
        faces = np.asarray(mesh.tri_verts, dtype=np.int64)
        write(folder / f"{name}.stl", np.asarray(mesh.vert_properties)[:, :3], faces)
        lines += ["[[part]]", f'name = "{name}"', f'mesh = "{name}.stl"']
    (folder / f"{kind}.toml").write_text("\n".join(lines) + "\n")
    return folder / f"{kind}.toml"


def growing(what: str, makes: Iterable[Callable[[Path], Path]]) -> Iterator[Row]:
    """A row for each size, and those of the growth."""
    seen = []
    for make in makes:
        with tempfile.TemporaryDirectory() as folder:
            seen.append(measured(make(Path(folder)), 1))
        found = seen[-1]
        words = f"surfaces {found['surfaces']:.2f} s, import {found['import']:.2f} s, FCL trees {found['fcl']:.2f} s"
        yield Row(
            f"contacts of {what}, {found['facets']:,.0f} facets", found["contacts"], None, "s", words, found["MB"]
        )
    many = np.log([found["facets"] for found in seen])
    for stage, aim in (("import", None), ("surfaces", None), ("contacts", EXPONENT)):
        power = float(np.polyfit(many, np.log([found[stage] for found in seen]), 1)[0])
        yield Row(f"{what}: {stage} grow with facets to the power", power, aim, "")
    power = float(np.polyfit(many, np.log([found["MB"] for found in seen]), 1)[0])
    yield Row(f"{what}: memory grows with facets to the power", power, None, "", "", seen[-1]["MB"])


def of_growth(quick: bool, large: bool) -> Iterator[Row]:
    sizes = [facets // 10 if quick else facets for facets in WAVY] + [LARGE] * large
    row = None
    for row in growing("two wavy blocks", [partial(wavy_blocks, facets=facets) for facets in sizes]):
        yield row
    if large and row is not None:
        yield Row(f"two wavy blocks of {LARGE:,} facets: memory", row.megabytes, LARGE_MB, "MB")
    for kind, where in (("ball", "its socket"), ("shaft", "its bore")):
        for turned in (0.0, 0.37):
            what = f"a {kind} in {where}{', turned' if turned else ''}"
            counts = [segments // 4 * 2 if quick else segments for segments in SEGMENTS]
            yield from growing(what, [partial(seated, kind=kind, segments=n, turned=turned) for n in counts])


def rows(quick: bool, robots: Path | None = None, large: bool | None = None) -> Iterator[Row]:
    """All rows; `large`: with 5.4 million facets, by default unless it is to be quick."""
    named = os.environ.get("KINFORM_ROBOTS")
    yield from of_robots(robots or (Path(named) if named else None))
    yield from of_small_parts(quick)
    yield from of_growth(quick, not quick if large is None else large)


def main(arguments: list[str]) -> None:
    """A table."""
    robots = next((Path(argument) for argument in arguments if not argument.startswith("--")), None)
    show(rows("--quick" in arguments, robots, "--large" in arguments))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(one(Path(sys.argv[2]), int(sys.argv[3]))))
    else:
        main(sys.argv[1:])
