"""Computed witnesses: each equation once, by another method than the rule's.

An equation is handed the numbers of the witness, and the meshes of the parts that it names; it gives the residual that
the witness should state. What cannot be recomputed raises NotReplayed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.findings import PUSHES_MOST, Witness
from kinform.replays.geometric import Sides
from kinform.replays.outcome import NotReplayed, Outcome, held, refuted

NUMBERS_MOST = 100_000
"""Numbers of one witness."""
ROUNDED = 1e-6
"""Share by which a residual may differ where both methods are exact."""
PIVOT = 1e-6
"""Least pivot of an elimination of entries up to 1: twists of joints are known to some 1e-9."""
RANK_SHARE = 1e-7
"""Share of the largest singular value up to which one is zero."""
BODIES_MOST = 150
"""Bodies of a graph of which the constraints are decomposed: some seconds."""
MESH_BYTES = 256 << 20
"""Of a mesh file that is read again: five million facets."""
SURFACE_OFF = 5e-3
"""Share of its radius by which a corner may be off a round surface that it is of."""
SMOOTH = 0.05
"""Share by which two differences of one motion may differ where it is smooth."""
SCREWS_MOST = 8
"""Coordinates of a chain whose reach is replayed."""
STARTS, APPROACHED = 400, 12
"""Configurations of a chain that are tried, and so many of the best from which the aim is approached."""
FINITE_STEP = 1e-6
"""Step of differences, in the size of what moves: their error is as small."""


@dataclass(frozen=True, eq=False)
class Inputs:
    """The numbers of one witness, and the meshes of its parts."""

    witness: Witness
    sides: Sides

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts that it is about; NotReplayed without any."""
        if not self.witness.first:
            raise NotReplayed("the witness names no part")
        return self.witness.first

    def has(self, name: str) -> bool:
        """Whether there is such an input."""
        return name in (self.witness.inputs or {})

    def array(self, name: str, *shape: int) -> Array:
        """An input of that shape; NotReplayed where it has another one."""
        values = (self.witness.inputs or {}).get(name)
        if values is None:
            raise NotReplayed(f"the witness has no input '{name}'")
        try:
            return np.array(values, dtype=np.float64).reshape(shape)
        except ValueError:
            raise NotReplayed(f"the input '{name}' has {len(values)} numbers") from None

    def number(self, name: str) -> float:
        """An input of one number."""
        return float(self.array(name, 1)[0])

    def beyond(self, value: float) -> float:
        """How far a value is outside of the bounds among the inputs; negative inside."""
        low = self.number("least") if self.has("least") else -math.inf
        high = self.number("most") if self.has("most") else math.inf
        return max(low - value, value - high)

    def mesh(self, name: str) -> tuple[Array, Array]:
        """Vertices (n, 3) in the part frame and facets (m, 3) as they are wound."""
        part = self.sides.part(name)
        if part.mesh is None or not len(part.mesh.faces):
            raise NotReplayed(f"'{name}' has no mesh")
        self.sides.check([name])
        return part.mesh.vertices, np.asarray(part.mesh.faces, dtype=np.int64)

    def points(self) -> Array:
        """(n, 3) m: vertices of all meshes of the parts, in the world."""
        self.sides.check(self.parts)
        return np.concatenate([self.sides.placed(name)[0] for name in self.parts])


def replay(witness: Witness, sides: Sides) -> Outcome:
    """Whether the residual of a witness is what its inputs give, and beyond its limit; raises NotReplayed."""
    known = EQUATIONS.get(witness.equation or "")
    if known is None or witness.residual is None or witness.limit is None:
        raise NotReplayed(f"no equation is called {witness.equation!r}")
    numbers = [witness.residual, witness.limit, *(x for row in (witness.inputs or {}).values() for x in row)]
    if len(numbers) > NUMBERS_MOST or not all(map(math.isfinite, numbers)):
        raise NotReplayed("its numbers are too many, or not finite")
    equation, share = known
    with np.errstate(all="ignore"):
        found = equation(Inputs(witness, sides))
    if not math.isfinite(found):
        raise NotReplayed("the equation gives no number")
    scale = max(abs(found), abs(witness.residual), abs(witness.limit) if share > ROUNDED else 0.0)
    shown = f"{witness.equation}: {found:.6g}, stated {witness.residual:.6g}, limit {witness.limit:.6g}"
    if (
        abs(found - witness.residual) > share * scale
        or not found > witness.limit
        or not witness.residual > witness.limit
    ):
        return refuted(shown)
    return held(shown)


def _unit(vector: Array) -> Array:
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        raise NotReplayed("a direction is zero")
    return vector / size


# Meshes


def _edge_uses(inputs: Inputs) -> float:
    """How often the facets of a mesh use an edge beside the two times, or run along it beside the one time."""
    vertices, faces = inputs.mesh(inputs.parts[0])
    ends = inputs.array("edge", 2, 3)
    reach = 1e-9 * float(np.ptp(vertices, axis=0).max())
    first, second = ((np.abs(vertices - end).max(axis=1) <= reach)[faces] for end in ends)
    both = first.any(axis=1) & second.any(axis=1)
    if inputs.number("directed"):
        onward = (first & np.roll(second, -1, axis=1)).any(axis=1)
        return float((both & onward).sum()) - 1.0
    return abs(float(both.sum()) - 2.0)


