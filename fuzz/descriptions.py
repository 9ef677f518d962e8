"""Seeds of descriptions of robots and of manifests, and the files that they name."""

from __future__ import annotations

URDF = """<?xml version="1.0"?>
<robot name="r">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base">
    <inertial><origin xyz="0 0 0.1"/><mass value="2.5"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0" rpy="0 0 1.57"/><geometry><mesh filename="a.stl" scale="0.001 0.001 0.001"/></geometry>
      <material name="grey"/></visual>
    <collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>
  </link>
  <link name="arm"><visual><geometry><cylinder radius="0.02" length="0.3"/></geometry></visual></link>
  <link name="tip"><visual><geometry><sphere radius="0.01"/></geometry></visual></link>
  <joint name="j1" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="2"/><dynamics damping="0.1" friction="0.0"/></joint>
  <joint name="j2" type="prismatic"><parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.1" effort="10" velocity="2"/><mimic joint="j1" multiplier="0.5" offset="0"/></joint>
</robot>
"""
MJCF = """<mujoco model="m">
  <compiler angle="degree" eulerseq="xyz" autolimits="true"/>
  <default><geom rgba="1 0 0 1"/><default class="c"><joint damping="0.5" range="-90 90"/></default></default>
  <asset><mesh name="a" file="a.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base" pos="0 0 0.1"><geom type="mesh" mesh="a"/>
      <body name="arm" pos="0 0 0.3" euler="0 90 0" childclass="c">
        <joint name="h" type="hinge" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.02"/>
        <frame pos="0 0 0.1"><body name="tip"><joint name="s" type="slide" axis="1 0 0"/>
          <inertial pos="0 0 0" mass="0.1" diaginertia="0.001 0.001 0.001"/><geom type="box" size="0.01 0.02 0.03"/>
        </body></frame>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="s" joint2="h" polycoef="0 0.5 0 0 0"/>
    <connect body1="tip" body2="base" anchor="0 0 0"/></equality>
  <actuator><position joint="h" kp="10" forcerange="-5 5"/></actuator>
</mujoco>
"""
XACRO = """<?xml version="1.0"?>
<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="size" value="0.1"/>
  <xacro:arg name="count" default="2"/>
  <xacro:macro name="part" params="name length:=1 *block">
    <link name="${name}"><visual><geometry><box size="${size*2} ${size} ${length/2+0.1}"/></geometry></visual></link>
    <xacro:insert_block name="block"/>
  </xacro:macro>
  <xacro:part name="one" length="3"><link name="two"/></xacro:part>
  <xacro:if value="${size > 0}">
    <joint name="j" type="continuous"><parent link="one"/><child link="two"/></joint></xacro:if>
</robot>
"""


SDF = """<?xml version="1.0"?>
<sdf version="1.9"><model name="r" placement_frame="f"><pose degrees="true">1 2 3 10 20 30</pose>
  <link name="a"><inertial><pose>0 0 1 0 0 0</pose><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>
    </inertial><visual name="v"><geometry><mesh><uri>a.stl</uri><scale>0.001 0.001 -0.001</scale></mesh></geometry>
    </visual><collision name="c"><geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry>
    </collision></link>
  <frame name="f" attached_to="a"><pose rotation_format="quat_xyzw">0 0 1 0 0 0 1</pose></frame>
  <model name="n"><pose relative_to="f">0 0 1 0 0 0</pose><link name="b"><visual name="v"><geometry>
    <box><size>1 2 3</size></box></geometry></visual></link><link name="c"/>
    <joint name="s" type="screw"><parent>b</parent><child>c</child><axis><xyz>0 0 1</xyz></axis>
      <screw_thread_pitch>0.01</screw_thread_pitch></joint></model>
  <joint name="j" type="revolute"><parent>a</parent><child>n::b</child><pose relative_to="n">0 0 0 0 0 0</pose>
    <axis><xyz expressed_in="f">0 1 0</xyz><limit><lower>-1e16</lower><upper>1</upper><effort>5</effort></limit>
    <dynamics><damping>1</damping><spring_stiffness>2</spring_stiffness></dynamics></axis></joint>
</model></sdf>
"""


