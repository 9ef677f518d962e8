"""Times of the geometric stages beside their floors, in one run: `python benchmarks/stages.py MANIFEST`.

Floors: `trimesh.load(process=True)` for reading and welding, and bare FCL building a BVH of each distinct mesh for
contacts. Prints seconds and ratios; the least of three runs, except for surfaces, which take longest.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import fcl
import trimesh

from kinform import contacts, kinematics, surfaces
from kinform.form.readers.assembly import load


def best(work, runs=3):
    times, result = [], None
    for _ in range(runs):
        start = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - start)
    return min(times), result


def bare_bvh(meshes):
    for mesh in meshes:
        model = fcl.BVHModel()
        model.beginModel(len(mesh.vertices), len(mesh.faces))
        model.addSubModel(mesh.vertices, mesh.faces)
        model.endModel()


def row(name, seconds, floor_name="", floor=0.0):
    ratio = f"{seconds / floor:8.2f} × {floor_name} ({floor:.2f} s)" if floor else ""
    print(f"{name:22s}{seconds:8.2f} s {ratio}")


def main(manifest: Path) -> None:
    reading, assembly = best(lambda: load(manifest))
    paths = sorted({manifest.parent / part.mesh.path for part in assembly.parts if part.mesh is not None})
    floor, _ = best(lambda: [trimesh.load(path, process=True) for path in paths])
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts if part.mesh is not None}
    facets = sum(len(mesh.faces) for mesh in meshes.values())
    print(f"{assembly.name}: {len(assembly.parts)} parts, {len(meshes)} distinct meshes, {facets} facets")
    row("import", reading, "trimesh.load", floor)
    seconds, found = best(lambda: {k: surfaces.recover(m, assembly.tolerances) for k, m in meshes.items()}, runs=1)
    row("surfaces, one core", seconds)
    print(f"{'':22s}{1e5 * seconds / facets:8.2f} s per 100,000 facets")
    trees, _ = best(lambda: bare_bvh(meshes.values()))
    seconds, touching = best(lambda: contacts.find(assembly, found))
    row("contacts", seconds, "bare FCL trees", trees)
    seconds, _ = best(lambda: kinematics.derive(assembly, found, touching))
    row("joints", seconds)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