def _facet_faces_inwards(inputs: Inputs) -> float:
    """1 where a ray from the middle of a facet, to the side that it faces, crosses the mesh an odd number of times."""
    vertices, faces = inputs.mesh(inputs.parts[0])
    facet = int(inputs.number("facet"))
    if not 0 <= facet < len(faces):
        raise NotReplayed("the mesh has no such facet")
    a, b, c = vertices[faces].swapaxes(0, 1)
    others = np.arange(len(faces)) != facet
    middle, normal = (a[facet] + b[facet] + c[facet]) / 3.0, _unit(np.cross(b[facet] - a[facet], c[facet] - a[facet]))
    odd = 0
    for aside in ([0.0, 0.0, 0.0], [0.31, 0.17, -0.23], [-0.19, 0.29, 0.13]):  # no edge lies in all three directions
        way = _unit(normal + np.array(aside))
        e1, e2, away = (b - a)[others], (c - a)[others], middle - a[others]
        p = np.cross(way, e2)
        det = (e1 * p).sum(axis=1)
        u = (away * p).sum(axis=1) / det
        q = np.cross(away, e1)
        v, t = q @ way / det, (q * e2).sum(axis=1) / det
        odd += int(((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)).sum()) % 2
    return float(odd >= 2)


def _volume_of_a_file(inputs: Inputs) -> float:
    """m³ that a mesh file encloses, with the other sign: the facets' shadows on a plane times their heights."""
    name = inputs.witness.source_file or ""
    data = inputs.sides.files.read(name, MESH_BYTES)
    corners = _stl(data) if name.lower().endswith(".stl") else _obj(data) if name.lower().endswith(".obj") else None
    if corners is None or not len(corners):
        raise NotReplayed("only STL and OBJ are read again")
    a, b, c = (corners - corners.reshape(-1, 3).mean(axis=0)).swapaxes(0, 1)
    shadows = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return -float((shadows * (a + b + c)[:, 2] / 3.0).sum()) * inputs.number("metres") ** 3


