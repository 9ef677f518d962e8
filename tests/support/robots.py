"""Robot descriptions written by tests."""

from __future__ import annotations

from pathlib import Path

BASE = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="0" iyz="0"/></inertial>'
    '<visual><geometry><mesh filename="package://arm/base.obj" scale="0.001 0.001 0.001"/></geometry></visual>'
)
ARM = (
    '<visual name="shaft"><geometry><cylinder radius="0.01" length="0.06"/></geometry></visual>'
    '<collision><geometry><box size="0.02 0.02 0.06"/></geometry></collision>'
)
JOINT = (
    '<parent link="base"/><child link="arm"/><origin xyz="0 0 0.03" rpy="0 0 0.5"/><axis xyz="0 0 2"/>'
    '<limit lower="-1" upper="2" effort="3" velocity="4"/><dynamics damping="0.25" friction="0.1"/>'
)
TOOL = '<joint name="tip" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0 0 0.05"/></joint>'


def urdf(base: str = BASE, arm: str = ARM, joint: str = JOINT, kind: str = "revolute", more: str = "") -> str:
    """A base, an arm that turns in it, and an empty link; one element a line."""
    return (
        '<robot name="arm">\n'
        f'<link name="base">{base}</link>\n'
        f'<link name="arm">{arm}</link>\n'
        '<link name="tool"/>\n'
        f'<joint name="turn" type="{kind}">{joint}</joint>\n'
        f"{TOOL}\n{more}\n"
        '<transmission name="t"/>\n'
        "</robot>\n"
    )


def ring(inner: float, outer: float, height: float, sides: int = 96) -> str:
    """An OBJ of a ring about z, from 0 to `height`."""
    import math

    lines, n = [], sides
    for z in (0.0, height):
        for r in (inner, outer):
            for k in range(n):
                a = 2.0 * math.pi * k / n
                lines.append(f"v {r * math.cos(a):.12g} {r * math.sin(a):.12g} {z:.12g}")
    for k in range(n):
        j = (k + 1) % n
        i0, o0, i1, o1 = 1, 1 + n, 1 + 2 * n, 1 + 3 * n
        for a, b, c, d in (
            (o0 + k, o0 + j, o1 + j, o1 + k),
            (i0 + j, i0 + k, i1 + k, i1 + j),
            (i0 + k, i0 + j, o0 + j, o0 + k),
            (i1 + j, i1 + k, o1 + k, o1 + j),
        ):
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return "\n".join(lines) + "\n"


def write(folder: Path, text: str, name: str = "arm.urdf") -> Path:
    """The description in a package `arm` below the folder, with the mesh of its base; its path."""
    package = folder / "arm"
    (package / "urdf").mkdir(parents=True, exist_ok=True)
    (package / "package.xml").write_text("<package><name>arm</name></package>")
    (package / "base.obj").write_text(ring(10.0, 30.0, 60.0))
    path = package / "urdf" / name
    path.write_text(text)
    return path


LIMITED = """<robot name="arm">
<link name="base"><visual><geometry><box size="0.1 0.12 0.14"/></geometry></visual></link>
<link name="upper"><visual><origin xyz="0 0 0.25" rpy="0.1 0.2 0.3"/><geometry><box size="0.05 0.04 0.3"/></geometry>
</visual></link>
<link name="slider"><visual><origin xyz="0 0.3 0.1"/><geometry><cylinder radius="0.02" length="0.2"/></geometry>
</visual></link>
<link name="wheel"><visual><origin xyz="0 0 0.4"/><geometry><sphere radius="0.03"/></geometry></visual></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.06" rpy="0.3 0 0.5"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1.5" effort="12" velocity="3"/></joint>
<joint name="lift" type="prismatic"><parent link="upper"/><child link="slider"/><origin xyz="0 0 0.3"/>
<axis xyz="0 0 1"/><limit lower="0" upper="0.2" effort="50" velocity="0.4"/></joint>
<joint name="spin" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
</robot>"""
"""Parts that are turned in their links, and limits of all kinds."""
