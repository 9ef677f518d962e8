"""Time and memory of bodies, joints and mobility by number of parts: `python benchmarks/mobility.py [--quick]`.

Contacts are made analytically, hinges as a journal with a thrust ring, so that only the joints stage is measured:
`pins` in one plate, `arms` of ten links, `linkages` (four-bars on one frame), a `lift` (one scissor chain of crossed
links: one block with hundreds of loops), a `net` (a grid of links hinged at its crossings), and `mixed` of all. Each
size runs in a process of its own. The last lines fit the exponents of time and memory against parts.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Iterator

import numpy as np
from table import Row

from kinform.kinematics import derive
from kinform.model.assembly import Assembly, Mesh, MeshHealth, Part, Source
from kinform.model.contacts import Contacts, Patch
from kinform.model.function import Function
from kinform.model.tolerances import Tolerances

SIZES = (100, 300, 1000, 3000, 5000)
HERE = Source("bench.toml", 1)
Z = np.array([0.0, 0.0, 1.0])


class Builder:
    """Parts and hinges of a synthetic assembly."""

    def __init__(self):
        self.places: dict[str, list] = {}
        self.patches: list[Patch] = []

    def part(self, name, place):
        self.places.setdefault(name, []).append(np.asarray(place, float))
        return name

    def hinge(self, a, b, place, axis=Z, radius=0.003, length=0.01):
        """A pin of a in a bore of b with a thrust face."""
        place = np.asarray(place, float)
        self.part(a, place), self.part(b, place)
        u = np.cross(np.eye(3)[int(np.argmin(np.abs(axis)))], axis)
        u /= np.linalg.norm(u)
        v = np.cross(axis, u)
        angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
        radial = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)
        heights = np.linspace(-length / 2, length / 2, 4)
        journal = (place + radius * radial[None] + heights[:, None, None] * axis).reshape(-1, 3)
        ring = (place + length / 2 * axis + np.array([radius, 2 * radius])[:, None, None] * radial).reshape(-1, 3)
        self._patch(a, b, "cylinder", journal, np.tile(radial, (4, 1)), axis, place, 2 * np.pi * radius * length)
        self._patch(a, b, "plane", ring, np.tile(axis, (48, 1)), axis, ring.mean(axis=0), 3 * np.pi * radius**2)

    def _patch(self, a, b, kind, points, normals, axis, point, area):
        sign = 1.0 if a < b else -1.0
        n = len(points)
        self.patches.append(
            Patch(
                parts=(min(a, b), max(a, b)), surfaces=(0, 0), kind=kind, one_sided=False, points=points,
                normals=sign * normals, gaps=np.zeros(n), weights=np.full(n, area / n), area=area, gap=0.0, axis=axis,
                point=point, radii=(0.003, 0.003) if kind == "cylinder" else (0.0, 0.0), misalignment=0.0, offset=0.0,
                uncertainty=(1e-9, 1e-12), chord=0.0, fit="touch",
            )
        )  # fmt: skip

    def done(self, ground):
        parts = tuple(self._made(name) for name in sorted(self.places))
        assembly = Assembly(
            name="bench", units="m", parts=parts, groups=(), assumptions=(), ground=ground, tolerances=Tolerances(),
            infer_fasteners=False, function=Function(mobility=None, joints=()), simulation=None, subassemblies=(),
            source=HERE, files=(),
        )  # fmt: skip
        patches = tuple(sorted(self.patches, key=lambda p: p.parts))
        pairs = tuple(sorted({p.parts for p in patches}))
        return assembly, Contacts(patches, (), pairs, dict.fromkeys(pairs, 5e-4))

    def _made(self, name):
        corners = np.concatenate([np.array(self.places[name]) - 0.01, np.array(self.places[name]) + 0.01])
        health = MeshHealth(4, 4, True, True, "NoError", 1e-6, 0, 0, 0, 0, 1, 1e-7)
        faces = np.array([[0, 1, 1]])
        return Part(
            name, Mesh(corners, faces, health, "p.stl", None, name), np.eye(4), True, None, 1000.0, None, "m", HERE
        )


def pins(b, n, x0=0.0, name="pin"):
    side = int(np.ceil(np.sqrt(n)))
    for k in range(n):
        b.hinge(f"{name}{k:05d}", "frame", (x0 + 0.02 * (k % side), 0.02 * (k // side), 0.0))


def arms(b, n, x0=0.0, name="arm"):
    axes = (Z, np.array([0.0, 1.0, 0.0]), np.array([0.6, 0.8, 0.0]))
    for k in range(n):
        before = "frame" if k % 10 == 0 else f"{name}{k - 1:05d}"
        b.hinge(f"{name}{k:05d}", before, (x0 + 0.3 * (k // 10), 0.013 * (k // 10), 0.05 * (k % 10)), axes[k % 10 % 3])


def linkages(b, n, x0=0.0, name="bar"):
    for k in range(0, n - 2, 3):
        x, y = x0 + 0.3 * (k // 3 % 20), 0.3 * (k // 60)
        a, c, d = (f"{name}{k + i:05d}" for i in range(3))
        for p, q, at in (("frame", a, (0, 0)), (a, c, (0.02, 0.06)), (c, d, (0.12, 0.09)), (d, "frame", (0.13, 0))):
            b.hinge(p, q, (x + at[0], y + at[1], 0.0))


def lift(b, n, x0=0.0, name="lift"):
    """Crossed links, stage upon stage, on the frame: one freedom, and a loop a stage."""
    for k in range(n // 2):
        left, right, y = f"{name}{2 * k:05d}", f"{name}{2 * k + 1:05d}", 0.1 * k
        b.hinge(left, right, (x0 + 0.1, y + 0.05, 0.0))
        below = ("frame", None) if k == 0 else (f"{name}{2 * k - 1:05d}", f"{name}{2 * k - 2:05d}")
        b.hinge(left, below[0], (x0, y, 0.0))
        if below[1] is not None:
            b.hinge(right, below[1], (x0 + 0.2, y, 0.0))


def net(b, n, x0=0.0, name="net"):
    """Squares of rigid plates hinged at their corners to the next: a grid of loops."""
    side = max(2, int(np.sqrt(n)))
    for i in range(side):
        for j in range(side):
            me = f"{name}{i:03d}-{j:03d}"
            shift = 0.01 * ((i + j) % 2)
            if i + 1 < side:
                b.hinge(me, f"{name}{i + 1:03d}-{j:03d}", (x0 + 0.1 * i + 0.05, 0.1 * j + shift, 0.0))
            if j + 1 < side:
                b.hinge(me, f"{name}{i:03d}-{j + 1:03d}", (x0 + 0.1 * i + shift, 0.1 * j + 0.05, 0.0))
    b.hinge("frame", f"{name}000-000", (x0 - 0.05, 0.0, 0.0))


def mixed(b, n):
    linkages(b, n * 3 // 10, 0.0)
    lift(b, n // 10, 50.0)
    net(b, min(n // 20, 225), 60.0)
    arms(b, n * 3 // 10, 70.0)
    pins(b, n // 4, 300.0)


KINDS = {"pins": pins, "arms": arms, "linkages": linkages, "lift": lift, "net": net, "mixed": mixed}


def one(kind, size):
    builder = Builder()
    KINDS[kind](builder, size)
    assembly, contacts = builder.done("frame")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    start = time.process_time()
    found = derive(assembly, {}, contacts)
    seconds = time.process_time() - start
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    mobility = found.mobility
    row = {
        "parts": len(assembly.parts), "joints": len(found.joints),
        "loops": len(found.joints) - len(found.bodies) + 1, "instantaneous": mobility.instantaneous,
        "redundant": mobility.redundant, "seconds": seconds, "MB": after - before,
    }  # fmt: skip
    print(json.dumps(row))


def measured(kind, size):
    command = [sys.executable, __file__, "--one", kind, str(size)]
    single = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True, env=single).stdout)


def rows(quick: bool) -> Iterator[Row]:
    """All of derive on the mixed assembly."""
    sizes, seconds = SIZES[:3] if quick else SIZES, []
    for size in sizes:
        found = measured("mixed", size)
        seconds.append(found["seconds"])
        aim = 10.0 if size == 5000 else None
        words = f"{found['joints']} joints, {1e3 * found['seconds'] / found['joints']:.2f} ms a joint"
        yield Row(f"joints and mobility, mixed, {size} parts", found["seconds"], aim, "s", words, found["MB"])
    power = np.polyfit(np.log(sizes), np.log(seconds), 1)[0]
    yield Row("joints and mobility, mixed: grows with parts to the power", power, unit="")


def main(arguments):
    quick = "--quick" in arguments
    kinds = [a for a in arguments if a in KINDS] or list(KINDS)
    columns = ("parts", "joints", "loops", "instantaneous", "redundant", "seconds", "MB")
    print(f"{'':9s}", *(f"{c:>13s}" for c in columns), "processor seconds of one core; memory is what derive adds")
    for kind in kinds:
        rows = []
        for size in SIZES[: 3 if quick else None]:
            rows.append(measured(kind, size))
            print(f"{kind:9s}", *(f"{rows[-1][c]:>13,.{2 if c == 'seconds' else 0}f}" for c in columns), flush=True)
        size = np.log([row["parts"] for row in rows])
        for what in ("seconds", "MB"):
            values = np.log([max(row[what], 1e-3) for row in rows])
            print(f"{kind}: {what} grow as parts to the power {np.polyfit(size, values, 1)[0]:.2f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        one(sys.argv[2], int(sys.argv[3]))
    else:
        main(sys.argv[1:])
