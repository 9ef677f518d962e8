"""Port models written by hand: the benchmark mechanisms of the multibody literature."""

from __future__ import annotations

import numpy as np

from kinform.behaviour import (
    Constant,
    EffortDrive,
    Ground,
    JointComponent,
    MotionDrive,
    Node,
    RigidBody,
    Sine,
    SpringDamper,
    System,
)
from kinform.behaviour.joints import KINDS, JointGeometry

Z = (0.0, 0.0, 1.0)
DOWN = np.array([0.0, -9.81, 0.0])


class Model:
    """Bodies and joints as they are added; `system()` joins their ports."""

    def __init__(self):
        self.components, self.meetings = [Ground("body base", "base")], {"body base": [("body base", "frame")]}
        self.sizes = {"body base": 6}

    def add(self, component, **nodes):
        """A component, and the node that each of its ports is in."""
        self.components.append(component)
        for port in component.ports:
            self.meetings.setdefault(nodes[port.name], []).append((component.name, port.name))
            self.sizes[nodes[port.name]] = port.size

    def body(self, name, mass, com, inertia):
        tensor = np.asarray(inertia, float)
        tensor = np.diag(tensor) if tensor.ndim == 1 else tensor
        self.add(RigidBody(f"body {name}", name, mass, np.asarray(com, float), tensor), frame=f"body {name}")

    def rod(self, name, start, end, mass=1.0):
        """A thin uniform rod."""
        along = np.subtract(end, start, dtype=float)
        length = np.linalg.norm(along)
        tensor = mass * length**2 / 12.0 * (np.eye(3) - np.outer(along, along) / length**2)
        self.body(name, mass, 0.5 * np.add(start, end), tensor)

    def joint(self, name, a, b, kind="revolute", axis=Z, point=(0, 0, 0), **more):
        geometry = JointGeometry(np.asarray(axis, float), np.asarray(point, float), **more)
        self.add(JointComponent(name, name, KINDS[kind], geometry), a=f"body {a}", b=f"body {b}", shaft=f"shaft {name}")

    def on(self, joint, component, **more):
        """A component on the shaft of a joint."""
        self.add(component, shaft=f"shaft {joint}", **more)

    def system(self):
        nodes = tuple(Node(tuple(ports), self.sizes[key]) for key, ports in self.meetings.items())
        return System(tuple(self.components), nodes)


def pendulum():
    """A01: a point mass of 1 kg on a bar of 1 m without mass, horizontal."""
    model = Model()
    model.body("bob", 1.0, (-1, 0, 0), (0, 0, 0))
    model.joint("hinge", "base", "bob")
    return model


def four_bars(count, off=lambda: np.zeros(3)):
    """A02: vertical rods at x = 0, 1, …, joined by couplers at y = 1; hinges are off by what `off` gives (3,)."""
    model = Model()
    for k in range(count + 1):
        model.rod(f"r{k}", (k, 0, 0), (k, 1, 0))
        model.joint(f"foot {k}", "base", f"r{k}", point=(k, 0, 0) + off())
    for k in range(count):
        model.rod(f"s{k}", (k, 1, 0), (k + 1, 1, 0))
        model.joint(f"left {k}", f"r{k}", f"s{k}", point=(k, 1, 0) + off())
        model.joint(f"right {k}", f"s{k}", f"r{k + 1}", point=(k + 1, 1, 0) + off())
    return model


def bricard():
    """A04: five rods along the edges of a cube, six hinges that Grübler leaves no freedom."""
    points = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1.0)])
    axes = np.eye(3)[[1, 2, 0, 1, 2, 0]]
    model, names = Model(), ["base", "r0", "r1", "r2", "r3", "r4", "base"]
    for k in range(5):
        along = points[k + 1] - points[k]
        share = np.outer(along, along)
        model.body(names[k + 1], 1.0, points[k : k + 2].mean(axis=0), share / 600 + (np.eye(3) - share) * 1.01 / 12)
    for k in range(6):
        model.joint(f"hinge {k}", names[k], names[k + 1], axis=axes[k], point=points[k])
    return model


SQUEEZER = np.array([
    -0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885,
    0.487364979543842550, -0.222668390165885885, 1.230547444549821192,
])  # fmt: skip
"""q(0) = (β, Θ, γ, Φ, δ, Ω, ε) of A03."""


