"""glb: shapes with the motion as animation, and the axes of joints as nodes (binary glTF 2.0).

One node a body, which the animation moves; under it its parts, and the joints of which it is the first
body, whose z-axis is the joint's axis. Equal meshes are stored once. glTF has y up, the world here z.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.exports.exported import Exported
from kinform.exports.looks import Shape, shapes_of
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers
from kinform.foundation.algebra.spatial import quaternions
from kinform.foundation.colours import light
from kinform.foundation.escapes import json_text
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint
from kinform.version import __version__

# Numbers of glTF 2.0:
FLOAT, UNSIGNED = 5126, 5125  # types of components
VERTICES, INDICES = 34962, 34963  # targets of buffers
LINES = 1  # mode of a primitive


@dataclass
class _File:
    """glTF as it grows: the JSON part and the binary one."""

    data: dict[str, Any] = field(default_factory=dict)
    binary: bytearray = field(default_factory=bytearray)

    def add(self, kind: str, **values: Any) -> int:
        """Add to one of the top lists; its index there."""
        rows: list[Any] = self.data.setdefault(kind, [])
        rows.append({key: value for key, value in values.items() if value is not None})
        return len(rows) - 1

    def accessor(self, values: NDArray[Any], type: str, target: int | None = None, bounds: bool = False) -> int:
        """Numbers (n,) or (n, k) as float or unsigned integer."""
        component = FLOAT if values.dtype.kind == "f" else UNSIGNED
        packed = values.astype("<f4" if component == FLOAT else "<u4")
        view = self.add("bufferViews", buffer=0, byteOffset=len(self.binary), byteLength=packed.nbytes, target=target)
        self.binary += packed.tobytes()
        rows = packed.reshape(len(packed), -1)
        low, high = (rows.min(axis=0).tolist(), rows.max(axis=0).tolist()) if bounds else (None, None)
        return self.add(
            "accessors", bufferView=view, componentType=component, count=len(packed), type=type, min=low, max=high
        )

    def encoded(self) -> bytes:
        """The file: header, JSON chunk, binary chunk."""
        self.data["buffers"] = [{"byteLength": len(self.binary)}]
        text = json_text(json.dumps(self.data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        out = [b"glTF", _u32(2), _u32(12 + 8 + len(text) + 8 + len(body))]
        out += [_u32(len(text)), b"JSON", text, _u32(len(body)), b"BIN\0", body]
        return b"".join(out)


def export(model: ExportModel) -> Exported:
    """NAME.glb."""
    file = _File({"asset": {"version": "2.0", "generator": f"kinform {__version__}"}, "scene": 0})
    shapes = shapes_of(model)
    meshes = _Meshes(file)
    half = float(np.sqrt(0.5))
    file.add("scenes", name=model.name, nodes=[0])
    file.add("nodes", name=model.name, rotation=[-half, 0.0, 0.0, half])
    nodes: dict[str, int] = {}
    for body in model.kinematics.bodies:
        nodes[str(body.name)] = file.add("nodes", name=str(body.name), extras={"kind": "body", "ground": body.ground})
    below: dict[int, list[int]] = {node: [] for node in nodes.values()}
    for name, node in nodes.items():
        below[node] += [_part(file, meshes, shape) for shape in shapes[name]]
    length = model.mechanism.length
    for joint in model.kinematics.joints:
        if joint.axis is not None and joint.point is not None:
            below[nodes[joint.bodies[0]]].append(_axis(file, meshes, joint, length))
    for node, children in below.items():
        if children:
            file.data["nodes"][node]["children"] = children
    file.data["nodes"][0]["children"] = list(nodes.values())
    lost = () if _motion(file, model, nodes) else ("the motion: nothing was simulated",)
    if lost:
        file.data["asset"]["extras"] = {"not carried": list(lost)}
    name = identifiers([model.name], FILES)[model.name]
    return Exported({f"{name}.glb": file.encoded()}, lost)


class _Meshes:
    """Meshes and materials, each stored once."""

    def __init__(self, file: _File):
        self.file = file
        self._geometry: dict[str, tuple[int, int]] = {}
        self._materials: dict[tuple[str, tuple[float, ...]], int] = {}
        self._meshes: dict[tuple[str, int], int] = {}

    def material(self, name: str, rgba: tuple[float, ...]) -> int:
        """A dull material of a colour of sRGB, which glTF has in linear values; metal would be black without
        surroundings."""
        if (name, rgba) not in self._materials:
            colour = [round(v, 6) for v in light(rgba)] + [rgba[3]]
            shade = {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.7}
            self._materials[name, rgba] = self.file.add(
                "materials", name=name or "unstated", pbrMetallicRoughness=shade, doubleSided=True
            )
        return self._materials[name, rgba]

    def of(self, shape: Shape) -> int:
        """The mesh of a shape."""
        material = self.material(shape.material, shape.rgba)
        if shape.digest not in self._geometry:
            used, faces = np.unique(shape.faces, return_inverse=True)
            positions = self.file.accessor(shape.vertices[used], "VEC3", VERTICES, bounds=True)
            indices = self.file.accessor(faces.ravel().astype(np.uint32), "SCALAR", INDICES)
            self._geometry[shape.digest] = positions, indices
        if (shape.digest, material) not in self._meshes:
            positions, indices = self._geometry[shape.digest]
            primitive = {"attributes": {"POSITION": positions}, "indices": indices, "material": material}
            self._meshes[shape.digest, material] = self.file.add("meshes", name=shape.part, primitives=[primitive])
        return self._meshes[shape.digest, material]

    def line(self, length: float) -> int:
        """A line along z."""
        # The axes of joints are red, which no material has.
        material = self.material("axis", (0.85, 0.15, 0.1, 1.0))
        if ("line", material) not in self._meshes:
            ends = np.array([[0.0, 0.0, -0.5 * length], [0.0, 0.0, 0.5 * length]])
            positions = self.file.accessor(ends, "VEC3", VERTICES, bounds=True)
            primitive = {"attributes": {"POSITION": positions}, "mode": LINES, "material": material}
            self._meshes["line", material] = self.file.add("meshes", name="axis", primitives=[primitive])
        return self._meshes["line", material]


def _part(file: _File, meshes: _Meshes, shape: Shape) -> int:
    (q,) = quaternions(shape.X_WP[None, :3, :3])
    return file.add(
        "nodes", name=shape.part, mesh=meshes.of(shape), translation=_floats(shape.X_WP[:3, 3]), rotation=_xyzw(q),
        extras={"kind": "part"},
    )  # fmt: skip


def _axis(file: _File, meshes: _Meshes, joint: Joint, length: float) -> int:
    assert joint.axis is not None and joint.point is not None
    extras = {"kind": "joint", "type": joint.type, "status": joint.status, "bodies": list(joint.bodies)}
    return file.add(
        "nodes", name=joint.name, mesh=meshes.line(length), translation=_floats(joint.point),
        rotation=_xyzw(_from_z(joint.axis)), extras=extras,
    )  # fmt: skip


def _from_z(axis: Array) -> Array:
    """The shortest turn that takes z to the axis, as a quaternion."""
    q = np.array([1.0 + axis[2], -axis[1], axis[0], 0.0])
    if q[0] < SOLVED:  # the axis is −z
        return np.array([0.0, 1.0, 0.0, 0.0])
    return np.asarray(q / np.linalg.norm(q))


def _motion(file: _File, model: ExportModel, nodes: dict[str, int]) -> bool:
    """Animate the bodies that move; whether there is a motion to show."""
    run = model.simulation
    if run is None or len(run.time) < 2:
        return False
    channels: list[Any] = []
    samplers: list[Any] = []
    times = file.accessor(run.time, "SCALAR", bounds=True)
    for k, name in enumerate(run.body_names):
        tracks = (("translation", run.p_WB[:, k], "VEC3"), ("rotation", run.q_WB[:, k][:, [1, 2, 3, 0]], "VEC4"))
        for path, values, type in tracks:
            if name not in nodes or np.all(values == values[0]):
                continue
            output = file.accessor(np.ascontiguousarray(values), type)
            channels.append({"sampler": len(samplers), "target": {"node": nodes[name], "path": path}})
            samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
    if channels:
        file.add("animations", name="motion", channels=channels, samplers=samplers)
    else:
        file.data["bufferViews"].pop(), file.data["accessors"].pop()
        del file.binary[-4 * len(run.time) :]
    return True


def _floats(values: Array) -> list[float]:
    return [float(value) + 0.0 for value in values]


def _xyzw(q: Array) -> list[float]:
    return _floats(q[[1, 2, 3, 0]])


def _u32(value: int) -> bytes:
    return value.to_bytes(4, "little")
