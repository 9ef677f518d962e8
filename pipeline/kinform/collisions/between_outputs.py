"""Where bodies are between the outputs of a run: every joint moves on evenly from one output to the next.

A body that is asked alone would be turned about a point and taken along a line, and cut across the arc that it follows:
the further from that point, the more. A joint moves the second of its bodies along one screw, as the first sees it, and
so poses are composed along joints: between outputs, too, the axle stays in its bearing, wherever in the world it is.
In loops the joints with most freedoms close them, and are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from kinform.collisions.pair.posed_pairs import Nodes
from kinform.foundation.algebra.displacements import displacement, inverse, poses, twist_of
from kinform.foundation.graphs.graph import Edge, UnionFind, forest
from kinform.model.arrays import Array, Ints
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation


def nodes_of(simulation: Simulation, joints: Sequence[Joint]) -> Nodes:
    """The displacements of all bodies at the output times, and between them."""
    at_outputs, time = poses(simulation.p_WB, simulation.q_WB), simulation.time
    between = _between(time, at_outputs, _above(simulation.body_names, joints))
    # pairs halve the same steps: most poses are asked for by several
    return Nodes(time, at_outputs, lru_cache(maxsize=None)(between))


def _above(names: Sequence[str], joints: Sequence[Joint]) -> Ints:
    """(B,) the body that carries each body through a joint; B for those that nothing carries."""
    place = {name: k for k, name in enumerate(names)}
    sets, edges = UnionFind(len(names)), list[Edge]()
    for joint in sorted(joints, key=lambda joint: (joint.freedoms, joint.name)):
        if all(str(body) in place for body in joint.bodies):
            one, two = (place[str(body)] for body in joint.bodies)
            if sets.find(one) != sets.find(two):
                sets.union(one, two)
                edges.append((one, two))
    above = np.array(forest(len(names), edges, 0).parent, dtype=np.int64)
    above[above < 0] = len(names)
    return above


def _between(time: Array, at_outputs: Array, above: Ints) -> Callable[[float], Array]:
    """(B, 4, 4) displacements at any time, of those at the outputs (T, B, 4, 4) and the body `above` (B,) each."""
    count = len(above)
    still = np.broadcast_to(np.eye(4), (len(time), 1, 4, 4))
    relative = inverse(np.concatenate([at_outputs, still], axis=1)[:, above]) @ at_outputs
    twists = twist_of(inverse(relative[:-1]) @ relative[1:])

    def between(s: float) -> Array:
        n = int(np.searchsorted(time, s))
        if n < len(time) and time[n] == s:
            return np.asarray(at_outputs[n])
        n = min(max(int(np.searchsorted(time, s, side="right")) - 1, 0), len(time) - 2)
        share = (s - time[n]) / (time[n + 1] - time[n])
        out, up = np.empty((count + 1, 4, 4)), np.append(above, count)
        out[:count], out[count] = relative[n] @ displacement(share * twists[n]), np.eye(4)
        # by each round twice as many joints are composed
        while (up < count).any():
            out, up = out[up] @ out, up[up]
        return out[:count]

    return between
