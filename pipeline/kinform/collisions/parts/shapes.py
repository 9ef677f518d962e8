"""Parts with what collisions ask of them: surfaces that a motion maps onto themselves, borders, models."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from hashlib import blake2b

import fcl
import numpy as np

from kinform.collisions.parts.coarse_meshes import coarse_mesh
from kinform.collisions.parts.probes import Probes, probes
from kinform.collisions.parts.slippage import Allowed, OwnMotions, Slippage
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.boxes import box_corners
from kinform.foundation.meshes.fcl_adapter import fcl_model, partial_model
from kinform.foundation.meshes.mesh_index import MeshIndex, MeshStore
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.contacts import Contacts, Patch
from kinform.model.surfaces import MeshSurfaces

SCRAPE = 1e-3
"""By so much parts may overlap as they slide along each other: by rounding of their files and by what is left over
where joints were fitted."""
SCRAPE_ANGLES = 1.5
"""What a surface may be off an exact invariance, in alignment tolerances: a choice, above 1 as the axis of the joint
is off too."""


@dataclass
class Shapes:
    """Meshes with what is asked of them, each worked out once."""

    assembly: Assembly
    surfaces: dict[str, MeshSurfaces]
    contacts: Contacts | None
    body_parts: dict[str, frozenset[str]] = field(default_factory=dict)
    """Parts of each body that have a mesh."""
    _own: dict[str, OwnMotions] = field(default_factory=dict)
    _slippage: dict[tuple[str, bytes], Slippage] = field(default_factory=dict)
    _borders: dict[str, list[set[int]]] = field(default_factory=dict)
    _models: dict[tuple[str, bytes], fcl.BVHModel] = field(default_factory=dict)
    _probes: dict[tuple[str, bytes], Probes] = field(default_factory=dict)
    _store: MeshStore = field(default_factory=MeshStore)
    _coarse: dict[str, tuple[fcl.BVHModel, float]] = field(default_factory=dict)
    _patches: dict[tuple[str, str], list[Patch]] | None = None
    _parts: dict[str, Part] = field(default_factory=dict)

    def design(self) -> tuple[Assembly, dict[str, MeshSurfaces], Contacts | None]:
        """What it is made of."""
        return self.assembly, self.surfaces, self.contacts

    def part(self, name: str) -> Part:
        """The part of that name."""
        if not self._parts:
            self._parts = {part.name: part for part in self.assembly.parts}
        return self._parts[name]

    def mesh(self, name: str) -> Mesh:
        """Its mesh."""
        mesh = self.part(name).mesh
        assert mesh is not None
        return mesh

    @cached_property
    def size(self) -> float:
        """m: diagonal of the assembly's box at the pose of the meshes; 1 without meshes."""
        corners = []
        for name in sorted(name for parts in self.body_parts.values() for name in parts):
            index = self.index(name)
            corners.append(box_corners(index.low, index.high, self.part(name).X_WP))
        return float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0))) if corners else 1.0

    def surfaces_of(self, name: str) -> MeshSurfaces:
        """Its surfaces."""
        return self.surfaces[self.mesh(name).digest]

    def allowed(self, first: str, second: str) -> Allowed:
        """What surfaces of a pair may be off an exact invariance."""
        size = min(self.mesh(first).diagonal, self.mesh(second).diagonal)
        return Allowed(SCRAPE * size, SCRAPE_ANGLES * self.assembly.tolerances.alignment)

    def invariant(self, name: str, twists: Array, allowed: Allowed) -> Flags:
        """(s,) which surfaces of a part the motions `twists` (k, 6), in the world, map onto themselves."""
        key = (name, twists.tobytes())
        if key not in self._slippage:
            mesh = self.mesh(name)
            if mesh.digest not in self._own:
                self._own[mesh.digest] = OwnMotions(mesh, self.surfaces_of(name))
            X = self.part(name).X_WP
            omega = twists[:, :3] @ X[:3, :3]
            moment = (twists[:, 3:] + cross(twists[:, :3], np.broadcast_to(X[:3, 3], omega.shape))) @ X[:3, :3]
            self._slippage[key] = self._own[mesh.digest].slippage(np.hstack([omega, moment]))
        return self._slippage[key].within(allowed)

    def borders(self, name: str) -> list[set[int]]:
        """For each surface of a part, the surfaces that share an edge with it, and itself."""
        mesh, surfaces = self.mesh(name), self.surfaces_of(name)
        if mesh.digest not in self._borders:
            near: list[set[int]] = [{n} for n in range(len(surfaces.surfaces))]
            for a, b in self.index(name).borders(surfaces).tolist():
                near[a].add(b)
            self._borders[mesh.digest] = near
        return self._borders[mesh.digest]

    def overlapping(self, first: str, second: str) -> bool:
        """Whether the solids of two parts overlap at the pose of the meshes, other than where they mate."""
        overlaps = self.contacts.interferences if self.contacts is not None else ()
        return any(set(item.parts) == {first, second} and not item.mated for item in overlaps)

    def index(self, name: str) -> MeshIndex:
        """Its facets, to be asked for insides and distances."""
        return self._store.index(self.mesh(name))

    def model(self, name: str, facets: Ints | None = None) -> fcl.BVHModel:
        """FCL's model of some facets of a part (m, part frame)."""
        mesh = self.mesh(name)
        if facets is None or len(facets) == len(mesh.faces):
            return self.index(name).bvh
        key = (mesh.digest, facets.tobytes())
        if key not in self._models:
            self._models[key] = partial_model(mesh.vertices, mesh.faces[facets])
        return self._models[key]

    def probes(self, name: str, facets: Ints) -> Probes:
        """Points on some facets of a part: of the same mesh the same."""
        mesh = self.mesh(name)
        key = (mesh.digest, blake2b(facets.tobytes()).digest())
        if key not in self._probes:
            self._probes[key] = probes(mesh, self.surfaces_of(name).labels, facets)
        return self._probes[key]

    def coarse(self, name: str) -> tuple[fcl.BVHModel, float]:
        """FCL's model of a part by few facets, and how far (m) the part is off these at most; part frame."""
        mesh = self.mesh(name)
        if mesh.digest not in self._coarse:
            few = coarse_mesh(mesh)
            self._coarse[mesh.digest] = (self.index(name).bvh, 0.0) if few is None else (fcl_model(*few[:2]), few[2])
        return self._coarse[mesh.digest]

    def moved_facets(self, first: str, second: str, twists: Array) -> tuple[Ints, Ints]:
        """Facets of two parts on surfaces that the motions `twists` (k, 6) do not map onto themselves; all without
        any."""
        facets = []
        for name in (first, second):
            labels = self.surfaces_of(name).labels
            moves = np.ones(len(labels), dtype=bool)
            if len(twists):
                moves = ~self.invariant(name, twists, self.allowed(first, second))[labels]
            facets.append(np.flatnonzero(moves))
        return facets[0], facets[1]

    def patches(self, first: str, second: str) -> list[Patch]:
        """The patches between two parts, in either order."""
        if self._patches is None:
            self._patches = {}
            for patch in self.contacts.patches if self.contacts is not None else ():
                self._patches.setdefault(patch.parts, []).append(patch)
        return self._patches.get((min(first, second), max(first, second)), [])
