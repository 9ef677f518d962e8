"""Work and precision of the dynamic solver beside MuJoCo, in one run: python benchmarks/dynamics.py

Prints, for each mechanism and tolerance, milliseconds of solver a simulated second and the error of a
point at the end against a run at a tight tolerance; for MuJoCo (when it is installed) the same by step.
Both are processor time and exclude loading, compilation and results. Then, for each mechanism, how many
times faster kinform is at equal error than the best of MuJoCo's settings: at the errors that these reach,
the time of the cheapest of kinform's runs that errs no more.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "pipeline"), str(ROOT / "tests")]

from support.port_models import DOWN, Model, bricard, four_bars  # noqa: E402

from kinform.behaviour import RigidBody  # noqa: E402
from kinform.foundation.algebra.spatial import to_matrix  # noqa: E402
from kinform.simulation import Course, SolverSettings, simulate_system  # noqa: E402
from kinform.simulation.kernel.calls import engine  # noqa: E402
from kinform.simulation.solver.run_state import Run  # noqa: E402

REPEATS = 5
TOLERANCES = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 1e-9, 1e-10)


def double_pendulum():
    """Two rods hanging in a row from the ground, horizontal at the start."""
    model = Model()
    for k in range(2):
        model.rod(f"r{k}", (k, 0, 0), (k + 1, 0, 0))
        model.joint(f"j{k}", "base" if k == 0 else "r0", f"r{k}", point=(k, 0, 0))
    return model


def gimbal():
    """A ring about z and a payload about x in it, off balance."""
    model = Model()
    model.body("ring", 0.5, (0, 0, 0), (0.02, 0.03, 0.025))
    model.body("inner", 1.0, (0.0, 0.05, -0.1), [[0.012, 0.001, 0], [0.001, 0.02, 0.002], [0, 0.002, 0.017]])
    model.joint("pan", "base", "ring")
    model.joint("tilt", "ring", "inner", axis=(1, 0, 0))
    return model


FALLING, STANDING = np.array([0.0, 0.0, -9.81]), DOWN
CASES = {
    "double pendulum": (double_pendulum, STANDING, {}, ("r1", (2.0, 0, 0)), 5.0),
    "gimbal": (gimbal, FALLING, {"pan": (0.0, 3.0), "tilt": (0.0, 1.0)}, ("inner", (0.0, 0.05, -0.1)), 10.0),
    "Bricard": (bricard, STANDING, {}, ("r2", (1.0, -1, 1)), 10.0),
    "four-bar 2": (lambda: four_bars(2), STANDING, {"foot 0": (0.0, -1.0)}, ("r0", (0, 1.0, 0)), 10.0),
    "four-bar 10": (lambda: four_bars(10), STANDING, {"foot 0": (0.0, -1.0)}, ("r0", (0, 1.0, 0)), 10.0),
}


def timed(model, gravity, initial, tracked, duration, rtol):
    """(best milliseconds a simulated second, place of the tracked point at the end)."""
    best, name, point = np.inf, *tracked
    advance = Run.advance
    for _ in range(REPEATS):
        spent = [0.0]

        def measured(run, spent=spent):
            start = time.process_time()
            status = advance(run)
            spent[0] += time.process_time() - start
            return status

        Run.advance = measured
        settings = SolverSettings(rtol=rtol, atol=rtol * 1e-2)
        run = simulate_system(model, Course(duration, duration, gravity), initial=initial, settings=settings)
        Run.advance = advance
        if run.status != "done":
            return np.nan, np.full(3, np.nan)
        best = min(best, spent[0] / duration * 1e3)
    b = run.body_names.index(name)
    return best, run.p_WB[-1, b] + to_matrix(run.q_WB[-1, b]) @ point


def mujoco_model(system, gravity, integrator, step):
    """The same system as MJCF: a tree of hinges, loops closed by `connect` constraints at two points."""
    import mujoco

    bodies = {b.name: b for b in system.bodies if isinstance(b, RigidBody)}
    parent, children, closing, free = {}, {}, [], set(bodies)
    joints, changed = list(system.joints), True
    while changed:
        changed = False
        for joint in list(joints):
            a, b = (system.body_at(joint.name, port).name for port in ("a", "b"))
            for near, far, sign in ((a, b, 1.0), (b, a, -1.0)):
                if far in free and near not in free:
                    free.discard(far)
                    parent[far] = (near, joint, sign)
                    children.setdefault(near, []).append(far)
                    joints.remove(joint)
                    changed = True
                    break
            if changed:
                break
    closing = joints

    def numbers(values):
        return " ".join(f"{v:.17g}" for v in values)

    def xml(name):
        out = ""
        for far in children.get(name, []):
            _, joint, sign = parent[far]
            body, tensor = bodies[far], bodies[far].inertia
            full = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
            # MuJoCo wants positive moments, also about the line of a thin rod.
            full = tuple(v + (1e-13 if k < 3 else 0.0) for k, v in enumerate(full))
            axis = numbers(sign * joint.geometry.axis)
            out += f'<body name="{far}"><joint type="hinge" name="{joint.name}" axis="{axis}"'
            out += f' pos="{numbers(joint.geometry.point)}"/><inertial pos="{numbers(body.centre_of_mass)}"'
            out += f' mass="{body.mass}" fullinertia="{numbers(full)}"/>{xml(far)}</body>'
        return out

    equality = ""
    for joint in closing:
        a, b = (system.body_at(joint.name, port).name for port in ("a", "b"))
        held = [name for name in (a, b) if name in bodies]
        ends = " ".join(f'body{k}="{name}"' for k, name in enumerate(held, start=1))
        for shift in (0.0, 1.0):
            point = joint.geometry.point + shift * joint.geometry.axis
            stiffness = f'solref="{max(2 * step, 1e-4):.6g} 1" solimp="0.9999 0.9999 0.001 0.5 2"'
            equality += f'<connect {ends} anchor="{numbers(point)}" {stiffness}/>'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian" balanceinertia="false" boundmass="0" boundinertia="0"/>'
        f'<option timestep="{step}" gravity="{numbers(gravity)}" integrator="{integrator}" '
        'tolerance="1e-12" iterations="100">'
        f'<flag contact="disable"/></option><worldbody>{xml("body base")}</worldbody>'
        f"<equality>{equality}</equality></mujoco>"
    )


def mujoco_timed(system, gravity, initial, tracked, duration, integrator, step):
    """(milliseconds a simulated second, place of the tracked point at the end) of MuJoCo."""
    import mujoco

    model = mujoco_model(system, gravity, integrator, step)
    best, place = np.inf, np.full(3, np.nan)
    start = simulate_system(system, Course(1e-6, 1e-6, gravity), initial=initial)
    # As often as kinform, where that takes no minutes.
    for _ in range(REPEATS if duration / step < 10_000 else 1):
        data = mujoco.MjData(model)
        for k, name in enumerate(start.joint_names):
            index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
            if index >= 0:
                data.qvel[model.jnt_dofadr[index]] = start.joint_velocity[0, start.joint_offset[k]]
        begin = time.process_time()
        mujoco.mj_step(model, data, nstep=round(duration / step))
        best = min(best, (time.process_time() - begin) / duration * 1e3)
        mujoco.mj_forward(model, data)
        body = data.body(f"body {tracked[0]}")
        place = body.xpos + body.xmat.reshape(3, 3) @ np.asarray(tracked[1], float)
    return best, place


def ratios(ours, theirs):
    """(error, how many times faster) at each of MuJoCo's settings that no other of its beats at both."""
    useful = [(spent, error) for spent, error in theirs if error < 1e-2]
    best = [(s, e) for s, e in useful if not any(t <= s and f <= e and (t, f) != (s, e) for t, f in useful)]
    out = []
    for spent, error in sorted(best):
        cheap = [t for t, e in ours if e <= error]
        if cheap:
            out.append((error, spent / min(cheap)))
    return out


