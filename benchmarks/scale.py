"""Time and memory of the geometric stages by size: `python benchmarks/scale.py [MANIFEST...] [--quick]`.

Synthetic assemblies (plates with pins in their bores, all pins copies in poses of their own; ten copies of a drilled
plate) of 10 k to 3 M facets and of 10 to 5,000 parts, and the manifests named; each in a process of its own,
beside floors in the same run: reading the bytes once, `trimesh.load`, a bare FCL BVH of every mesh and of every
distinct mesh, FCL's `distance` of the same pairs, and trimesh's `in_collision_internal(return_data=True)`.
The last lines fit the exponent of time against facets.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

FACETS = (10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000)
PARTS = (10, 100, 1000, 5000)
SLOW = 200_000
"""Facets above which trimesh's collision floor is left out: it takes minutes."""


def megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def write(path, solid, pose):
    """Binary STL of a manifold3d solid."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3] @ pose[:3, :3].T + pose[:3, 3]
    corners = vertices[np.asarray(mesh.tri_verts, dtype=np.int64)]
    record = np.zeros(len(corners), np.dtype([("n", "<3f4"), ("v", "<9f4"), ("a", "<u2")]))
    record["v"] = corners.reshape(-1, 9)
    path.write_bytes(b"\0" * 80 + np.uint32(len(corners)).tobytes() + record.tobytes())


def plate_with_pins(folder, pins, segments):
    """A plate with a square of bores and a pin in each; every pin is a file of its own."""
    from manifold3d import Manifold, OpType
    from scipy.spatial.transform import Rotation

    side = int(np.ceil(np.sqrt(pins)))
    places = [(10.0 * (k % side), 10.0 * (k // side)) for k in range(pins)]
    bore = Manifold.cylinder(7, 3.05, 3.05, segments)
    holes = Manifold.batch_boolean([bore.translate((x, y, -1)) for x, y in places], OpType.Add)
    write(
        folder / "plate.stl", Manifold.cube((10 * side + 5, 10 * side + 5, 5)).translate((-7, -7, 0)) - holes, np.eye(4)
    )
    pin = Manifold.cylinder(5, 3, 3, segments) + Manifold.cylinder(2, 4.5, 4.5, segments).translate((0, 0, 5))
    lines = [
        "schema = 1",
        "[assembly]",
        'name = "pins"',
        'units = "mm"',
        "[[part]]",
        'name = "plate"',
        'mesh = "plate.stl"',
    ]
    for k, (x, y) in enumerate(places):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_euler("z", k, degrees=True).as_matrix()
        pose[:3, 3] = x, y, 0
        write(folder / f"pin{k}.stl", pin, pose)
        lines += ["[[part]]", f'name = "pin{k}"', f'mesh = "pin{k}.stl"']
    (folder / "pins.toml").write_text("\n".join(lines) + "\n")
    return folder / "pins.toml"


def with_turns_stated(manifest, pins):
    """The plate with pins, and every pin's turn stated as a joint."""
    side = int(np.ceil(np.sqrt(pins)))
    stated = [f"[function]\nmobility = {pins}\n"]
    stated += [
        f'[[function.joint]]\nname = "turn{k}"\nbetween = ["plate", "pin{k}"]\ntype = "revolute"\n'
        f"axis = [0, 0, 1]\npoint = [{10.0 * (k % side)}, {10.0 * (k // side)}, 0]\n"
        for k in range(pins)
    ]
    path = manifest.with_name("stated.toml")
    path.write_text(manifest.read_text() + "".join(stated))
    return path