def _stl(data: bytes) -> Array:
    """(n, 3, 3) corners of the facets of an STL."""
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        facets = np.frombuffer(data, np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")]), offset=84)
        return facets["c"].astype(np.float64)
    rows = [
        line.split()[1:4] for line in data.decode("ascii", "replace").splitlines() if line.split()[:1] == ["vertex"]
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 3, 3)


def _obj(data: bytes) -> Array:
    """(n, 3, 3) corners of the triangles of an OBJ, polygons as fans."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for words in (line.split() for line in data.decode("utf-8", "replace").splitlines()):
        if words[:1] == ["v"]:
            vertices.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            of = [int(word.partition("/")[0]) for word in words[1:]]
            of = [k - 1 if k > 0 else len(vertices) + k for k in of]
            faces += [(of[0], b, c) for b, c in pairwise(of[1:])]
    return np.array(vertices)[np.array(faces, dtype=np.int64)]


def _ratio_of_sizes(inputs: Inputs) -> float:
    """Diagonal of one mesh's box over that of another, or of all over a stated one; the larger over the smaller."""
    if inputs.has("size"):
        seen = inputs.points() @ inputs.array("rotation", 3, 3)
        sizes = [float(np.linalg.norm(np.ptp(seen, axis=0))), inputs.number("size")]
    else:
        sizes = [float(np.linalg.norm(np.ptp(inputs.mesh(name)[0], axis=0))) for name in inputs.parts]
    low, *_, high = sorted(sizes)
    if low <= 0.0:
        raise NotReplayed("a size is zero")
    return high / low


def _coordinate_step(inputs: Inputs) -> float:
    """A step of coordinates over the diagonal of the mesh: as binary numbers of that magnitude have it, or as no two
    coordinates are nearer."""
    vertices, _ = inputs.mesh(inputs.parts[0])
    step, largest = inputs.number("step"), inputs.number("largest")
    binary = [float(np.spacing(kind(largest))) for kind in (np.float32, np.float64)]
    if not any(0.4 < step / one < 2.6 for one in binary):
        apart = np.diff(np.unique(vertices))
        apart = apart[apart > 1e-9 * float(np.ptp(vertices))]
        if not len(apart) or float(apart.min()) < 0.5 * step:
            return 0.0
    return step / float(np.linalg.norm(np.ptp(vertices, axis=0)))


# Masses


def _hull_volume(inputs: Inputs) -> float:
    from manifold3d import Manifold

    volume = float(Manifold.hull_points(np.ascontiguousarray(inputs.points())).volume())
    if volume <= 0.0:
        raise NotReplayed("the convex hull has no volume")
    return volume


def _density_of_the_hull(inputs: Inputs) -> float:
    """kg/m³: a mass over the convex hull of the meshes."""
    return inputs.number("mass") / _hull_volume(inputs)


def _hull_of_a_mass(inputs: Inputs) -> float:
    """m³/kg: the convex hull of the meshes over a mass."""
    return _hull_volume(inputs) / inputs.number("mass")


def _impossible_inertia(inputs: Inputs) -> float:
    """By how much the largest principal moment exceeds the sum of the others, or the least is below zero, over the
    largest: roots of the characteristic polynomial. Of a mass without inertia: by how much it is below zero."""
    if not inputs.has("inertia"):
        return -inputs.number("mass")
    i = inputs.array("inertia", 3, 3)
    minors = sum(i[a, a] * i[b, b] - i[a, b] * i[b, a] for a, b in ((0, 1), (0, 2), (1, 2)))
    scale = float(np.abs(i).max())
    roots = np.roots([1.0, -np.trace(i) / scale, minors / scale**2, _determinant(i / scale)])
    low, middle, high = sorted(float(root.real) for root in roots)
    return max(high - low - middle, -low) / max(abs(high), abs(low))


def _determinant(i: Array) -> float:
    """Minus the determinant, by cofactors."""
    return -float(
        i[0, 0] * (i[1, 1] * i[2, 2] - i[1, 2] * i[2, 1])
        - i[0, 1] * (i[1, 0] * i[2, 2] - i[1, 2] * i[2, 0])
        + i[0, 2] * (i[1, 0] * i[2, 1] - i[1, 1] * i[2, 0])
    )


def _inertia_beyond_reach(inputs: Inputs) -> float:
    """Half the trace of an inertia over that of all the mass at the farthest vertex."""
    away = inputs.points() - inputs.array("centre", 3)
    return 0.5 * inputs.number("trace") / (inputs.number("mass") * float((away * away).sum(axis=1).max()))


def _second_moments(inputs: Inputs) -> Array:
    """(4, 4) sum of m·x xᵀ of homogeneous points x, in the world: of the meshes at their densities, by a quadrature of
    tetrahedra that is exact for squares, and of stated masses from their inertias."""
    density, mass = inputs.array("densities", -1), inputs.array("masses", -1)
    centre, inertia = inputs.array("centres", -1, 3), inputs.array("inertias", -1, 3, 3)
    names = inputs.parts
    if not len(names) == len(density) == len(mass) == len(centre) == len(inertia):
        raise NotReplayed("its inputs are of different numbers of parts")
    total = np.zeros((4, 4))
    near, far = (5.0 - math.sqrt(5.0)) / 20.0, (5.0 + 3.0 * math.sqrt(5.0)) / 20.0
    for name, rho, m, c, i in zip(names, density, mass, centre, inertia, strict=True):
        if rho > 0.0:
            vertices, faces = inputs.sides.placed(name)
            middle = vertices.mean(axis=0)
            tips = vertices[faces] - middle
            weights = rho * np.linalg.det(tips) / 6.0 / 4.0
            corners = np.concatenate([tips, np.zeros((len(tips), 1, 3))], axis=1)
            for k in range(4):
                shares = np.full(4, near)
                shares[k] = far
                x = np.concatenate([np.einsum("k,nkj->nj", shares, corners) + middle, np.ones((len(tips), 1))], axis=1)
                total += np.einsum("n,ni,nj->ij", weights, x, x)
        else:
            x = np.append(c, 1.0)
            total += m * np.outer(x, x)
            total[:3, :3] += 0.5 * np.trace(i) * np.eye(3) - i
    return total


def _mass_of_shapes(inputs: Inputs) -> float:
    return inputs.beyond(float(_second_moments(inputs)[3, 3]))


def _centre_off_a_point(inputs: Inputs) -> float:
    moments = _second_moments(inputs)
    return float(np.linalg.norm(moments[:3, 3] / moments[3, 3] - inputs.array("point", 3)))


def _about_line(inputs: Inputs) -> tuple[float, Array]:
    """Moment of inertia about a line, and the offset (3,) of mass times distance from it."""
    moments = _second_moments(inputs)
    axis = _unit(inputs.array("axis", 3))
    point = inputs.array("point", 3) if inputs.has("point") else moments[:3, 3] / moments[3, 3]
    lift = np.eye(4)
    lift[:3, 3] = -point
    moved = lift @ moments @ lift.T
    across = moved[:3, 3] - axis * float(axis @ moved[:3, 3])
    return float(np.trace(moved[:3, :3]) - axis @ moved[:3, :3] @ axis), across


def _inertia_about_a_line(inputs: Inputs) -> float:
    return inputs.beyond(_about_line(inputs)[0])


def _imbalance_about_a_line(inputs: Inputs) -> float:
    return float(np.linalg.norm(_about_line(inputs)[1]))


# Joints


def _angle_of_directions(inputs: Inputs) -> float:
    """Angle of two undirected lines, by the chord between their ends."""
    found, meant = _unit(inputs.array("found", 3)), _unit(inputs.array("meant", 3))
    chord = min(float(np.linalg.norm(found - meant)), float(np.linalg.norm(found + meant)))
    return 2.0 * math.asin(0.5 * chord)


def _distance_of_lines(inputs: Inputs) -> float:
    """Least distance of the found line from the meant one over the stretch between their points, by trying the
    stretch."""
    axis, point = _unit(inputs.array("meant_axis", 3)), inputs.array("meant_point", 3)
    other, beside = _unit(inputs.array("found_axis", 3)), inputs.array("found_point", 3)
    low, high = sorted((0.0, float(axis @ (beside - point))))
    least = math.inf
    for _ in range(6):
        places = np.linspace(low, high, 101)
        off = np.linalg.norm(np.cross(point + places[:, None] * axis - beside, other), axis=1)
        best = int(off.argmin())
        least = float(off[best])
        low, high = float(places[max(best - 1, 0)]), float(places[min(best + 1, 100)])
    return least


def _distance_of_points(inputs: Inputs) -> float:
    return math.dist(inputs.array("found", 3), inputs.array("meant", 3))


def _lead_of_a_twist(inputs: Inputs) -> float:
    """Difference (m a turn) of the advance of a screw from that which is meant, by moving a point for a small turn."""
    twist, axis = inputs.array("twist", 6), _unit(inputs.array("twist", 6)[:3])
    turn = FINITE_STEP
    way = twist[3:] / float(np.linalg.norm(twist[:3])) * turn
    return abs(float(way @ axis) / turn * 2.0 * math.pi - inputs.number("meant"))


def _ratio_of_rates(inputs: Inputs) -> float:
    """How far the product of ratios is from the one that is meant: by counting turns through all of them."""
    turns = 1.0
    for up, down in inputs.array("links", -1, 2):
        if down == 0.0:
            raise NotReplayed("a link has no teeth")
        turns = turns * up / down
    return abs(turns - inputs.number("meant"))


def _balanced_pushes(inputs: Inputs) -> float:
    """Sum of pushes over the wrench that they leave: no motion opens all of them faster than one over it. At most
    `PUSHES_MOST`."""
    points, normals = inputs.array("points", -1, 3), inputs.array("normals", -1, 3)
    pushes, middle, reach = inputs.array("pushes", -1), inputs.array("middle", 3), inputs.number("reach")
    if len(points) != len(pushes) or len(normals) != len(pushes) or reach <= 0.0:
        raise NotReplayed("its inputs are of different numbers of contacts")
    if (pushes < 0.0).any():
        return 0.0
    force, moment = [0.0] * 3, [0.0] * 3
    for p, n, push in zip((points - middle) / reach, normals, pushes, strict=True):
        force = [f + push * x for f, x in zip(force, n, strict=True)]
        turn = (p[1] * n[2] - p[2] * n[1], p[2] * n[0] - p[0] * n[2], p[0] * n[1] - p[1] * n[0])
        moment = [m + push * x for m, x in zip(moment, turn, strict=True)]
    left = math.fsum(map(abs, (*force, *moment)))
    return min(math.fsum(pushes) / left if left > 0.0 else math.inf, PUSHES_MOST)


def _motion_that_opens(inputs: Inputs) -> float:
    """Least speed at which a small finite motion lets contacts open, over the fastest that they move; below −1 where
    the motion is one of those that are meant."""
    points, normals = inputs.array("points", -1, 3), inputs.array("normals", -1, 3)
    bodies, twists = inputs.array("bodies", -1, 2).astype(np.int64), inputs.array("twists", -1, 6)
    meant, middle, reach = inputs.array("meant", -1, 6), inputs.array("middle", 3), inputs.number("reach")
    if not len(points) == len(normals) == len(bodies) > 0 or reach <= 0.0:
        raise NotReplayed("its inputs are of different numbers of contacts")
    if bodies.min() < 0 or bodies.max() >= len(twists):
        raise NotReplayed("a contact is of no body of its inputs")
    if np.abs(twists[0]).max() > 0.0:
        return -2.0  # the first side rests
    scaled = np.concatenate([twists[:, :3] * reach, twists[:, 3:] + np.cross(twists[:, :3], middle)], axis=1)
    if len(meant):
        basis = np.concatenate([meant[:, :3] * reach, meant[:, 3:] + np.cross(meant[:, :3], middle)], axis=1)
        shares, *_ = np.linalg.lstsq(basis.T, scaled[-1], rcond=None)
        if np.linalg.norm(scaled[-1] - shares @ basis) < 1e-3 * np.linalg.norm(scaled[-1]):
            return -2.0
    step = FINITE_STEP * reach / float(np.linalg.norm(scaled[-1]))
    moved = [_small(twist * step) for twist in twists]
    ends = [np.einsum("nij,nj->ni", np.array([X[:3, :3] for X in moved])[bodies[:, k]], points)
            + np.array([X[:3, 3] for X in moved])[bodies[:, k]] for k in (0, 1)]  # fmt: skip
    return float((((ends[1] - ends[0]) * normals).sum(axis=1) / (FINITE_STEP * reach)).min())


def _small(twist: Array) -> Array:
    from scipy.linalg import expm

    x, y, z = twist[:3]
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    matrix[:3, 3] = twist[3:]
    return np.asarray(expm(matrix))


def _freedoms_of_twists(inputs: Inputs) -> float:
    """How far the number of independent twists is from one: by elimination, row by row."""
    rows = [row / float(np.abs(row).max()) for row in inputs.array("twists", -1, 6) if np.abs(row).max() > 0.0]
    return abs(_eliminated(np.array(rows).reshape(-1, 6)) - 1.0)


def _eliminated(rows: Array) -> int:
    """Rank of some rows of entries up to 1, by elimination with full pivoting."""
    left, rank = rows.copy(), 0
    while len(left):
        i, j = np.unravel_index(int(np.abs(left).argmax()), left.shape)
        if abs(left[i, j]) < PIVOT:
            break
        pivot = left[i]
        left = np.delete(left, i, axis=0)
        left = left - np.outer(left[:, j] / pivot[j], pivot)
        rank += 1
    return rank


def _freedoms_of_a_graph(inputs: Inputs) -> float:
    """How far the number of freedoms is from the one that is meant. Each joint forbids its bodies what is reciprocal to
    its twists; all bodies move but the ground. No loops are looked for."""
    count, ground = int(inputs.number("bodies")), int(inputs.number("ground"))
    edges, counts = inputs.array("edges", -1, 2).astype(np.int64), inputs.array("counts", -1).astype(np.int64)
    twists, meant = inputs.array("twists", -1, 6), inputs.number("meant")
    if count > BODIES_MOST:
        raise NotReplayed(f"more than {BODIES_MOST} bodies are not replayed")
    if not 0 <= ground < max(count, 1):
        raise NotReplayed("the ground is no body")
    if len(edges) != len(counts) or counts.sum() != len(twists) or (counts < 0).any() or (counts > 6).any():
        raise NotReplayed("its inputs are of different numbers of joints")
    if len(edges) and not (0 <= edges.min() and edges.max() < count):
        raise NotReplayed("a joint is of no body")
    lines = twists[np.abs(twists[:, :3]).max(axis=1) > 0.0] if len(twists) else twists
    feet = np.cross(lines[:, :3], lines[:, 3:]) / (lines[:, :3] ** 2).sum(axis=1)[:, None]
    middle = feet.mean(axis=0) if len(feet) else np.zeros(3)
    reach = float(np.linalg.norm(feet - middle, axis=1).max(initial=0.0)) or 1.0
    scaled = np.concatenate([twists[:, :3], (twists[:, 3:] + np.cross(twists[:, :3], middle)) / reach], axis=1)
    rows, start = [], 0
    for (a, b), n in zip(edges, counts, strict=True):
        free = scaled[start : start + n]
        start += n
        _, sizes, basis = np.linalg.svd(free) if n else (None, np.zeros(0), np.eye(6))
        for row in basis[int((sizes > 1e-6 * sizes.max(initial=0.0)).sum()) :]:
            whole = np.zeros((count, 6))
            whole[b] += row
            whole[a] -= row
            rows.append(np.delete(whole, ground, axis=0).ravel())
    moving = max(6 * (count - 1), 0)
    sizes = np.linalg.svd(np.array(rows).reshape(-1, moving), compute_uv=False) if rows and moving else np.zeros(0)
    free_count = moving - int((sizes > RANK_SHARE * sizes.max(initial=0.0)).sum())
    effective = free_count - inputs.number("lost") - inputs.number("idle")
    ends = inputs.array("ends", 2)
    return min(abs(count - meant) for count in (effective, float(ends[0]), float(ends[1])))


def _end_of_a_guide(inputs: Inputs) -> float:
    """m by which a slider has left the last of its guides: spans along the axis of which both ends are corners of the
    meshes."""
    axis, spans, slid = _unit(inputs.array("axis", 3)), inputs.array("spans", -1, 4), inputs.number("slid")
    if len(inputs.parts) != 2 * len(spans):
        raise NotReplayed("its inputs are of different numbers of parts")
    left = math.inf
    for k, (a, b, low, high) in enumerate(spans):
        for name, ends in zip(inputs.parts[2 * k : 2 * k + 2], ((a, b), (low, high)), strict=True):
            heights = inputs.sides.placed(name)[0] @ axis
            near = 1e-6 * float(np.ptp(heights))
            if any(np.abs(heights - end).min() > near for end in ends):
                return -1.0  # no corner lies at an end of the span
        left = min(left, max(low + slid - b, a - high - slid))
    return left


def _sum_of_rates(inputs: Inputs) -> float:
    """Sum of terms that should be zero, over the greatest of them."""
    terms = inputs.array("terms", -1).tolist()
    most = max(map(abs, terms), default=0.0)
    return abs(math.fsum(terms)) / most if most > 0.0 else 0.0


def _fit_of_surfaces(inputs: Inputs) -> float:
    """How far a clearance is beyond its bounds, of corners of the meshes: the mean distance of those of round surfaces
    from their axis, or the heights of planes."""
    parts = inputs.parts
    if inputs.has("radii"):
        axis, point, radii = inputs.array("axis", 3), inputs.array("point", 3), inputs.array("radii", 2)
        found = []
        for name, radius in zip(parts, radii, strict=True):
            away = inputs.sides.placed(name)[0] - point
            off = np.linalg.norm(np.cross(away, _unit(axis)) if axis.any() else away, axis=1)
            off = off[np.abs(off - radius) < SURFACE_OFF * radius]
            if not len(off):
                raise NotReplayed(f"'{name}' has no corner at a radius of {radius:.6g} m")
            found.append(float(off.mean()))
        return inputs.beyond(abs(found[1] - found[0]) * (1.0 if inputs.number("gap") >= 0.0 else -1.0))
    axes, heights = inputs.array("axes", -1, 3), inputs.array("heights", -1, 2)
    if len(parts) != 2 * len(axes) or len(axes) != len(heights):
        raise NotReplayed("its inputs are of different numbers of planes")
    total = 0.0
    for k, (axis, ends) in enumerate(zip(axes, heights, strict=True)):
        there = []
        for name, end in zip(parts[2 * k : 2 * k + 2], ends, strict=True):
            places = inputs.sides.placed(name)[0] @ axis
            near = places[np.abs(places - end) < 1e-4 * float(np.ptp(places))]
            if not len(near):
                raise NotReplayed(f"'{name}' has no corner in its plane")
            there.append(float(near.mean()))
        total += there[1] - there[0]
    return inputs.beyond(total)


# Runs


def _rates(times: Array, values: Array, at: float, order: int = 2) -> tuple[Array, Array]:
    """First and second derivative at a time of what is known at some times (n,), by the polynomial through all and by
    that through one less; NotReplayed where the two differ up to an order, so that there is a kink."""
    if not len(times) == len(values) or not 3 <= len(times) <= 5 or len(np.unique(times)) < len(times):
        raise NotReplayed("three to five output times are needed")
    scale, flat = float(np.ptp(times)), values.reshape(len(times), -1)

    def derivatives(some: Ints) -> tuple[Array, Array]:
        """At the time, and the largest of the second ones at the times."""
        powers = np.vander((times[some] - at) / scale, len(some), increasing=True)
        terms = np.linalg.solve(powers, flat[some])
        bent = [sum(k * (k - 1) * terms[k] * x ** (k - 2) for k in range(2, len(some))) for x in powers[:, 1]]
        return np.stack([terms[1] / scale, 2.0 * terms[2] / scale**2]), np.abs(bent).max() / scale**2

    every, bent = derivatives(np.arange(len(times)))
    few, _ = derivatives(np.argsort(np.abs(times - at), kind="stable")[: max(3, len(times) - 1)])
    largest = np.array([max(float(np.abs(every[0]).max()), scale * bent), bent])
    noise = 1e-12 * float(np.abs(flat).max(initial=0.0)) / (scale / len(times)) ** np.array([1, 2])
    if (np.abs(every - few).max(axis=1) > SMOOTH * largest + noise)[:order].any():
        raise NotReplayed("the motion is not smooth at that time, or its output times are too far apart")
    return every[0].reshape(values.shape[1:]), every[1].reshape(values.shape[1:])


def _rate_of_positions(inputs: Inputs) -> float:
    """Speed of a joint by differences of its positions."""
    times = inputs.array("times", -1)
    speed, _ = _rates(times, inputs.array("values", -1), inputs.number("at"), order=1)
    return abs(float(speed))


def _effort_of_motion(inputs: Inputs) -> float:
    """What a joint gives the bodies that hang on it, by Newton and Euler: their accelerations are differences of their
    places and turns, their weights the rest."""
    from scipy.spatial.transform import Rotation

    times, at = inputs.array("times", -1), inputs.number("at")
    masses, inertias = inputs.array("masses", -1), inputs.array("inertias", -1, 3, 3)
    count, steps = len(masses), len(times)
    places, turns = inputs.array("places", count, steps, 3), inputs.array("turns", count, steps, 3, 3)
    gravity, axis, point = inputs.array("gravity", 3), _unit(inputs.array("axis", 3)), inputs.array("point", 3)
    if len(inertias) != count:
        raise NotReplayed("its inputs are of different numbers of bodies")
    here = int(np.abs(times - at).argmin())
    force, moment = np.zeros(3), np.zeros(3)
    for m, inertia, track, turned in zip(masses, inertias, places, turns, strict=True):
        _, acceleration = _rates(times, track, at)
        pushed = m * (acceleration - gravity)
        force += pushed
        if inputs.number("quantity") == 1.0:
            continue
        vectors = Rotation.from_matrix(turned @ turned[here].T).as_rotvec()
        omega, alpha = _rates(times, vectors, at)
        spun = turned[here] @ inertia @ turned[here].T
        moment += np.cross(track[here] - point, pushed) + spun @ alpha + np.cross(omega, spun @ omega)
    quantity = inputs.number("quantity")
    if quantity:
        return float(np.linalg.norm(force if quantity == 1.0 else moment))
    if inputs.number("slides"):
        return abs(float(axis @ force))
    return abs(float(axis @ moment + inputs.number("lead") / (2.0 * math.pi) * (axis @ force)))


def _record_of_a_run(inputs: Inputs) -> float:
    """What the run of the results has of a joint at an output: read again, and not recomputed."""
    run = inputs.sides.design.simulation
    output, column = int(inputs.number("output")), int(inputs.number("column"))
    if run is None:
        raise NotReplayed("the results have no run")
    wrench = {1.0: slice(3, 6), 2.0: slice(0, 3)}.get(inputs.number("quantity"))
    table = run.joint_effort if wrench is None else run.F_A
    if not (0 <= output < len(table) and 0 <= column < table.shape[1]):
        raise NotReplayed("the run has no such output")
    return abs(float(table[output, column])) if wrench is None else float(np.linalg.norm(table[output, column, wrench]))


def _time_of_a_run(inputs: Inputs) -> float:
    """s by which the run of the results is shorter than what was asked for: the steps of its outputs, added up."""
    run = inputs.sides.design.simulation
    if run is None:
        raise NotReplayed("the results have no run")
    return inputs.number("duration") - math.fsum(np.diff(run.time, prepend=0.0).tolist())


def _closing_of_loops(inputs: Inputs) -> float:
    """How far (rad or m) the bodies of a run are from what their joints allow at an output, of joints whose motions
    are a group."""
    from scipy.linalg import logm

    run, kinematics = inputs.sides.design.simulation, inputs.sides.design.kinematics
    output = int(inputs.number("output"))
    if run is None or kinematics is None or not 0 <= output < len(run.time):
        raise NotReplayed("the results have no such run")
    most = 0.0
    for joint in kinematics.joints:
        if joint.type in ("general", "universal") or not all(name in run.body_names for name in joint.bodies):
            continue
        first, second = (
            _pose(run.p_WB[output, b], run.q_WB[output, b]) for b in map(run.body_names.index, joint.bodies)
        )
        matrix = np.real(logm(np.linalg.inv(first) @ second))
        twist = np.array([matrix[2, 1], matrix[0, 2], matrix[1, 0], *matrix[:3, 3]])
        point = np.zeros(3) if joint.point is None else joint.point
        at = np.concatenate([twist[:3], twist[3:] + np.cross(twist[:3], point)])
        free = np.concatenate([joint.twists[:, :3], joint.twists[:, 3:] + np.cross(joint.twists[:, :3], point)], axis=1)
        shares = np.linalg.lstsq(free.T, at, rcond=None)[0] if len(free) else np.zeros(0)
        left = at - shares @ free if len(free) else at
        most = max(most, float(np.linalg.norm(left[:3])), float(np.linalg.norm(left[3:])))
    return most


def _pose(place: Array, quaternion: Array) -> Array:
    from scipy.spatial.transform import Rotation

    out = np.eye(4)
    out[:3, :3], out[:3, 3] = Rotation.from_quat(np.roll(quaternion, -1)).as_matrix(), place
    return out


def _path_and_motion(inputs: Inputs) -> float:
    """How far a point of a moving body is from a path (m), or its orientation from that of the path (rad): polynomials
    through the places of the point at five output times."""
    times, at, point = inputs.array("times", -1), inputs.number("at"), inputs.array("point", 3)
    places, turns = inputs.array("places", len(times), 3), inputs.array("turns", len(times), 4)
    rows = inputs.array("rows", 2, -1)
    (before, after), when = rows, rows[:, 0]
    if when[1] <= when[0] or not 2 <= len(times) <= 5:
        raise NotReplayed("its times do not ascend")
    share = (at - when[0]) / (when[1] - when[0])
    if inputs.number("turned"):
        one, other = before[4:8] / np.linalg.norm(before[4:8]), after[4:8] / np.linalg.norm(after[4:8])
        aim, held = _turned(one, other, share), turns[int(np.abs(times - at).argmin())]
        return 2.0 * math.acos(min(1.0, abs(float(aim @ held)) / float(np.linalg.norm(held))))
    w, v = turns[:, :1], turns[:, 1:]
    twice = 2.0 * np.cross(v, np.broadcast_to(point, v.shape))
    track = places + (point + w * twice + np.cross(v, twice)) / (turns**2).sum(axis=1)[:, None]
    weights = [math.prod((at - b) / (a - b) for b in times if b != a) for a in times]
    here = np.asarray(weights) @ track
    return math.dist(here, (1.0 - share) * before[1:4] + share * after[1:4])


def _turned(one: Array, other: Array, share: float) -> Array:
    """Between two unit quaternions, evenly."""
    cosine = float(one @ other)
    other, cosine = (other, cosine) if cosine >= 0.0 else (-other, -cosine)
    angle = math.acos(min(1.0, cosine))
    if angle < 1e-9:
        return one
    return np.asarray((math.sin((1.0 - share) * angle) * one + math.sin(share * angle) * other) / math.sin(angle))


def _share_of_a_curve(inputs: Inputs) -> float:
    """By how much a point of effort and speed would have to shrink to lie on a curve: by halving an interval."""
    speeds, efforts = inputs.array("speeds", -1), inputs.array("efforts", -1)
    if len(speeds) != len(efforts) or (np.diff(speeds) <= 0.0).any():
        raise NotReplayed("the curve does not ascend")
    speed, effort = abs(inputs.number("speed")), abs(inputs.number("effort"))

    def beyond(shrunk: float) -> bool:
        fast = speed / shrunk
        return fast > speeds[-1] or effort / shrunk > float(np.interp(fast, speeds, efforts))

    low, high = 1e-9, 1e9
    for _ in range(200):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if beyond(middle) else (low, middle)
    return high


def _work_of_weights(inputs: Inputs) -> float:
    """Effort of a joint by virtual work: what weights, loads and springs lose as the joint is moved a little both
    ways."""
    masses, centres = inputs.array("masses", -1), inputs.array("centres", -1, 3)
    motions, loads = inputs.array("motions", -1, 6), inputs.array("loads", -1, 6)
    gravity = inputs.array("gravity", 3)
    if not len(masses) == len(centres) == len(motions) == len(loads):
        raise NotReplayed("its inputs are of different numbers of bodies")
    step = 1e-5
    work = inputs.number("springs")
    for m, c, motion, load in zip(masses, centres, motions, loads, strict=True):
        ahead, back = (_small(way * step * motion) for way in (1.0, -1.0))
        lost = m * gravity @ ((ahead - back)[:3, :3] @ c + (ahead - back)[:3, 3])
        lost += load[:3] @ (ahead - back)[:3, 3]
        spin = (ahead - back)[:3, :3]
        lost += load[3:] @ np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        work += float(lost) / (2.0 * step)
    return abs(work)


def _loss_by_friction(inputs: Inputs) -> float:
    """Effort without friction less what friction holds; or how far the share of the work that comes out is below the
    least. The friction itself is not recomputed."""
    without = inputs.number("without")
    if inputs.has("needed"):
        needed = inputs.number("needed")
        return inputs.number("minimum") - (without / needed if needed != 0.0 else 0.0)
    return without - inputs.number("friction")


def _reach_of_a_chain(inputs: Inputs) -> float:
    """How near a carried point (m), or direction (rad), comes to an aim: by a general optimiser from a grid of starts,
    with a product of matrix exponentials."""
    from scipy.optimize import minimize

    screws, aim, carried = inputs.array("screws", -1, 6), inputs.array("aim", 3), inputs.array("carried", 3)
    low, high = inputs.array("lower", len(screws)), inputs.array("upper", len(screws))
    pointing = bool(inputs.number("pointing"))
    if not 0 < len(screws) <= SCREWS_MOST or (low > high).any():
        raise NotReplayed(f"chains of more than {SCREWS_MOST} coordinates are not replayed")
    turns = np.abs(screws[:, :3]).max(axis=1) > 0.0
    low, high = np.where(turns, np.maximum(low, -math.pi), low), np.where(turns, np.minimum(high, math.pi), high)

    def image(q: Array) -> Array:
        x = carried if pointing else np.append(carried, 1.0)
        for screw, value in zip(screws[::-1], q[::-1], strict=True):
            X = _small(screw * value)
            x = X[:3, :3] @ x if pointing else X @ x
        return x[:3]

    def missed(q: Array) -> float:
        if pointing:
            return math.atan2(float(np.linalg.norm(np.cross(image(q), aim))), float(image(q) @ aim))
        return float(np.linalg.norm(image(q) - aim))

    best = math.inf
    many = max(2, int(STARTS ** (1.0 / len(screws))))
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, many) for a, b in zip(low, high, strict=True))), axis=-1)
    starts = grid.reshape(-1, len(screws))
    starts = starts[np.argsort([missed(q) for q in starts], kind="stable")][:APPROACHED]
    for start in starts:
        bounds = list(zip(low, high, strict=True))
        found = minimize(lambda q: missed(q) ** 2, start, method="L-BFGS-B", bounds=bounds)
        best = min(best, missed(found.x))
    return best


