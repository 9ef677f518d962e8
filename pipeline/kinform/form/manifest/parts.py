"""Tables that state form: assembly, materials, parts, groups, sub-assemblies, assumptions, tolerances."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import (
    Colour,
    Finite,
    JointType,
    Matrix,
    Name,
    NonNegative,
    Pair,
    Path,
    Posed,
    Positive,
    Reference,
    Table,
    Unit,
    Vector,
)


class AssemblyTable(Table):
    """`[assembly]`."""

    name: Name = Field(description="name of the assembly, any text but '/'")
    units: Unit = Field(
        description="lengths of this file and of its meshes, unless they say their own: m, cm, mm, um, in or ft"
    )
    from_: Reference | None = Field(
        None,
        alias="from",
        description="a robot description (URDF, xacro, SDF, MJCF), or a CAD or scene file (STEP, GLB), that says the "
        "rest; tables of the same name override it",
    )
    ground: Reference | None = Field(
        None, description="the part or group at rest; default the heaviest body (largest without densities)"
    )


class Material(Table):
    """`[materials.NAME]`."""

    density: Positive = Field(description="kg/m³, whatever the units of the file")


class FrictionTable(Table):
    """`[[friction]]`: Coulomb friction between two materials, for frictions that state no coefficient.

    It holds between the parts of the file and of its sub-assemblies."""

    materials: Annotated[list[Name], Field(min_length=2, max_length=2)] = Field(
        description="two materials, the same twice where it rubs on itself"
    )
    coefficient: NonNegative = Field(description="in motion")
    static: NonNegative | None = Field(None, description="at rest; default as in motion")


class BoxShape(Table):
    """A box about the origin of the part."""

    type: Literal["box"]
    size: Annotated[list[Positive], Field(min_length=3, max_length=3)] = Field(description="lengths along x, y, z")


class CylinderShape(Table):
    """A cylinder about the z axis of the part, its middle at the origin."""

    type: Literal["cylinder"]
    radius: Positive = Field(description="radius")
    length: Positive = Field(description="length along z")


class CapsuleShape(Table):
    """A cylinder with half balls at its ends, about the z axis of the part, its middle at the origin."""

    type: Literal["capsule"]
    radius: Positive = Field(description="radius")
    length: Positive = Field(description="length of the cylinder, without the half balls")


class SphereShape(Table):
    """A ball about the origin of the part."""

    type: Literal["sphere"]
    radius: Positive = Field(description="radius")


class EllipsoidShape(Table):
    """An ellipsoid about the origin of the part."""

    type: Literal["ellipsoid"]
    radii: Annotated[list[Positive], Field(min_length=3, max_length=3)] = Field(description="along x, y, z")


ShapeTable = Annotated[
    BoxShape | CylinderShape | CapsuleShape | SphereShape | EllipsoidShape, Field(discriminator="type")
]


class Part(Posed):
    """`[[part]]`."""

    name: Path = Field(
        description="name of the part, any text but '/', which separates sub-assemblies (and groups of a scene file)"
    )
    mesh: Reference | None = Field(
        None,
        description="STL or OBJ file (also DAE, GLB, glTF, 3MF, STEP, PLY, OFF), relative to the manifest; absent: a "
        "stick body",
    )
    shape: ShapeTable | None = Field(None, description="a primitive in place of a mesh: box, cylinder, sphere, …")
    scale: Vector | None = Field(
        None, description="factors along the axes of the mesh, [1, -1, 1] mirrors it; default [1, 1, 1]"
    )
    body: Reference | None = Field(
        None,
        description="one body of a mesh file that holds several: OBJ o or g, ASCII solid, mesh of a GLB, 'shell N'",
    )
    units: Unit | None = Field(
        None,
        description="length unit of this mesh, where it is another than the assembly's, or than that of its format "
        "(GLB, glTF, 3MF, DAE and STEP say their own)",
    )
    material: Reference | None = Field(None, description="a [materials.NAME] or a built-in material")
    density: Positive | None = Field(None, description="kg/m³; in place of material")
    mass: Positive | None = Field(None, description="kg; overrides the geometry, with centre_of_mass and inertia")
    centre_of_mass: Vector | None = Field(None, description="three lengths in the part frame; with mass")
    inertia: Matrix | None = Field(None, description="3×3, kg·m², about the centre of mass, part axes; with mass")
    colour: Colour | None = Field(None, description="'#rrggbb', to be seen; default that of the mesh file, if any")
    solid: bool = Field(True, description="false: surfaces only; contacts yes, mass no, need not be watertight")


class Group(Table):
    """`[[group]]`: parts fastened by means that the geometry does not show."""

    name: Name = Field(description="name of the group, any text but '/'")
    parts: Annotated[list[Reference], Field(min_length=1)] = Field(
        description="names of the parts, those of sub-assemblies as 'sub-assembly/part'"
    )
    mass: Positive | None = Field(None, description="kg of the whole group; with centre_of_mass and inertia")
    centre_of_mass: Vector | None = Field(None, description="three lengths in the frame of this manifest; with mass")
    inertia: Matrix | None = Field(
        None, description="3×3, kg·m², about the centre of mass, along the axes of this manifest; with mass"
    )


class Subassembly(Posed):
    """`[[subassembly]]`: another manifest, or a robot description, placed as a whole."""

    name: Name = Field(description="prefix of its parts, groups and joints, any text but '/'")
    file: Reference = Field(description="manifest or robot description, relative to this one")


class Assume(Table):
    """`[[assume]]`: the user overrides what geometry says of two parts or groups."""

    between: Pair = Field(description="two parts or groups")
    type: JointType | None = Field(None, description="the joint that is assumed")
    ignore: bool = Field(False, description="true: these two do not touch")
    axis: Vector | None = Field(None, description="direction of the axis; the normal of a planar joint")
    axis2: Vector | None = Field(None, description="second axis of a universal joint")
    point: Vector | None = Field(None, description="point on the axis; the centre of a spherical joint")
    pitch: Finite | None = Field(None, description="length a turn of a screw, right-handed positive")
    reason: str = Field("", description="why; shown wherever the assumption has an effect")


class TolerancesTable(Table):
    """`[tolerances]`."""

    contact: Positive | None = Field(
        None,
        description="gap or overlap up to which surfaces mate; default by shares of the parts' sizes and walls",
    )
    weld: NonNegative | None = Field(
        None, description="vertices closer than this are one; default 1e-6 of the part's size"
    )
    alignment: Annotated[float, Field(ge=0, le=45, allow_inf_nan=False)] | None = Field(
        None, description="degrees within which two axes of one pair mate; default 0.2"
    )
    axis_angle: Annotated[float, Field(ge=0, le=45, allow_inf_nan=False)] | None = Field(
        None, description="degrees by which a joint's axis may differ from the intended one; default: alignment"
    )
    axis_offset: NonNegative | None = Field(
        None,
        description="length by which a joint's axis may lie beside the intended one; default 0.5 % of the smaller body",
    )


class Fasteners(Table):
    """`[fasteners]`."""

    infer: bool = Field(False, description="true: suggested fastenings are applied, and labelled")