def main():
    try:
        import mujoco  # noqa: F401

        beside = True
    except ImportError:
        beside = False
        print("mujoco is not installed: kinform alone")
    engine(compiled=True)
    print(f"{'mechanism':16} {'solver':22} {'ms a second':>12} {'error (m)':>12}")
    summary = []
    for name, (make, gravity, initial, tracked, duration) in CASES.items():
        ours, theirs = [], []
        system = make().system()
        _, exact = timed(system, gravity, initial, tracked, duration, 1e-10 if "bar" in name else 1e-13)
        for rtol in TOLERANCES:
            spent, place = timed(system, gravity, initial, tracked, duration, rtol)
            ours.append((spent, np.abs(place - exact).max()))
            print(f"{name:16} {f'kinform {rtol:g}':22} {spent:12.3f} {np.abs(place - exact).max():12.2e}", flush=True)
        if beside:
            for integrator in ("RK4", "implicitfast", "Euler"):
                for step in (1e-2, 2e-3, 5e-4, 1e-4):
                    spent, place = mujoco_timed(system, gravity, initial, tracked, duration, integrator, step)
                    theirs.append((spent, np.abs(place - exact).max()))
                    label = f"mujoco {integrator} {step:g}"
                    print(f"{name:16} {label:22} {spent:12.3f} {np.abs(place - exact).max():12.2e}", flush=True)
        summary.append((name, ratios(ours, theirs)))
    for name, found in summary if beside else ():
        where = ", ".join(f"{ratio:.1f} at {error:.0e} m" for error, ratio in found)
        least = f"{min(ratio for _, ratio in found):.1f}" if found else "none: MuJoCo reaches no error below 1 cm"
        print(f"{name:16} times faster than MuJoCo's best, least: {least} ({where})")


if __name__ == "__main__":
    main()