REPLICAS = """<mujoco><worldbody><body name="a"><geom size="0.1"/>
<replicate count="3" offset="0.1 0 0" euler="0 0 30" sep="-"><body name="b"><joint name="j"/><geom size="0.1"/>
<replicate count="2" offset="0 1 0"><geom name="g" type="box" size="1 1 1"/></replicate></body></replicate>
</body></worldbody></mujoco>
"""


ATTACH = """<mujoco model="top"><compiler angle="radian"/>
<asset><model name="m" file="hand.xml"/></asset>
<worldbody><body name="base"><geom size="0.1"/>
<frame pos="0 0 1"><attach model="m" body="palm" prefix="l_"/></frame>
<replicate count="2" offset="1 0 0"><attach model="m" prefix="r_"/></replicate></body></worldbody>
<equality><joint joint1="l_bend"/></equality></mujoco>
"""
HAND = """<mujoco model="hand"><compiler angle="degree"/><worldbody><geom size="0.2"/><body name="palm" pos="0 0 0.2">
<joint name="bend" range="-40 50"/><geom type="box" size="0.1 0.2 0.3"/><body name="tip"><geom size="0.1"/></body>
</body>
</worldbody></mujoco>
"""
"""The model that `ATTACH` names."""


URDF_JOINTS = """<robot name="all">
  <link name="a"><visual name="v"><origin quat_xyzw="0 0 0 1"/><geometry><mesh filename="package://design/a.stl"/>
  </geometry>
    <material name="m"><color rgba="1 0 0 1"/></material></visual>
    <visual><geometry><capsule radius="0.1" length="0.2"/></geometry></visual>
    <collision name="c"><geometry><mesh filename="a.stl"/></geometry></collision></link>
  <link name="b"/><link name="c"/><link name="d"/><link name="e"/><link name="f"/><link name="g"/>
  <joint name="j1" type="floating"><parent link="a"/><child link="b"/></joint>
  <joint name="j2" type="planar"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/></joint>
  <joint name="j3" type="universal"><parent link="c"/><child link="d"/></joint>
  <joint name="j4" type="ball"><parent link="c"/><child link="e"/></joint>
  <joint name="j5" type="screw"><parent link="c"/><child link="f"/><axis xyz="0 0 1"/>
  <drake:screw_thread_pitch xmlns:drake="d" value="0.01"/>
    </joint>
  <joint name="j6" type="fixed"><parent link="f"/><child link="g"/><origin xyz="1 2 3" rpy="0.1 0.2 0.3"/></joint>
  <transmission name="t"><joint name="j5"/><actuator name="m"/></transmission><gazebo reference="b"/>
</robot>
"""
SDF_WORLD = """<sdf version="1.4"><world name="w"><frame name="o"><pose>1 0 0 0 0 0</pose></frame>
  <include><uri>model://hand</uri><name>h</name><pose relative_to="o">0 0 1 0 0 0</pose></include>
  <model name="m" canonical_link="a"><static>false</static><link name="a"/>
    <include merge="true"><uri>model://hand</uri><name>k</name><pose>1 0 0 0 0 0</pose></include></model>
  <joint name="q" type="fixed"><parent>m::a</parent><child>h::palm</child></joint></world></sdf>
"""
SDF_SHAPES = """<sdf version="1.7"><model name="m">
    <link name="a"><visual name="v"><geometry><capsule><radius>1</radius><length>2</length></capsule></geometry>
      <material><diffuse>1 0 0 1</diffuse></material></visual>
      <visual name="e"><geometry><ellipsoid><radii>1 2 3</radii></ellipsoid></geometry></visual>
      <collision name="p"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link>
    <link name="b"><inertial auto="true"/><collision name="s"><geometry><sphere><radius>1</radius></sphere></geometry>
  </collision>
      <collision name="n"><geometry><cone><radius>1</radius><length>2</length></cone></geometry></collision></link>
    <joint name="j" type="continuous"><parent>world</parent><child>a</child><axis><xyz>1 0 0</xyz></axis></joint>
</model></sdf>
"""
SDF_JOINTS = """<sdf version="1.4"><model name="m">
    <link name="a"/><link name="b"/><link name="c"/><link name="d"/>
    <joint name="j1" type="universal"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis><axis2>
  <xyz>0 1 0</xyz></axis2>
      </joint>
    <joint name="j2" type="ball"><parent>b</parent><child>c</child></joint>
    <joint name="j3" type="gearbox"><parent>c</parent><child>d</child><axis><xyz>1 0 0</xyz></axis>
  <gearbox_ratio>2</gearbox_ratio>
      <gearbox_reference_body>a</gearbox_reference_body></joint>
</model></sdf>
"""
SDF_MIMIC = """<sdf version="1.4"><model name="m"><link name="a"/><link name="b"/><link name="c"/>
    <joint name="j4" type="revolute2"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis><axis2>
  <xyz>0 1 0</xyz></axis2>
      </joint>
    <joint name="j5" type="continuous"><parent>world</parent><child>a</child><axis><xyz>1 0 0</xyz>
      <use_parent_model_frame>true</use_parent_model_frame><mimic joint="j6"><multiplier>2</multiplier>
  <offset>0</offset>
      <reference>0</reference></mimic></axis></joint>
    <joint name="j6" type="prismatic"><parent>a</parent><child>c</child><axis><xyz>0 0 1</xyz><limit><lower>0</lower>
      <upper>1</upper><velocity>2</velocity></limit></axis></joint>
</model></sdf>
"""
HAND_SDF = """<sdf version="1.9"><model name="hand"><link name="palm"/><link name="tip"><pose>0 0 1 0 0 0</pose></link>
<frame name="f" attached_to="tip"/><joint name="j" type="revolute"><parent>palm</parent><child>tip</child>
<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>
"""
HAND_CONFIG = "<model><name>hand</name><sdf version='1.9'>model.sdf</sdf></model>"
MJCF_LOOPS = """<mujoco><worldbody><body name="p"><joint name="j"/><geom size="1"/><site name="s"/>
<body name="q" pos="1 0 0" zaxis="0 1 1"><joint name="k" type="ball" ref="0.1"/>
<joint name="k2" type="slide" axis="1 0 0" stiffness="2" springref="1" damping="1" frictionloss="0.1" armature="0.1"/>
<geom type="ellipsoid" size="1 2 3" axisangle="0 0 1 0.5"/><site name="t" xyaxes="1 0 0 0 1 0"/></body></body>
  </worldbody>
<equality><weld body1="p" body2="q"/><connect site1="s" site2="t"/><connect body1="p" body2="q" anchor="0 0 0"/>
<connect body1="p" body2="q" anchor="0 0 1"/><tendon/></equality>
<actuator><motor joint="j"/><muscle jointinparent="k"/>
  <general joint="k2" forcelimited="true" forcerange="-1 2" gear="2"/>
</actuator></mujoco>
"""
MJCF_CLASSES = """<mujoco>
  <compiler angle="radian" meshdir="." autolimits="false" inertiafromgeom="auto" fitaabb="true"/>
<default><default class="x"><joint axis="0 1 0" limited="true" range="-1 1"/>
<geom type="capsule" size="0.1 0.2" contype="0" conaffinity="0"/><site pos="0 0 1"/><mesh scale="2 2 2"/>
<general gear="2" ctrllimited="true" forcerange="-1 1"/></default></default>
<asset><mesh class="x" file="a.stl"/><material name="m" rgba="1 0 0 1"/></asset>
<worldbody><body name="p" childclass="x"><joint name="j"/><geom material="m"/><geom type="mesh" mesh="a"/></body>
</worldbody><actuator><position joint="j" class="x"/></actuator></mujoco>
"""
MJCF_FITS = """<mujoco model="fits"><option gravity="0 0 -9.81"/>
<asset><mesh name="b" file="a.obj" refpos="1 0 0" refquat="1 0 0 0" inertia="shell"/></asset>
<worldbody><include file="more.xml"/><body name="r" mocap="true"><geom size="0.1" mass="2"/></body>
<body name="u"><freejoint/><geom type="cylinder" mesh="b" fitscale="1.1"/>
<inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0" quat="1 0 0 0"/></body></worldbody>
<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon><contact><exclude body1="p" body2="q"/></contact>
<sensor/><keyframe/></mujoco>
"""
MORE_MJCF = """<mujocoinclude><body name="inc"><geom name="g" type="box" size="1 1 1" euler="10 20 30"/></body>
  </mujocoinclude>"""
