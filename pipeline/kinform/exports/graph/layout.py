"""Where the nodes of a graph are drawn: distances on paper as distances in the graph. No physics here.

Each component starts in layers, breadth first from its first node, and is then moved to least stress by majorisation
(Gansner, Koren and North 2004); nodes that overlap are pushed apart. Nothing is random.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.graphs.graph import Edge, neighbours
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

MOST_STRESSED = 250
"""Nodes of a component; larger ones stay in layers, as majorisation takes their square in memory. Chosen, not
measured."""
MOST_ROUNDS = 200
"""Steps of majorisation, and rounds of pushing boxes apart: graphs of bodies settle in some tens. Chosen, not
measured."""
STILL = 0.05
"""px: a step of majorisation that moves no node by more is the last: a twentieth of a pixel is not seen."""
CROWDED = 9
"""Nodes with more neighbours are hubs, whose edges are longer. Chosen by eye."""
GAP = 26.0
"""px, least space between two boxes: more than two symbols of joints. Chosen by eye."""


def box_centres(sizes: Array, edges: Sequence[Edge], first: int, spacing: float) -> Array:
    """(n, 2) centres, px, y downwards, of boxes of these sizes (n, 2); component by component beside each other.

    `first` is the node that leads its component; `spacing` (px) is the length of an edge.
    """
    out = np.zeros((len(sizes), 2))
    left = 0.0
    for members, depth in _components(len(sizes), edges, first):
        index = {node: k for k, node in enumerate(members)}
        inner = [(index[a], index[b]) for a, b in edges if a in index]
        boxes = sizes[members]
        at = _layers(depth, boxes, spacing)
        if 2 < len(members) <= MOST_STRESSED:
            at = _least_stress(at, inner, spacing, boxes)
        at = _apart(at, boxes)
        low = (at - boxes / 2).min(axis=0)
        out[members] = at - low + (left, 0.0)
        left += float((at + boxes / 2).max(axis=0)[0] - low[0]) + 2 * GAP
    return out


def _components(nodes: int, edges: Sequence[Edge], first: int) -> list[tuple[list[int], list[int]]]:
    """Nodes of each component in breadth-first order, and their depths."""
    near = neighbours(nodes, edges)
    reached = [False] * nodes
    out = []
    for start in (first, *range(nodes)):
        if reached[start]:
            continue
        order, depth, reached[start] = [start], [0], True
        for n, node in enumerate(order):
            for other in sorted({o for o, _ in near[node]}):
                if not reached[other]:
                    reached[other] = True
                    order.append(other)
                    depth.append(depth[n] + 1)
        out.append((order, depth))
    return out


def _layers(depth: Sequence[int], boxes: Array, spacing: float) -> Array:
    """Each depth a row, its nodes side by side and centred."""
    at = np.zeros((len(depth), 2))
    for level in range(max(depth) + 1):
        row = [n for n, d in enumerate(depth) if d == level]
        wide = boxes[row, 0] + GAP
        at[row, 0] = np.cumsum(wide) - 0.5 * wide - 0.5 * wide.sum()
        at[row, 1] = -spacing * level
    return at


def _least_stress(at: Array, edges: Sequence[Edge], spacing: float, boxes: Array) -> Array:
    """Least Σ (distance on paper − ideal)² / ideal², by majorisation from where the nodes are."""
    far = _distances(len(at), edges) * spacing
    # boxes are wide: what lies beside each other needs more room than what lies above
    # Share of both widths by which boxes beside each other are to be further apart than their edges say. Chosen by eye.
    far = far + 0.25 * (boxes[:, 0][:, None] + boxes[:, 0][None])
    np.fill_diagonal(far, 1.0)
    weight = 1.0 / far**2
    np.fill_diagonal(weight, 0.0)
    laplacian = np.diag(weight.sum(axis=1)) - weight
    inverse = np.linalg.pinv(laplacian)
    at = at + 1e-3 * spacing * np.stack([np.cos(np.arange(len(at))), np.sin(1.7 * np.arange(len(at)))], axis=1)
    for _ in range(MOST_ROUNDS):
        apart = np.linalg.norm(at[:, None] - at[None], axis=2)
        pull = weight * far / np.maximum(apart, SOLVED)
        np.fill_diagonal(pull, 0.0)
        better = inverse @ ((np.diag(pull.sum(axis=1)) - pull) @ at)
        if float(np.abs(better - at).max()) < STILL:
            break
        at = better
    return _upright(at)


def _upright(at: Array) -> Array:
    """Turned so that it is widest along x, the first node at the bottom left."""
    at = at - at.mean(axis=0)
    _, axes = np.linalg.eigh(at.T @ at)
    at = at @ axes[:, ::-1]
    at = at * np.where(at[0] > 0.0, -1.0, 1.0)
    return at * (1.0, -1.0)


def _distances(nodes: int, edges: Sequence[Edge]) -> Array:
    """(n, n) edges on a shortest path; those of hubs are longer, or their neighbours find no place."""
    near = neighbours(nodes, edges)
    # The edge of a hub grows with this power of its neighbours over CROWDED. Chosen by eye, on the fixtures.
    long = [max(1.0, len(around) / CROWDED) ** 0.75 for around in near]
    out = np.zeros((nodes, nodes))
    for start in range(nodes):
        distance = {start: 0.0}
        queue = [start]
        for node in queue:
            for other, _ in near[node]:
                if other not in distance:
                    distance[other] = distance[node] + max(long[node], long[other])
                    queue.append(other)
        out[start, list(distance)] = list(distance.values())
    return out


def _apart(at: Array, boxes: Array) -> Array:
    """Overlapping boxes pushed apart along the direction that needs less."""
    at = at.copy()
    if len(at) > MOST_STRESSED:
        return at
    need = 0.5 * (boxes[:, None] + boxes[None]) + GAP
    for _ in range(MOST_ROUNDS):
        delta = at[None] - at[:, None]
        over = need - np.abs(delta)
        over[np.arange(len(at)), np.arange(len(at))] = -1.0
        # px: boxes that are nearer to each other than they may be by less stay where they are: half a pixel is not
        # seen.
        first, second = np.nonzero(np.triu((over > 0.5).all(axis=2), 1))
        if not len(first):
            break
        for i, j in zip(first.tolist(), second.tolist(), strict=True):
            axis = int(np.argmin(over[i, j]))
            way = 1.0 if at[j, axis] >= at[i, axis] else -1.0
            push = 0.5 * max(0.0, float(need[i, j, axis] - abs(at[j, axis] - at[i, axis]))) * way
            at[i, axis] -= push
            at[j, axis] += push
    return at