def squeezer():
    """A03: Andrews' squeezing mechanism at q(0), as in the IVP test set; without its spring and drive.

    Returns the model and the points C (on the ground) and D (on K3) of the spring.
    """
    m = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
    inertia = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
    d, da, e, ea, rr, ra = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092
    sa, sb, sc, sd, ta, tb = 0.01874, 0.01043, 0.018, 0.02, 0.02308, 0.00916
    u, ua, ub, zf, zt, fa = 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
    beta, theta, gamma, phi, delta, omega, eps = SQUEEZER

    def at(x, y):
        return np.array([x, y, 0.0])

    def turned(angle, x, y):
        c, s = np.cos(angle), np.sin(angle)
        return at(c * x - s * y, s * x + c * y)

    origin, A, B = at(0, 0), at(xa, ya), at(xb, yb)
    F = turned(beta, rr, 0)
    E = F - turned(beta + theta, d, 0)
    G = A + turned(delta, zt, 0)
    H = A + turned(eps, 0, -u)
    centres = [
        turned(beta, ra, 0), F - turned(beta + theta, da, 0), B + turned(gamma, sa, sb),
        A + turned(delta, zt, 0) + turned(phi + delta, 0, ea - e), A + turned(delta, ta, -tb),
        A + turned(eps, 0, -u) + turned(omega + eps, zf - fa, 0), A + turned(eps, ub, -ua),
    ]  # fmt: skip
    model = Model()
    for k in range(7):
        model.body(f"K{k + 1}", m[k], centres[k], (0, 0, inertia[k]))
    joints = [
        ("O", "base", "K1", origin), ("F", "K1", "K2", F), ("B", "base", "K3", B), ("G", "K5", "K4", G),
        ("A5", "base", "K5", A), ("H", "K7", "K6", H), ("A7", "base", "K7", A),
        ("E3", "K2", "K3", E), ("E4", "K2", "K4", E), ("E6", "K2", "K6", E),
    ]  # fmt: skip
    for name, a, b, point in joints:
        model.joint(name, a, b, point=point)
    return model, at(xc, yc), B + turned(gamma, sd, -sc)


def governor():
    """A05: a stiff flyball governor; the rods stand 30° below the horizontal, springs on their middles."""
    from kinform.behaviour import SpringDamper

    model, density = Model(), 3000.0
    weight = density * 1.0 * 0.01**2
    box = np.array([0.01**2 + 1.0, 2 * 0.01**2, 0.01**2 + 1.0]) / 12.0
    model.body("shaft", weight, (0, 0.5, 0), weight * box)
    cube = density * 0.1**3
    model.body("slider", cube, (0, 0.5, 0), cube * np.full(3, 2 * 0.1**2 / 12.0))
    model.joint("spin", "base", "shaft", axis=(0, 1, 0))
    model.joint("slide", "shaft", "slider", "prismatic", axis=(0, 1, 0))
    for k, side in enumerate((1.0, -1.0)):
        along = np.array([side * np.cos(np.pi / 6), -np.sin(np.pi / 6), 0.0])
        top = np.array([0.0, 1.0, 0.0])
        tensor = weight * ((1.0 + 0.01**2) / 12 * np.eye(3) - (1.0 - 0.01**2) / 12 * np.outer(along, along))
        # The rod and the ball of 5 kg at its end as one body.
        total, arms = weight + 5.0, {weight: 0.5 * along, 5.0: along}
        com = sum(m * arm for m, arm in arms.items()) / total
        for m, arm in arms.items():
            off = arm - com
            tensor = tensor + m * (off @ off * np.eye(3) - np.outer(off, off))
        model.body(f"arm {k}", total, top + com, tensor)
        model.joint(f"hinge {k}", "shaft", f"arm {k}", point=top)
        spring = SpringDamper(f"spring {k}", f"spring {k}", (0, 0.5, 0) + 0 * along, top + 0.5 * along, 8e5, 4e4, 0.5)
        model.add(spring, a="body slider", b=f"body arm {k}")
    return model


def chain(links, held=False):
    """Rods of 1 m hinged in a row: horizontal and hanging by one end, or held at both along a half circle."""
    angle = np.linspace(np.pi, 2 * np.pi, links + 1)
    half = links / np.pi * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = half if held else np.outer(np.arange(links + 1), (1.0, 0, 0))
    model = Model()
    for k in range(links):
        model.rod(f"r{k}", points[k], points[k + 1])
        model.joint(f"j{k}", "base" if k == 0 else f"r{k - 1}", f"r{k}", point=points[k])
    if held:
        model.joint("end", f"r{links - 1}", "base", point=points[links])
    return model


def hung_chain(law=None):
    """A ball, a slide and hinges in a row, a motion drive in the middle and a loop at the end."""
    model = Model()
    model.rod("a", (0, 0, 0), (1, 0, 0))
    model.rod("b", (1, 0, 0), (2, 0.3, 0.1))
    model.rod("c", (2, 0.3, 0.1), (3, 0, 0.4))
    model.rod("d", (3, 0, 0.4), (3, 1, 0.9))
    model.joint("ball", "base", "a", kind="spherical")
    model.joint("slide", "a", "b", kind="prismatic", axis=(1, 0, 0), point=(1, 0, 0))
    model.joint("led", "b", "c", point=(2, 0.3, 0.1))
    model.joint("knee", "c", "d", axis=(0, 1, 0), point=(3, 0, 0.4))
    model.joint("held", "base", "d", kind="spherical", point=(3, 1, 0.9))
    model.on("led", MotionDrive("m", "m", Sine(0.0, 0.1, 2.0, 0.0)))
    model.on("slide", EffortDrive("e", "e", law or Constant(2.0)))
    model.add(SpringDamper("s", "s", (0, 0.5, 0), (2, 0.3, 0.1), 30.0, 2.0, 0.5), a="body base", b="body b")
    return model