def stack_of_copies(folder, facets):
    """Ten drilled plates on each other, one shape in ten poses, each a file of its own."""
    from manifold3d import Manifold, OpType
    from scipy.spatial.transform import Rotation

    bore = Manifold.cylinder(7, 3, 3, max(8, facets // 2560))
    places = [(10.0 * (k % 8), 10.0 * (k // 8), -1) for k in range(64)]
    plate = Manifold.cube((84, 84, 5)).translate((-7, -7, 0)) - Manifold.batch_boolean(
        [bore.translate(place) for place in places], OpType.Add
    )
    lines = ["schema = 1", "[assembly]", 'name = "stack"', 'units = "mm"']
    for k in range(10):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_euler("z", 90 * k, degrees=True).as_matrix()
        pose[:3, 3] = 0, 0, 5 * k
        write(folder / f"plate{k}.stl", plate, pose)
        lines += ["[[part]]", f'name = "plate{k}"', f'mesh = "plate{k}.stl"']
    (folder / "stack.toml").write_text("\n".join(lines) + "\n")
    return folder / "stack.toml"


def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def bvh(mesh):
    import fcl

    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def floors(assembly, contacts, facets, copies):
    import fcl
    import trimesh

    meshes = {part.mesh.digest: part.mesh for part in assembly.parts}
    out = {}
    out["fcl"], models = timed(lambda: {key: bvh(mesh) for key, mesh in meshes.items()})
    out["fcl, instanced"], _ = timed(lambda: [bvh(mesh) for key, mesh in meshes.items() if key not in copies])
    objects = {
        part.name: fcl.CollisionObject(models[part.mesh.digest], fcl.Transform(part.X_WP[:3, :3], part.X_WP[:3, 3]))
        for part in assembly.parts
    }
    out["distance"], _ = timed(lambda: [fcl.distance(objects[a], objects[b]) for a, b in contacts.candidates])
    if facets <= SLOW:
        manager = trimesh.collision.CollisionManager()
        for part in assembly.parts:
            manager.add_object(
                part.name, trimesh.Trimesh(part.mesh.vertices, part.mesh.faces, process=False), part.X_WP
            )
        out["trimesh collision"], _ = timed(lambda: manager.in_collision_internal(return_data=True))
    return out


def one(manifest: Path) -> None:
    """Everything of one assembly, as a line of JSON."""
    import trimesh

    from kinform import contacts, kinematics, surfaces
    from kinform.form.readers.assembly import load

    idle = megabytes()
    out: dict[str, float] = {}
    out["import"], assembly = timed(lambda: load(manifest))
    paths = sorted({manifest.parent / part.mesh.path for part in assembly.parts})
    meshes = {part.mesh.digest: part.mesh for part in assembly.parts}

    def recovered():
        copies = surfaces.rigid_copies(meshes)
        found = {k: surfaces.recover(m, assembly.tolerances) for k, m in meshes.items() if k not in copies}
        return copies, found | {k: surfaces.surfaces_of_copy(found[c.of], k, c) for k, c in copies.items()}

    out["surfaces"], (copies, found) = timed(recovered)
    out["contacts"], touching = timed(lambda: contacts.find(assembly, found))
    facets = sum(len(part.mesh.faces) for part in assembly.parts)
    out["MB"], out["kB a facet"] = megabytes(), 1024 * (megabytes() - idle) / facets
    out["joints"], _ = timed(lambda: kinematics.derive(assembly, found, touching))
    out["bytes"], _ = timed(lambda: [path.read_bytes() for path in paths])
    out["trimesh.load"], _ = timed(lambda: [trimesh.load(path, process=True) for path in paths])
    out |= floors(assembly, touching, facets, copies)
    print(json.dumps({"facets": facets, "parts": len(assembly.parts), "shapes": len(meshes) - len(copies), **out}))


def measured(manifest):
    ran = subprocess.run([sys.executable, __file__, "--one", str(manifest)], capture_output=True, text=True, check=True)
    return json.loads(ran.stdout)


COLUMNS = (
    "facets", "parts", "shapes", "import", "surfaces", "contacts", "joints", "MB", "kB a facet", "bytes",
    "trimesh.load",
    "fcl", "fcl, instanced", "distance", "trimesh collision",
)  # fmt: skip


def show(name, row):
    cells = [
        f"{row[c]:>{max(len(c), 8)},.{0 if c in COLUMNS[:3] or c == 'MB' else 2}f}"
        if c in row
        else " " * max(len(c), 8)
        for c in COLUMNS
    ]
    ratio = (row["surfaces"] + row["contacts"]) / row["fcl"]
    print(f"{name:14s}", *cells, f"{ratio:8.1f}", flush=True)


def main(arguments) -> None:
    quick = "--quick" in arguments
    print(f"{'':14s}", *(f"{c:>8s}" for c in COLUMNS), "(surfaces + contacts) / fcl; seconds, one core")
    for manifest in (Path(a) for a in arguments if not a.startswith("--")):
        show(manifest.stem[:14], measured(manifest))
    rows = []
    for facets in FACETS[: 3 if quick else None]:
        with tempfile.TemporaryDirectory() as folder:
            row = measured(plate_with_pins(Path(folder), 64, max(12, facets // 64 // 16)))
        rows.append(row)
        show("64 pins", row)
    for parts in PARTS[: 2 if quick else None]:
        with tempfile.TemporaryDirectory() as folder:
            show(f"{parts} pins", measured(plate_with_pins(Path(folder), parts, 24)))
    for facets in FACETS[2 : 3 if quick else -1]:
        with tempfile.TemporaryDirectory() as folder:
            show("10 copies", measured(stack_of_copies(Path(folder), facets)))
    size = np.log([row["facets"] for row in rows])
    for stage in ("import", "surfaces", "contacts"):
        print(
            f"{stage}: time grows as facets to the power "
            f"{np.polyfit(size, np.log([row[stage] for row in rows]), 1)[0]:.2f}"
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(Path(sys.argv[2]))
    else:
        main(sys.argv[1:])