EQUATIONS: Mapping[str, tuple[Callable[[Inputs], float], float]] = {
    "angle of directions": (_angle_of_directions, ROUNDED),
    "balanced pushes": (_balanced_pushes, 1e-2),
    "centre off a point": (_centre_off_a_point, ROUNDED),
    "closing of loops": (_closing_of_loops, 0.5),
    "coordinate step": (_coordinate_step, 1e-3),
    "density of the hull": (_density_of_the_hull, 1e-3),
    "distance of lines": (_distance_of_lines, 1e-4),
    "distance of points": (_distance_of_points, ROUNDED),
    "edge uses": (_edge_uses, ROUNDED),
    "effort of motion": (_effort_of_motion, 0.03),
    "end of a guide": (_end_of_a_guide, 1e-3),
    "facet faces inwards": (_facet_faces_inwards, ROUNDED),
    "fit of surfaces": (_fit_of_surfaces, 1e-2),
    "freedoms of a graph": (_freedoms_of_a_graph, ROUNDED),
    "freedoms of twists": (_freedoms_of_twists, ROUNDED),
    "hull of a mass": (_hull_of_a_mass, 1e-3),
    "imbalance about a line": (_imbalance_about_a_line, ROUNDED),
    "impossible inertia": (_impossible_inertia, ROUNDED),
    "inertia about a line": (_inertia_about_a_line, ROUNDED),
    "inertia beyond reach": (_inertia_beyond_reach, 1e-3),
    "lead of a twist": (_lead_of_a_twist, ROUNDED),
    "loss by friction": (_loss_by_friction, ROUNDED),
    "mass of shapes": (_mass_of_shapes, ROUNDED),
    "motion that opens": (_motion_that_opens, 1e-3),
    "path and motion": (_path_and_motion, 1e-3),
    "rate of positions": (_rate_of_positions, 0.01),
    "ratio of rates": (_ratio_of_rates, ROUNDED),
    "ratio of sizes": (_ratio_of_sizes, 1e-3),
    "reach of a chain": (_reach_of_a_chain, 0.05),
    "record of a run": (_record_of_a_run, ROUNDED),
    "share of a curve": (_share_of_a_curve, 1e-6),
    "sum of rates": (_sum_of_rates, ROUNDED),
    "time of a run": (_time_of_a_run, ROUNDED),
    "volume of a file": (_volume_of_a_file, 1e-3),
    "work of weights": (_work_of_weights, 1e-5),
}
"""Each equation of `Equation`, and the share by which its residual may differ from the stated one."""
