"""Memory of the geometric stages by facets: `python benchmarks/memory.py [MILLIONS...]` (default 1 2 4).

A wavy torus as one binary STL file: imported, its surfaces and contacts found, joints, mass, written, in one process
a size. The peak of each stage is what the system says (VmHWM, set back before each stage; Linux). The promise is 750
bytes a facet beside 500 MB.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "pipeline"))
MANIFEST = """schema = 1
[assembly]
name = "torus"
units = "mm"
[[part]]
name = "torus"
mesh = "torus.stl"
density = 1000.0
"""


def write_torus(path: Path, facets: int) -> None:
    """A torus whose tube is a little wavy: neither planes nor cylinders."""
    around = int(np.sqrt(facets))
    across = facets // (2 * around)
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    tube = 10.0 + 0.2 * np.sin(7 * u) * np.sin(5 * v)
    points = np.stack(((50 + tube * np.cos(v)) * np.cos(u), (50 + tube * np.cos(v)) * np.sin(u), tube * np.sin(v)), 2)
    with open(path, "wb") as stream:
        stream.write(b"torus".ljust(80) + np.uint32(2 * around * across).tobytes())
        for i in range(around):
            a, b = points[i], points[(i + 1) % around]
            c, d = np.roll(b, -1, axis=0), np.roll(a, -1, axis=0)
            record = np.zeros(2 * across, np.dtype([("n", "<3f4"), ("v", "<9f4"), ("a", "<u2")]))
            record["v"][:across] = np.concatenate((a, b, c), axis=1)
            record["v"][across:] = np.concatenate((a, c, d), axis=1)
            stream.write(record.tobytes())


def measure(manifest: Path) -> None:
    """Print the peak of each stage."""
    from kinform import results, stages

    design = None
    steps = (
        ("import", lambda: stages.import_(manifest)),
        ("contacts", lambda: stages.contacts(design)),
        ("joints", lambda: stages.joints(design)),
        ("mass", lambda: stages.mass(design)),
        ("write", lambda: results.write(design, manifest.with_suffix(".h5"))),
        ("read", lambda: results.read(manifest.with_suffix(".h5"))),
    )
    for name, step in steps:
        Path("/proc/self/clear_refs").write_text("5")
        begun = time.process_time()
        design = step() or design
        facets = len(design.assembly.parts[0].mesh.faces)
        peak = _status("VmHWM")
        allowed = 500 + 750 * facets / 1e6
        print(
            f"{facets:>11,} {name:>9} {time.process_time() - begun:>7.1f} {_status('VmRSS'):>7.0f} {peak:>7.0f} "
            f"{allowed:>8.0f}  {(peak - 500) * 1e6 / facets:>6.0f}" + ("  more than allowed" if peak > allowed else ""),
            flush=True,
        )


def _status(key: str) -> float:
    """MB, as the system says."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return float(next(line.split()[1] for line in lines if line.startswith(key))) * 1024 / 1e6


def main() -> None:
    """A table."""
    if sys.argv[1:2] == ["--measure"]:
        return measure(Path(sys.argv[2]))
    print(f"{'facets':>11} {'stage':>9} {'CPU s':>7} {'MB':>7} {'peak':>7} {'allowed':>8}  bytes a facet beside 500 MB")
    for millions in map(float, sys.argv[1:] or ("1", "2", "4")):
        with tempfile.TemporaryDirectory() as folder:
            write_torus(Path(folder) / "torus.stl", int(millions * 1e6))
            manifest = Path(folder) / "torus.toml"
            manifest.write_text(MANIFEST)
            subprocess.run([sys.executable, __file__, "--measure", str(manifest)], check=True)


if __name__ == "__main__":
    main()
