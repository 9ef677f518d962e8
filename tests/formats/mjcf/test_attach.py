"""`<attach>` of MJCF: what MuJoCo itself makes of it is what the assembly has; loops and what is not there are told."""

from __future__ import annotations

import numpy as np
import pytest

from kinform import form
from kinform.errors import InputError
from kinform.formats.mjcf.reading import attach

ARM = """<mujoco model="arm own"><compiler angle="degree" eulerseq="zyx"/>
<default><geom type="box" size="0.1 0.2 0.3"/>
<default class="c"><joint axis="0 1 1" range="-40 50"/></default></default>
<asset><model file="hand.xml"/></asset>
<worldbody><geom name="foot" pos="0 0 -0.4"/>
<body name="upper" pos="0 0.3 1" euler="10 20 30" childclass="c"><joint name="turn" pos="0.1 0 0"/><geom name="bar"/>
<inertial mass="2" pos="0.01 0.02 0.03" diaginertia="0.3 0.2 0.4"/>
<body name="lower" pos="0.5 0 0.1" euler="0 40 0"><joint name="a"/><joint name="b" type="slide" axis="1 0 0"/>
<geom/><site name="end" pos="0 0 1"/><frame euler="5 6 7">
<attach model="palm" body="palm" prefix="h_"/></frame>
<frame pos="1 0 0"><frame euler="50 0 9"><body name="tip" pos="0 0 2" euler="3 0 0"><joint name="last" axis="1 2 3"/>
<geom size="1 2 3"/></body></frame></frame></body></body>
</worldbody>
<equality><joint joint1="a" joint2="turn" polycoef="0 -2 0 0 0"/></equality>
<actuator><motor joint="turn" forcerange="-3 3"/></actuator></mujoco>
"""
HAND = """<mujoco model="palm"><compiler angle="radian"/><worldbody><body name="aside"><geom size="1"/>
<body name="palm" pos="0 0 0.2" euler="0.1 0.2 0.3"><joint name="wrist" axis="1 2 0"/><geom size="0.05"/></body></body>
</worldbody></mujoco>
"""
TOP = """<mujoco model="top"><compiler angle="radian"/><asset><model name="arm" file="models/arm.xml"/></asset>
<worldbody><body name="base" pos="0.1 0 0" euler="0 0 0.5"><geom name="hub" size="0.1"/>
{attach}
</body></worldbody>{more}</mujoco>
"""
PLACES = {
    "a body": '<attach model="arm" body="upper" prefix="l_"/>',
    "a body in a body": '<attach model="arm" body="lower" prefix="l_"/>',
    "a body in a frame": '<attach model="arm" body="tip" prefix="l_"/>',
    "all of it, in a frame": '<frame pos="0 1 2" euler="1 0 0"><attach model="arm" prefix="l_"/></frame>',
    "its world": '<attach model="arm" body="world" prefix="l_"/>',
    "twice": '<attach model="arm" body="upper" prefix="l_"/><attach model="arm" body="upper" prefix="r_"/>',
    "replicated": '<replicate count="3" offset="0 1 0" euler="0 0 0.4" sep="-"><attach model="arm" body="upper" '
    'prefix="l_"/></replicate>',
}


def write(folder, attach, more="", arm=ARM, hand=HAND):
    (folder / "models").mkdir(exist_ok=True)
    (folder / "models" / "arm.xml").write_text(arm)
    (folder / "models" / "hand.xml").write_text(hand)
    path = folder / "top.xml"
    path.write_text(TOP.format(attach=attach, more=more))
    return path


