"""What other programs, or readers of our own, make of exports."""

from __future__ import annotations

import json
import os
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from kinform.behaviour import Constant, Node, System, VoltageController, VoltageSource
from kinform.behaviour.joints import KINDS
from kinform.behaviour.shafts import Controller
from kinform.exports.tree import grow
from kinform.foundation.algebra.spatial import to_matrix
from support.export_models import (
    known,
    model_of,
    written,
)
from support.validators import ghdl, npm, package, program
from support.vhdl_reader import Flat, read


def numbers(text):
    return np.array([float(x) for x in text.split()])


def pose(node):
    """(4, 4) of an <origin>."""
    X_PC = np.eye(4)
    if node is not None:
        X_PC[:3, 3] = numbers(node.get("xyz", "0 0 0"))
        X_PC[:3, :3] = Rotation.from_euler("xyz", numbers(node.get("rpy", "0 0 0"))).as_matrix()
    return X_PC


def forward(text, values):
    """(4, 4) pose of every link for joint values by name, as the URDF specification has it."""
    root = ElementTree.fromstring(text)
    joints = {node.get("name"): node for node in root.findall("joint")}
    carried = {node.find("child").get("link"): node for node in joints.values()}
    assert len(carried) == len(joints), "a link has two parents"

    def value(node):
        mimic = node.find("mimic")
        if mimic is None:
            return values.get(node.get("name"), 0.0)
        return float(mimic.get("multiplier")) * value(joints[mimic.get("joint")]) + float(mimic.get("offset"))

    def place(link):
        node = carried.get(link)
        if node is None:
            return np.eye(4)
        moved = np.eye(4)
        if node.get("type") in ("revolute", "continuous"):
            axis = numbers(node.find("axis").get("xyz"))
            moved[:3, :3] = Rotation.from_rotvec(value(node) * axis).as_matrix()
        elif node.get("type") == "prismatic":
            moved[:3, 3] = value(node) * numbers(node.find("axis").get("xyz"))
        else:
            assert node.get("type") in ("fixed", "floating")
        return place(node.find("parent").get("link")) @ pose(node.find("origin")) @ moved

    return {node.get("name"): place(node.get("name")) for node in root.findall("link")}


def posed(model, seed):
    """Random coordinates, or where there are loops those of our run: values by URDF joint, and poses (4, 4) of link
    frames by body."""
    random = np.random.default_rng(seed)
    mechanism, tree = model.mechanism, grow(model.system, KINDS, model.stated)
    q, values = mechanism.start, {}
    for link in tree.links:
        if link.joint is None or link.joint.kind.rates == 0:
            continue
        (slot,) = (s for s in mechanism.slots if s.name == link.joint.subject)
        if slot.has_ball:
            angles = random.uniform(-1.2, 1.2, 3)
            turn = Rotation.from_euler("XYZ", angles)
            q[slot.q] = (turn if link.forward else turn.inv()).as_quat(scalar_first=True)
        else:
            q[slot.q] = random.uniform(-2.0, 2.0, slot.q.stop - slot.q.start)
    if tree.closing:
        q = model.simulation.joint_position[5 * seed + 2]
    for link in tree.links:
        if link.joint is None:
            continue
        (slot,) = (s for s in mechanism.slots if s.name == link.joint.subject)
        if slot.has_ball:
            turn = Rotation.from_quat(q[slot.q], scalar_first=True)
            angles = (turn if link.forward else turn.inv()).as_euler("XYZ")
            values |= {f"{slot.name}.{axis}": angle for axis, angle in zip("xyz", angles, strict=True)}
        else:
            values |= {motion.name: q[slot.q.start + motion.coordinate] for motion in link.motions}
    X_all = mechanism.poses(q)
    out = {}
    for link in tree.links:
        body = mechanism.bodies.index(link.body.subject)
        X_WB = X_all[mechanism.link_of[body]].copy()
        X_WB[:3, 3] += X_WB[:3, :3] @ (link.origin - mechanism.centre) + mechanism.centre
        out[link.body.subject] = X_WB
    return values, out


def loaded(found, folder):
    """MuJoCo's model and data at the start."""
    mujoco = package("mujoco")
    path, _ = written(found, "mjcf", folder)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return mujoco, model, data


