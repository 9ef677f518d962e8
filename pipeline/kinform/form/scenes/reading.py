"""Reads a scene of any format in `kinform.formats.registry`."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from kinform.form.meshes.raw import Fault, MeshError
from kinform.form.scenes.scene import EXPORT, Scene
from kinform.form.sources import AS_IT_IS, Reading
from kinform.formats.registry import SCENE_FORMATS


def read_scene(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a file with this content. Raises MeshError, whatever a reader stumbles over."""
    format = next(f for f in SCENE_FORMATS if path.suffix.lower() in f.suffixes)
    if data.startswith(b"version https://git-lfs"):
        raise MeshError([Fault("is a pointer of Git LFS, not the file", "fetch it: git lfs pull")])
    module = importlib.import_module(f"kinform.{format.module}")
    read: Callable[[bytes, Path, Reading], Scene] = getattr(module, format.function)
    try:
        return read(data, path, reading)
    except MeshError:
        raise
    except Exception as error:  # other people's readers, and files that are wrong in ways that nobody thought of
        words = " ".join(str(error).split()) or type(error).__name__
        raise MeshError([Fault(f"cannot be read as {format.name}: {words[:200]}", EXPORT)]) from None


@lru_cache(maxsize=1)
def scene_once(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """As `read_scene`; the last one is kept: its tables are asked for first, its meshes then."""
    return read_scene(data, path, reading)
