"""A folder that a stranger filled with what Python and its packages read where they look in the working folder."""

from __future__ import annotations

import os
import pickle
from pathlib import Path

AT_START = ("sitecustomize", "usercustomize")
"""Modules that Python imports when it starts, also where kinform could not keep it from that."""

MODULES = (
    "tomllib", "multiprocessing", "conftest", "numpy", "scipy", "trimesh", "h5py", "yaml", "psutil", "numba",
    "llvmlite", "dask", "distributed", "tornado", "cloudpickle", "pydantic", "typer", "click", "rich", "lxml", "jinja2",
    "kinform", "json", "pickle", "random", "subprocess", "tempfile", "traceback", "typing", "hashlib", "struct",
    "asyncio", "concurrent", "ctypes", "logging", "xacro", "xacrodoc", "pathspec", "kinform_plugin", "setup",
)  # fmt: skip

NUMBA = """cache_dir: cache
cache_locator_classes: kinform_plugin.Locator
debug: 1
"""


class Marker:
    """Leaves a marker when it is unpickled."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self) -> tuple[object, ...]:
        return os.mkdir, (str(self.path),)


def planted(folder: Path, *, at_start: bool = True) -> Path:
    """Plant them; the path of what exists as soon as one of them is executed or unpickled."""
    marker = folder / "MARKER"
    deed = f"import os\nos.path.isdir({str(marker)!r}) or os.mkdir({str(marker)!r})\nraise SystemExit('executed')\n"
    for name in (*MODULES, *(AT_START if at_start else ())):
        (folder / f"{name}.py").write_text(deed)
    (folder / "planted.pth").write_text(f"import os; os.mkdir({str(marker)!r})\n")
    (folder / ".numba_config.yaml").write_text(NUMBA)
    (folder / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '-p kinform_plugin'\n")
    info = folder / "planted-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: planted\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "".join(f"[{group}]\nplanted = kinform_plugin\n" for group in ("pydantic", "numba_extensions", "dask.sizeof"))
    )
    bad = pickle.dumps(Marker(marker))
    for place in ("cache/kinform/kernel", ".cache/kinform/kernel", "kinform/kernel"):
        (folder / place).mkdir(parents=True)
        (folder / place / "advance.unit").write_bytes(bad)
    return marker
