"""How far a point of a simulated body strays from a path, and its orientation from that of the path.

Both are compared at all times of the path's rows and at all output times between them: the path is straight
between its rows, and turns evenly; the motion is a cubic spline through the output times. What the spline may
miss is bounded by the difference from straight lines where the path's time lies between two output times.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array
from kinform.requirements.evidence import Deviation


def deviation(time: Array, p_WB: Array, q_WB: Array, point: Array, path: Array) -> Deviation:
    """The body's poses p_WB (T, 3), q_WB (T, 4) wxyz at `time`; `point` (3,) m of it at the pose of the meshes;
    `path` rows (t, x, y, z[, qw, qx, qy, qz]) within the time of the run."""
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, Slerp

    turns = Rotation.from_quat(q_WB, scalar_first=True)
    track = p_WB + turns.apply(point)
    first, last = path[0, 0], path[-1, 0]
    inner = time[(time >= first) & (time <= last)]
    when = np.union1d(path[:, 0], inner)
    if len(time) < 2:
        here, straight = np.repeat(track, len(when), axis=0), np.repeat(track, len(when), axis=0)
    else:
        at = np.clip(when, time[0], time[-1])
        here = np.asarray(CubicSpline(time, track)(at))
        straight = np.array([np.interp(at, time, track[:, k]) for k in range(3)]).T
    wanted = np.array([np.interp(when, path[:, 0], path[:, 1 + k]) for k in range(3)]).T
    distance = np.linalg.norm(here - wanted, axis=1)
    k = int(np.argmax(distance))
    between = ~np.isin(when, time)
    error = float(np.linalg.norm(here - straight, axis=1)[between].max(initial=0.0))
    angle, angle_time = None, 0.0
    if path.shape[1] == 8:
        aim = Slerp(path[:, 0], Rotation.from_quat(path[:, 4:], scalar_first=True))(when)
        held = Slerp(time, turns)(np.clip(when, time[0], time[-1])) if len(time) > 1 else turns[[0] * len(when)]
        apart = (aim.inv() * held).magnitude()
        n = int(np.argmax(apart))
        angle, angle_time = float(apart[n]), float(when[n])
    return Deviation(float(distance[k]), float(when[k]), here[k], angle, angle_time, error)