XACRO_MORE = """<robot name="more" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="more.xacro"/><xacro:include filename="$(find design)/m*.xacro" ns="n"/>
  <xacro:property name="conf" value="${xacro.load_yaml('values.yaml')}"/>
  <xacro:property name="d" value="${dict(a=1, b=[1, 2, 3])}"/><xacro:property name="late" default="${d['b'][1]}"/>
  <xacro:arg name="side" default="left"/>
  <xacro:macro name="leg" params="prefix:=^|l parent **origin *inside x:=${pi/2} y">
    <xacro:property name="prefix2" value="${prefix}_${y}" scope="parent"/>
    <link name="${prefix}_${y}_link"><xacro:insert_block name="inside"/></link>
    <joint name="${prefix}_${y}_joint" type="revolute"><xacro:insert_block name="origin"/><parent link="${parent}"/>
      <child link="${prefix}_${y}_link"/><axis xyz="0 ${sin(x)} ${1 if y == '1' else -1}"/>
      <limit lower="${-radians(90)}" upper="${max(1, 2**0.5)}" effort="1" velocity="${conf['limits']['v']}"/></joint>
    <xacro:unless value="${int(y) >= 2}"><xacro:tip name="${prefix}_${int(y)+1}" parent="${prefix}_${y}_link"/>
  </xacro:unless>
  </xacro:macro>
  <link name="base"><xacro:attribute name="class" value="$(arg side)"/></link>
  <xacro:leg parent="base" y="1"><origin><origin xyz="1 ${len([i for i in range(3)])} 0"/></origin><collision>
    <geometry><box size="1 1 1"/></geometry></collision></xacro:leg>
  <xacro:element xacro:name="link" name="$(eval 'extra_' + side)"/>
  <joint name="x" type="fixed"><parent link="base"/><child link="extra_left"/></joint>
  <xacro:if value="${'%s' % late == '2' and not False}"><xacro:call macro="tip" name="t" parent="base"/></xacro:if>
</robot>
"""
XACRO_EXPRESSIONS = """<robot name="e" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="a" default="3"/>
<xacro:property name="l" value="${[x*2 for x in range(4) if x % 2]}"/>
  <xacro:property name="s" value="${'a b'.split()}"/>
<xacro:property name="d" value="${dict(k=(1, 2), n=None)}"/><xacro:property name="t" value="${d['k'][-1] // 2}"/>
<link name="${'_'.join(sorted(s))}"><visual><geometry><box size="${l[0]} ${l[0] + l[1]} ${fabs(-t)}"/></geometry>
  </visual></link>
<link name="${'%s%d' % (s[1], len(d))}"/><link name="${'-'.join(['1', '2']).upper()}"/>
<joint name="j" type="fixed"><parent link="a_b"/><child link="b2"/>
<origin xyz="${cos(pi)} ${min(l + [1])} ${0.1 if 'k' in d and not t else round(1.25, 1)}" rpy="0 0 $(eval a ** 2)"/>
  </joint>
<joint name="$(arg a)" type="fixed"><parent link="b2"/><child link="1-2"/>
  <origin xyz="${float('1.5')} 0 0"/>
</joint></robot>
"""
MORE_XACRO = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="w" value="${2*3.0}"/>
<xacro:macro name="tip" params="name parent"><link name="${name}"/><joint name="${name}_j" type="fixed">
  <parent link="${parent}"/>