@pytest.mark.parametrize("place", PLACES)
def test_bodies_joints_and_masses_are_those_of_mujoco(tmp_path, place):
    mujoco = pytest.importorskip("mujoco")
    path = write(tmp_path, PLACES[place])
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assembly = form.load(path)
    joints = {j.name: j for j in assembly.function.joints if j.type != "fixed"}
    names = {kind: [mujoco.mj_id2name(model, kind, k) for k in range(count)] for kind, count in (
        (mujoco.mjtObj.mjOBJ_JOINT, model.njnt), (mujoco.mjtObj.mjOBJ_BODY, model.nbody))}  # fmt: skip
    assert sorted(joints) == sorted(names[mujoco.mjtObj.mjOBJ_JOINT])
    for k, name in enumerate(names[mujoco.mjtObj.mjOBJ_JOINT]):
        assert np.allclose(joints[name].axis, data.xaxis[k], atol=1e-12)
        assert joints[name].point is None or np.allclose(joints[name].point, data.xanchor[k], atol=1e-12)
        assert (joints[name].range is None) == (not model.jnt_limited[k])
        scale = 1.0 if joints[name].type == "revolute" else np.pi / 180.0
        if model.jnt_limited[k]:
            assert np.allclose(np.array(joints[name].range), model.jnt_range[k], atol=1e-12 * scale)
    links = {link.name for description in assembly.descriptions for link in description.links}
    assert set(names[mujoco.mjtObj.mjOBJ_BODY][1:]) <= links | {"l_world"}
    own = {g.name: g.override for g in assembly.groups if g.override is not None}
    assert set(own) == {name for name in links if name.endswith("upper") or "upper-" in name}
    for name, stated in own.items():
        k = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        assert np.allclose(stated.centre_of_mass, data.xpos[k] + data.xmat[k].reshape(3, 3) @ model.body_ipos[k])
    assert len(assembly.function.couplings) == model.neq
    assert sum(part.mesh is not None for part in assembly.parts) == model.ngeom


def test_the_description_around_it_names_what_is_attached(tmp_path):
    more = '<equality><joint joint1="l_turn" joint2="l_a" polycoef="0 3 0 0 0"/></equality>'
    function = form.load(write(tmp_path, PLACES["a body"], more)).function
    assert sorted(c.joints for c in function.couplings) == [("l_a", "l_turn"), ("l_turn", "l_a")]
    assert [(r.name, r.values["limit"]) for r in function.requirements] == [("effort of l_turn", 3.0)]


BAD = {
    "no model": (PLACES["a body"].replace('model="arm"', 'model="amr"'), {}, "top.xml", 3),
    "no body": (PLACES["a body"].replace('"upper"', '"uper"'), {}, "top.xml", 3),
    "no prefix": (PLACES["a body"].replace('prefix="l_"', ""), {}, "top.xml", 3),
    "the same twice": (PLACES["twice"].replace("r_", "l_"), {}, "top.xml", 3),
    "a frame": (PLACES["a body"].replace("body=", "frame="), {}, "top.xml", 3),
    "no file": (PLACES["a body"], {"arm": ARM.replace("hand.xml", "none.xml")}, "models/arm.xml", 4),
    "outside": (PLACES["a body"], {"arm": ARM.replace("hand.xml", "/etc/hostname")}, "models/arm.xml", 4),
    "itself": (PLACES["a body"], {"arm": ARM.replace("hand.xml", "arm.xml")}, "models/arm.xml", 4),
    "a circle": (
        PLACES["a body"],
        {"hand": HAND.replace("<worldbody>", '<asset><model file="arm.xml"/></asset><worldbody>')},
        "models/hand.xml", 1,
    ),
    "no number": (PLACES["a body"], {"hand": HAND.replace('size="1"', 'size="nan"')}, "models/hand.xml", 1),
    "not XML": (PLACES["a body"], {"hand": "<mujoco>"}, "models/hand.xml", 1),
    "another root": (PLACES["a body"], {"hand": "<robot/>"}, "models/hand.xml", 1),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_is_told_with_file_line_and_remedy(tmp_path, case):
    attach, texts, file, line = BAD[case]
    with pytest.raises(InputError) as caught:
        form.load(write(tmp_path, attach, **texts))
    problem = caught.value.problems[0]
    assert problem.remedy
    assert (problem.file, problem.line) == (file, line)


def test_models_that_double_again_and_again_end_at_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(attach, "COPIES_MOST", 500)
    twice = '<attach model="m" body="q" prefix="{}"/>'
    for k in range(12):
        inner = f'<asset><model name="m" file="m{k + 1}.xml"/></asset>' if k < 11 else ""
        both = "".join(map(twice.format, "ab")) if k < 11 else ""
        text = f'<mujoco>{inner}<worldbody><body name="q"><geom size="1"/>{both}</body></worldbody></mujoco>'
        (tmp_path / f"m{k}.xml").write_text(text)
    with pytest.raises(InputError):
        form.load(tmp_path / "m0.xml")


def test_a_chain_of_models_ends_at_a_depth(tmp_path):
    for k in range(30):
        inner = f'<asset><model name="m" file="m{k + 1}.xml"/></asset>'
        text = f'<mujoco>{inner}<worldbody><body name="q"><attach model="m" prefix="a"/></body></worldbody></mujoco>'
        (tmp_path / f"m{k}.xml").write_text(text)
    with pytest.raises(InputError):
        form.load(tmp_path / "m0.xml")
