"""What the bodies of an MJCF are made of: geoms, the meshes that they name, and stated masses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.form.meshes.raw import REEXPORT, MeshError, RawMesh, scaled
from kinform.formats.description.elements import Element, Xml, colour_of, tag_of
from kinform.formats.description.inertials import placed, symmetric
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.poses import pose
from kinform.formats.description.robot import Inertial, Shape, Solid, Stated
from kinform.formats.description.tree import Count
from kinform.formats.mjcf.reading.defaults import Compiler, Defaults, from_z, mesh_assets
from kinform.formats.mjcf.reading.fits import FITTED, fitted
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.model.arrays import Array

_UNCOLOURED: tuple[list[str], ...] = ([], ["0.5", "0.5", "0.5", "1"], [".5", ".5", ".5", "1"])


class Shapes:
    """Reads what is in bodies."""

    def __init__(self, xml: Xml, root: Element, meshes: MeshFiles, compiler: Compiler, defaults: Defaults, left: Count):
        self._xml, self._meshes, self._compiler, self._defaults, self._left = xml, meshes, compiler, defaults, left
        self._assets = mesh_assets(xml, root, compiler, defaults)
        self._colours = {
            said.get("name", ""): colour_of(said.get("rgba"))
            for assets in xml.children(root, "asset")
            for said in (defaults.said(element, None) for element in xml.children(assets, "material"))
        }
        self.files: set[Path] = set()
        """Meshes that were read, for what was fitted to them."""
        self._raw: dict[Path, RawMesh] = {}
        self._with_inertial: dict[Element, bool] = {}
        """Whether a body states its mass."""

    def inertial(self, element: Element, name: str, X: Array) -> Inertial | None:
        """The stated mass of a body whose pose in F is X; None after noting that there is none."""
        xml, said = self._xml, element.attrib
        mass = xml.number(element, "mass") or 0.0
        full = xml.vector(element, "fullinertia", (0.0,) * 6)
        diagonal = xml.vector(element, "diaginertia", (0.0,) * 3)
        if mass <= 0.0:
            self._left.notes.append(f"body {in_quotes(name)} states the mass {mass:g} kg: taken as not stated")
            return None
        six = full if "fullinertia" in said else (*diagonal, 0.0, 0.0, 0.0)
        return placed(mass, X @ self._compiler.pose(xml, element, said), symmetric(*six), xml.at(element))

    def stated(self, element: Element) -> Stated | None:
        """What an inertial says, word for word; None without a mass."""
        mass = self._xml.number(element, "mass")
        full = self._xml.vector(element, "fullinertia", (0.0,) * 6)
        diagonal = self._xml.vector(element, "diaginertia", (0.0,) * 3)
        six = full if "fullinertia" in element.attrib else (*diagonal, 0.0, 0.0, 0.0)
        return None if mass is None else Stated(mass, six, self._xml.at(element))

    def _colour(self, said: Mapping[str, str]) -> str | None:
        """The colour of a geom: its own, or else of its material; grey is what MuJoCo takes for not stated."""
        own = said.get("rgba", "")
        stated = None if own.split() in _UNCOLOURED else colour_of(own)
        return stated or self._colours.get(said.get("material", ""))

    def geom(self, element: Element, link: str, X: Array, named: str | None) -> tuple[Shape | None, bool]:
        """The shape of a geom, and whether it is seen only: it collides with nothing."""
        said = self._defaults.said(element, named)
        self._leave_out_mass(element, said)
        shape, seen = self._geom(element, said, link, X)
        return None if shape is None else replace(shape, colour=self._colour(said)), seen

    def _leave_out_mass(self, element: Element, said: Mapping[str, str]) -> None:
        """Masses that a geom states are those of its body where that has no `<inertial>`: they are not carried."""
        body = element.getparent()
        while tag_of(body) == "frame":
            body = body.getparent()
        if body not in self._with_inertial:
            self._with_inertial[body] = self._xml.child(body, "inertial") is not None
        inertial = self._with_inertial[body] and not self._compiler.from_geometry
        for key in ("mass", "density"):
            if tag_of(body) == "body" and not inertial and said.get(key, "0").strip(" 0.") != "":
                self._left.add(f"{key} of geoms")

    def _geom(self, element: Element, said: Mapping[str, str], link: str, X: Array) -> tuple[Shape | None, bool]:
        xml = self._xml
        kind = said.get("type", "sphere")
        seen = said.get("contype", "1").strip() == "0" and said.get("conaffinity", "1").strip() == "0"
        X_FG = X @ self._compiler.pose(xml, element, said)
        name = (said.get("name") or "").replace("/", "_") or None
        if kind == "mesh" or (kind == "sdf" and "mesh" in said):
            return self._mesh(element, said, link, X_FG, name), seen
        if kind in FITTED and "mesh" in said:
            return self._fitted(element, said, link, X_FG, name, kind), seen
        if kind in ("plane", "hfield", "sdf"):
            self._left.add(f"geom of type {kind}")
            return None, seen
        size = list(xml.numbers(element, said.get("size", ""), "size", None) or ())
        if "fromto" in said:
            ends = np.array(xml.numbers(element, said["fromto"], "fromto", 6) or (0.0,) * 5 + (1.0,)).reshape(2, 3)
            X_FG = X @ pose(from_z(ends[0] - ends[1]), 0.5 * (ends[0] + ends[1]))
            half = 0.5 * float(np.linalg.norm(ends[0] - ends[1]))
            size = [*size[:1], half] if kind in ("capsule", "cylinder") else [*(size[:1] * 2), half]
        count = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}.get(kind)
        if count is None:
            xml.complain(element, f"geom type {in_quotes(kind)} is not known", "give box, cylinder, sphere or mesh")
            return None, seen
        if len(size) < count or min(size[:count]) <= 0.0:
            xml.complain(element, f"a {kind} of {in_quotes(link)} needs {count} positive sizes", 'give size="…"')
            return None, seen
        sizes = {"box": [2.0 * s for s in size[:3]], "cylinder": [size[0], 2.0 * size[-1]]}.get(kind, size[:count])
        if kind in ("capsule", "cylinder"):
            sizes = [size[0], 2.0 * size[1]]
        return Shape(name, Solid(kind, tuple(sizes)), (1.0, 1.0, 1.0), X_FG, xml.at(element)), seen

    def _fitted(
        self, element: Element, said: Mapping[str, str], link: str, X: Array, name: str | None, kind: str
    ) -> Shape | None:
        """The primitive that is fitted to a mesh; None after noting why there is none."""
        mesh = self._mesh(element, said, link, X, name)
        if mesh is None or not isinstance(mesh.geometry, Path):
            return None
        if not mesh.geometry.is_file():
            return mesh  # which is told as any mesh that is not there
        inertia, around = self._assets[said["mesh"]].inertia, self._compiler.fit_around
        scale = (self._xml.numbers(element, said.get("fitscale", "1"), "fitscale", 1) or (1.0,))[0]
        if scale <= 0.0:
            self._xml.complain(element, "<geom>: fitscale is not positive", 'give fitscale="1"')
            return None
        try:
            raw = scaled(self._read(mesh.geometry), mesh.scale)
        except (MeshError, OSError) as error:
            wrong = f"mesh {in_quotes(said['mesh'])}, to which a {kind} is fitted, {error}"
            self._xml.complain(self._assets[said["mesh"]].element, wrong, REEXPORT)
            return None
        fit = fitted(kind, np.asarray(raw.vertices, np.float64), raw.faces, inertia, scale, around=around)
        if fit is None:
            self._left.add(f"{kind} fitted to a mesh that is flat")
            return None
        self.files.add(mesh.geometry)
        return replace(mesh, geometry=fit.solid, scale=(1.0, 1.0, 1.0), X_FG=mesh.X_FG @ fit.X)

    def _read(self, path: Path) -> RawMesh:
        """The facets of a mesh that lies where the description may look; once a file."""
        from kinform.form.files import read_raw  # which asks for readers of descriptions itself

        if path not in self._raw:
            self._raw[path] = read_raw(path, self._meshes.boundary)
        return self._raw[path]

    def _mesh(self, element: Element, said: Mapping[str, str], link: str, X: Array, name: str | None) -> Shape | None:
        stated = said.get("mesh", "")
        asset = self._assets.get(stated)
        if asset is None:
            wrong = f"body {in_quotes(link)}: there is no mesh {in_quotes(stated)}"
            self._xml.complain(element, wrong, did_you_mean(stated, self._assets, "the meshes"))
            return None
        if not asset.file:
            self._left.add("mesh without file")
            return None
        if asset.X is None:
            self._left.add("mesh that its scale shears in its reference frame")
            return None
        found = self._meshes.find(asset.file, self._meshes.folder / self._compiler.folder)
        if found.path is None:
            self._xml.not_found(asset.element, f"mesh {in_quotes(stated)}", found)
            return None
        return Shape(name, found.path, asset.scale, X @ asset.X, self._xml.at(element))