<child link="${name}"/></joint></xacro:macro></robot>
"""
VALUES_YAML = "r: 0.1\nlimits: {v: 2, e: !degrees 90}\nlist: [1, 2.5, a]\n"

MACHINE = """schema = 1
[assembly]
name = "machine"
units = "mm"
ground = "frame"
[materials.steel]
density = 7850
[[friction]]
materials = ["steel", "steel"]
static = 0.3
coefficient = 0.2
[[part]]
name = "frame"
shape = {type = "box", size = [10, 20, 30]}
material = "steel"
[[part]]
name = "lid"
shape = {type = "capsule", radius = 1, length = 10}
density = 1000
rpy = [0, 0, 30]
[[part]]
name = "pin"
shape = {type = "ellipsoid", radii = [1, 2, 3]}
position = [5, 5, 5]
[[function.joint]]
name = "j"
between = ["frame", "lid"]
type = "cylindrical"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.joint]]
name = "u"
between = ["lid", "pin"]
type = "universal"
axis = [1, 0, 0]
axis2 = [0, 1, 0]
point = [0, 0, 0]
[[function.drive]]
joint = "j"
kind = "servo"
law = {type = "ramp", rate = 2, offset = 1}
freedom = "turn"
kp = 10
kd = 1
[[function.drive]]
joint = "j"
kind = "friction"
freedom = "slide"
coefficient = 0.1
length = 5
[[function.spring]]
between = ["lid", "frame"]
points = [[40, 0, 0], [0, 0, 120]]
stiffness = 850
damping = 3
rest = 90
[[function.gas_spring]]
between = ["frame", "lid"]
points = [[0, 0, -200], [150, 0, 0]]
lengths = [300, 200]
forces = [100, 150]
exponent = 1.2
[[function.bushing]]
between = ["frame", "pin"]
point = [0, 0, 0]
stiffness = [1000, 1000, 1000]
torsion = [0, 4, 0]
torsion_damping = [0, 0.2, 0]
[[function.load]]
part = "lid"
force = [1, 2, 3]
torque = [0, 0, 1]
point = [200, 0, 0]
[[function.coupling]]
joints = ["j", "u"]
ratio = 2
[[simulation.sensor]]
name = "p"
kind = "point"
part = "lid"
point = [1, 2, 3]
frame = "frame"
[[simulation.sensor]]
name = "d"
kind = "distance"
between = ["frame", "lid"]
[[simulation.sensor]]
name = "r"
kind = "reaction"
joint = "j"
[[simulation.sensor]]
name = "a"
kind = "angle"
between = ["frame", "lid"]
axis = [0, 0, 1]
[simulation]
level = "dynamic"
duration = 1
step = 0.01
"""


def urdf() -> list[bytes]:
    """A robot of three links, and one with every type of joint."""
    return [URDF.encode(), URDF_JOINTS.encode()]


def sdf() -> list[bytes]:
    """Models in each other, of other files, with every shape and every type of joint."""
    return [text.encode() for text in (SDF, SDF_WORLD, SDF_SHAPES, SDF_JOINTS, SDF_MIMIC)]


def mjcf() -> list[bytes]:
    """A model of three bodies; with copies; with models that are attached; with loops, classes, fits."""
    return [text.encode() for text in (MJCF, REPLICAS, ATTACH, MJCF_LOOPS, MJCF_CLASSES, MJCF_FITS)]


def xacro() -> list[bytes]:
    """Descriptions with macros, properties and conditions."""
    return [text.encode() for text in (XACRO, XACRO_MORE, XACRO_EXPRESSIONS)]


BESIDE = {
    "hand.xml": HAND,
    "more.xml": MORE_MJCF,
    "more.xacro": MORE_XACRO,
    "values.yaml": VALUES_YAML,
    "hand/model.sdf": HAND_SDF,
    "hand/model.config": HAND_CONFIG,
    "package.xml": "<package><name>design</name></package>",
}
"""Files that the seeds name, by name."""


COLLADA = (
    "instance_geometry", "instance_node", "instance_controller", "library_nodes", "library_controllers",
    "library_geometries",
    "library_visual_scenes", "node", "matrix", "rotate", "translate", "scale", "skew", "lookat", "triangles",
    "polylist",
    "polygons", "lines", "trifans", "tristrips", "vcount", "p", "ph", "input", "accessor", "param", "float_array",
    "Name_array",
    "int_array", "source", "vertices", "mesh", "convex_mesh", "spline", "geometry", "unit", "up_axis", "asset", "scene",
    "instance_visual_scene", "extra", "url", "source", "semantic", "offset", "count", "stride", "set", "id", "sid",
    "name", "meter",
    "material", "symbol", "target", "type", "X_UP", "Y_UP", "Z_UP", "VERTEX", "NORMAL", "TEXCOORD", "POSITION", "COLOR",
)  # fmt: skip
"""Words of COLLADA."""
