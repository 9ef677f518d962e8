"""The links of an SDF: their shapes, and what is stated of their mass."""

from __future__ import annotations

from dataclasses import replace

from kinform.formats.description.elements import Element, colour_of, tag_of
from kinform.formats.description.inertials import placed, symmetric
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.robot import Inertial, Link, Shape, Solid, Stated
from kinform.formats.description.tree import Count
from kinform.formats.sdf.reading.frames import Frames
from kinform.formats.sdf.reading.models import Model
from kinform.formats.sdf.reading.values import Values
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.model.arrays import Array

_LINK = ("pose", "visual", "collision", "inertial", "gravity", "self_collide", "kinematic", "enable_wind",
         "velocity_decay", "must_be_base_link")  # fmt: skip
_SIZES = {
    "box": (("size", 3),), "sphere": (("radius", 1),), "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)), "ellipsoid": (("radii", 3),),
}  # fmt: skip
_LEFT = ("plane", "heightmap", "image", "polyline", "cone", "empty")


class Links:
    """Reads links that were noted, once all frames are known."""

    def __init__(self, values: Values, frames: Frames, meshes: MeshFiles, left: Count):
        self.xml, self.values, self.frames, self.meshes, self.left = values.xml, values, frames, meshes, left
        self.stated: dict[str, tuple[Model, Element]] = {}

    def read(self) -> dict[str, Link]:
        """The links whose poses are known, by their full names."""
        out = {}
        for name, (model, element) in self.stated.items():
            X = self.frames.pose(name)
            if X is not None:
                out[name] = self._link(name, model, element, X)
        return out

    def _link(self, name: str, model: Model, element: Element, X: Array) -> Link:
        for child in self.xml.children(element):
            if tag_of(child) not in _LINK:
                self.left.add(f"<{tag_of(child)}> of links")
        visual, collision = (
            tuple(s for e in self.xml.children(element, tag) if (s := self._shape(e, name, model, X)) is not None)
            for tag in ("visual", "collision")
        )
        inertial = self.xml.child(element, "inertial")
        stated = None if inertial is None else self._inertial(inertial, name, X)
        written = None if inertial is None else self._stated(inertial)
        return Link(name, X, self.xml.at(element), visual, collision, stated, written)

    def _stated(self, element: Element) -> Stated | None:
        """What an inertial says, word for word; None without a mass."""
        numbers = self.xml.child(element, "inertia")
        if self.xml.child(element, "mass") is None or (element.get("auto") or "").strip().lower() in ("1", "true"):
            return None
        keys = (("ixx", 1.0), ("iyy", 1.0), ("izz", 1.0), ("ixy", 0.0), ("ixz", 0.0), ("iyz", 0.0))
        six = None if numbers is None else tuple(self.values.finite(numbers, key, default) for key, default in keys)
        return Stated(self.values.finite(element, "mass", 1.0), six, self.xml.at(element))

    def _posed(self, element: Element, model: Model, X_FL: Array) -> Array | None:
        """The pose (4, 4) in F of what is in a link."""
        X, relative = self.values.pose(element)
        if not relative:
            return X_FL @ X
        full = self.frames.full(model.scope, relative, element, "the pose: its relative_to")
        X_FR = None if full is None else self.frames.pose(full)
        return None if X_FR is None else X_FR @ X

    def _shape(self, element: Element, link: str, model: Model, X_FL: Array) -> Shape | None:
        what = f"link {in_quotes(link)}"
        kind = next(self.xml.children(self.xml.child(element, "geometry")), None)
        if kind is None:
            wrong = f"{what}: <{tag_of(element)}> has no geometry"
            self.xml.complain(element, wrong, "add <geometry> with a mesh, box, cylinder or sphere")
            return None
        X = self._posed(element, model, X_FL)
        if X is None:
            return None
        label = (element.get("name") or "").strip().replace("/", "_") or None
        tag = tag_of(kind)
        if tag == "mesh":
            shape = self._mesh(kind, what, model, label, X)
            return None if shape is None else replace(shape, colour=self._colour(element))
        if tag in _LEFT:
            self.left.add(f"geometry <{tag}>")
            return None
        solid = self._solid(kind, what)
        if solid is None:
            return None
        return Shape(label, solid, (1.0, 1.0, 1.0), X, self.xml.at(kind), colour=self._colour(element))

    def _colour(self, element: Element) -> str | None:
        """What a visual scatters, where it states that."""
        material = self.xml.child(element, "material")
        return None if material is None else colour_of(self.values.text(material, "diffuse"))

    def _mesh(self, kind: Element, what: str, model: Model, label: str | None, X: Array) -> Shape | None:
        x, y, z = self.values.vector(kind, "scale", (1.0, 1.0, 1.0))
        uri = self.values.text(kind, "uri") or self.values.text(kind, "filename")
        if 0.0 in (x, y, z):
            self.xml.complain(kind, f"{what}: the scale of its mesh has a zero", "give <scale>1 1 1</scale>")
            return None
        if uri is None:
            self.xml.complain(kind, f"{what}: its mesh names no file", "add <uri>…</uri>")
            return None
        found = self.meshes.find(uri, model.folder)
        if found.path is None:
            self.xml.not_found(kind, f"{what}: the mesh", found)
            return None
        if self.xml.child(kind, "submesh") is not None:
            self.left.add("<submesh>: the whole file is taken")
        return Shape(label, found.path, (x, y, z), X, self.xml.at(kind))

    def _solid(self, kind: Element, what: str) -> Solid | None:
        tag = tag_of(kind)
        if tag not in _SIZES:
            wrong = f"{what}: geometry <{tag}> is not known"
            self.xml.complain(kind, wrong, did_you_mean(tag, [*_SIZES, "mesh"], "the kinds"))
            return None
        sizes: tuple[float, ...] = ()
        for key, count in _SIZES[tag]:
            if self.values.text(kind, key) is None:
                self.xml.complain(kind, f"{what}: <{tag}> has no {key}", f"add <{key}>…</{key}>")
                return None
            sizes += self.values.vector(kind, key, (1.0,) * count)
        if min(sizes) <= 0.0:
            self.xml.complain(kind, f"{what}: <{tag}> has a size that is not positive", "give positive lengths")
            return None
        return Solid(tag, sizes)

    def _inertial(self, element: Element, link: str, X_FL: Array) -> Inertial | None:
        numbers = self.xml.child(element, "inertia")
        if (element.get("auto") or "").strip().lower() in ("1", "true"):
            return None
        if self.xml.child(element, "fluid_added_mass") is not None:
            self.left.add("<fluid_added_mass> of links")
        if self.xml.child(element, "mass") is None or numbers is None:
            self.left.notes.append(f"link {in_quotes(link)} states no mass, or no inertia: taken as not stated")
            return None
        mass = self.values.finite(element, "mass", 1.0)
        if mass <= 0.0:
            self.left.notes.append(f"link {in_quotes(link)} states the mass {mass:g} kg: taken as not stated")
            return None
        keys = (("ixx", 1.0), ("iyy", 1.0), ("izz", 1.0), ("ixy", 0.0), ("ixz", 0.0), ("iyz", 0.0))
        six = [self.values.finite(numbers, key, default) for key, default in keys]
        X, _ = self.values.pose(element)
        return placed(mass, X_FL @ X, symmetric(*six), self.xml.at(element))