def origin(found, name):
    """Where the body's frame in the file is at the pose of the meshes: on its joint."""
    from kinform.exports.tree import grow
    from kinform.formats.mjcf.writing.writer import CLOSABLE

    links = grow(found.system, CLOSABLE, found.stated).links
    return next(link.origin for link in links if link.body.subject == name)


def gap(found, model, data, mujoco, k):
    """Greatest distance of a body's place and orientation from those of our output k."""
    run, exported, worst = found.simulation, model_of(found), 0.0
    for b, name in enumerate(run.body_names):
        if name == exported.system.ground.subject:
            continue
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        R = to_matrix(run.q_WB[k, b])
        place = R @ origin(exported, name) + run.p_WB[k, b]
        worst = max(worst, np.abs(data.xpos[body] - place).max(), np.abs(data.xmat[body].reshape(3, 3) - R).max())
    return worst


def solved(found, folder):
    """(T, B, 3) places and (T, B, 4) orientations of the bodies at our output times, by rumoca."""
    rumoca = package("rumoca")
    path, _ = written(found, "modelica", folder)
    run = found.simulation
    model = rumoca.Session().load(str(path), model=f"{path.stem}.System")
    config = rumoca.SimConfig(solver="rk-like", rtol=1e-10, atol=1e-11)
    result = model.simulate((0, float(run.time[-1])), dt=float(run.time[1]), config=config)
    values = result.to_dict()
    values = values.get("data", values)
    labels = [re.sub(r"\W+", "_", f"body_{name}") for name in run.body_names]
    # At the knots of a table there are several outputs: the last is the one after it.
    times = np.asarray(result.time)
    picked = [np.flatnonzero(np.isclose(times, t, rtol=0.0, atol=1e-9))[-1] for t in run.time]

    def vectors(what, size):
        return np.array(
            [[np.asarray(values[f"{b}.frame.{what}[{k}]"])[picked] for k in range(1, size + 1)] for b in labels]
        ).transpose(2, 0, 1)

    return vectors("at.p", 3), vectors("on.q", 4)


def controlled_by_voltage():
    """The port model of `motorised` with a controller of the motor's voltage instead of a source."""
    model = model_of(known("motorised"))
    (source,) = (c for c in model.system.components if isinstance(c, VoltageSource))
    ((motor, _),) = model.system.at(source.name, "terminals")
    pid = VoltageController(source.name, source.subject, Constant(0.4), Controller(30.0, ki=5.0, kd=1.0, limit=8.0))
    shaft = model.system.node(motor.name, "shaft")
    nodes = [Node((*n.ports, (pid.name, "shaft")), n.size) if n is shaft else n for n in model.system.nodes]
    components = tuple(pid if c is source else c for c in model.system.components)
    return replace(model, system=System(components, tuple(nodes)), simulation=None)


def order(files):
    """The names of the files as the system's header lists them."""
    (listed,) = {
        found[1] for data in files.values() if (found := re.search(r"in this order: (.*)", data.decode())) is not None
    }
    names = listed.split(", ")
    assert names == sorted(files)
    return names


def opened(made):
    """(entities, flat system, name of the top entity) of an export, with the starts of its bench."""
    names = order(made.files)
    entities, functions = read([made.files[name].decode() for name in names])
    bench = entities[names[3].removeprefix("4_").removesuffix(".vhd")]
    ((_, top, starts, _),) = bench.parts
    return entities, Flat(entities, functions, top, starts), top


def analysed(made, folder):
    """GHDL's verdict on the files of an export."""
    for name, data in made.files.items():
        (folder / name).write_bytes(data)
    command = [ghdl(), "-s", "--std=93", "--ams", *order(made.files)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=60)


VALIDATE = (
    "const v=require('gltf-validator'),fs=require('fs');"
    "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))"
    ".then(r=>{console.log(JSON.stringify(r.issues))},e=>{console.error(e);process.exit(3)});"
)


def judged(data, folder):
    """Issues by the Khronos validator; skips without it."""
    node, place = program("node"), npm("gltf-validator").parent
    (folder / "x.glb").write_bytes(data)
    ran = subprocess.run(
        [node, "-e", VALIDATE, str(folder / "x.glb")], capture_output=True, text=True, check=True,
        env={**os.environ, "NODE_PATH": str(place)},
    )  # fmt: skip
    return json.loads(ran.stdout)
