"""The formats of scenes, one line each. The suffix decides; the reader confirms."""

from __future__ import annotations

from kinform.frozen import dataclass


@dataclass(frozen=True)
class SceneFormat:
    """A format, its suffixes, and the module in `kinform` and function of its reader: `read(data, path, reading)`."""

    name: str
    suffixes: tuple[str, ...]
    module: str
    function: str
    unitless: bool = False
    """Whether its files have no unit of length."""


SCENE_FORMATS = (
    SceneFormat("glTF", (".glb", ".gltf"), "formats.gltf.reading.reader", "read_gltf"),
    SceneFormat("3MF", (".3mf",), "form.scenes.threemf", "read_3mf"),
    SceneFormat("DAE", (".dae",), "form.scenes.dae", "read_dae"),
    SceneFormat("PLY", (".ply",), "form.scenes.loose", "read_loose", unitless=True),
    SceneFormat("OFF", (".off",), "form.scenes.loose", "read_loose", unitless=True),
    SceneFormat("STEP", (".step", ".stp"), "form.scenes.step", "read_step"),
)
