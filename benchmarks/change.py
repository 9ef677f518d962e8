"""What a change costs: `python benchmarks/change.py [FOLDER] [--links N]`.

A chain of bars that are hinged on pins, with bolts in bores of their own: 200 parts, every one another shape, so that
no part is a copy of another, with dimples and grooves that touch nothing, as real parts have. Runs `kinform run` as a
user does, in processes of their own: from nothing, again with nothing changed (the least of five), and after the mesh
of one bolt changed; then from nothing with the changed mesh, whose bytes the incremental run must have given. Prints
seconds, of the clock and of all processors, which a busy machine changes less, and the share of the first run. No
simulation is requested.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

LINKS = 40
"""Bars; each brings a pin to the next one, and three bolts."""
SEGMENTS = 128
LENGTH, WIDTH, THICK = 60.0, 20.0, 6.0


def write(path, solid):
    """Binary STL of a manifold3d solid."""
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, dtype=np.int64)]
    record = np.zeros(len(corners), np.dtype([("n", "<3f4"), ("v", "<9f4"), ("a", "<u2")]))
    record["v"] = corners.reshape(-1, 9)
    path.write_bytes(b"\0" * 80 + np.uint32(len(corners)).tobytes() + record.tobytes())
    return len(corners)


def bolt(radius, length, head, segments, profile=1.6):
    """A bolt along z with its head on z = 0, its shank below."""
    from manifold3d import Manifold

    shank = Manifold.cylinder(length, radius, radius, segments).translate((0, 0, -length))
    rings = [
        Manifold.cylinder(0.1, 9, 9, 8)
        - Manifold.cylinder(0.1, 0.95 * profile * radius, 0.95 * profile * radius, segments)
        for _ in range(5)
    ]
    capped = Manifold.cylinder(head, profile * radius, profile * radius, segments)
    for n, ring in enumerate(rings):
        capped -= ring.translate((0, 0, 0.2 + 0.3 * n))
    return shank + capped


def chain(folder, links=LINKS, changed=None):
    """Meshes and manifest of the chain; returns the manifest and the number of facets. The head of the bolt that is
    `changed` is higher."""
    from manifold3d import Manifold, OpType

    lines = ["schema = 1", "[assembly]", 'name = "chain"', 'units = "mm"', 'ground = "bar000"']
    facets = 0

    def part(name, solid):
        nonlocal facets
        facets += write(folder / f"{name}.stl", solid)
        lines.extend(["[[part]]", f'name = "{name}"', f'mesh = "{name}.stl"', 'material = "steel"'])

    for k in range(links):
        x, z = LENGTH * k, THICK * (k % 2)
        radius = 3.0 + 0.01 * k
        bar = Manifold.cube((LENGTH + WIDTH + 0.02 * k, WIDTH, THICK)).translate((x - WIDTH / 2, -WIDTH / 2, z))
        bores = [(x, 0.0, radius - 0.01), (x + LENGTH, 0.0, radius)]
        for j in range(3):
            bores.append((x + 15.0 + 15.0 * j, 0.0, 2.0 + 0.003 * (3 * k + j)))
        holes = [
            Manifold.cylinder(3 * THICK, r + 0.02, r + 0.02, SEGMENTS + k % 7).translate((u, v, z - THICK))
            for u, v, r in bores
        ]
        dimple = Manifold.sphere(1.2, 32)
        places = [(x - 6 + 4.0 * n, side * 7.5, z + THICK * (n % 2)) for n in range(18) for side in (-1, 1)]
        holes += [dimple.translate(place) for place in places]
        part(f"bar{k:03d}", bar - Manifold.batch_boolean(holes, OpType.Add))
        pin = bolt(radius, 2 * THICK + 1, 2.0 + 0.01 * k, SEGMENTS + 1)
        part(f"pin{k:03d}", pin.translate((x + LENGTH, 0.0, 2 * THICK)))
        for j in range(3):
            u, v, r = bores[2 + j]
            name = f"bolt{k:03d}_{j}"
            head = 2.0 + 0.01 * j + 0.003 * k + (0.5 if name == changed else 0.0)
            part(name, bolt(r, THICK + 1, head, SEGMENTS + j).translate((u, v, z + THICK)))
    (folder / "chain.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder / "chain.toml", facets


def run(manifest, output):
    """Seconds of `kinform run` in a process of its own, by the clock and of all processors, and what it said."""
    command = [sys.executable, "-m", "kinform_cli", "run", str(manifest), "-o", str(output), "-f", "concise"]
    compiled = {"PYTHONPYCACHEPREFIX": str(output.parent / "pycache")}  # as an installed package has it
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"} | compiled
    start, before = time.perf_counter(), os.times()
    ran = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    seconds, after = time.perf_counter() - start, os.times()
    if not output.exists():
        sys.exit(ran.stderr)
    worked = after.children_user + after.children_system - before.children_user - before.children_system
    return seconds, worked, ran.stderr


def main(arguments) -> None:
    links = int(arguments[arguments.index("--links") + 1]) if "--links" in arguments else LINKS
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(arguments[0]) if arguments and not arguments[0].startswith("--") else Path(scratch)
        folder.mkdir(exist_ok=True)
        manifest, facets = chain(folder, links)
        output, fresh = folder / "chain.h5", folder / "fresh.h5"
        for path in (output, fresh):
            path.unlink(missing_ok=True)
        first, first_work, _ = run(manifest, output)
        print(f"{5 * links} parts, {facets} facets, {output.stat().st_size / 1e6:.1f} MB of results")
        print(f"from nothing        {first:7.2f} s, {first_work:6.2f} s of processors", flush=True)
        nothing, idle_work, _ = min(run(manifest, output) for _ in range(5))
        print(f"nothing changed     {nothing:7.2f} s, {idle_work:6.2f} s of processors", flush=True)
        chain(folder, links, changed=f"bolt{links // 2:03d}_1")
        second, work, told = run(manifest, output)
        print(f"one part changed    {second:7.2f} s, {work:6.2f} s of processors: ", end="")
        print(f"{second / first:.3f} and {work / first_work:.3f} of the first run")
        print(told, flush=True)
        again, _, _ = run(manifest, fresh)
        print(f"from nothing again  {again:7.2f} s")
        print("the same bytes" if output.read_bytes() == fresh.read_bytes() else "OTHER BYTES")


if __name__ == "__main__":
    main(sys.argv[1:])
