"""What each stage sees of the assembly, which is also what its fingerprint covers.

A stage is given these reduced assemblies instead of the whole one, so it cannot come to depend on
something that its fingerprint leaves out: a moved line in the manifest or a requirement that was added
reaches the findings and nothing before them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from kinform.model.assembly import Assembly, Mesh, Part, Source
from kinform.model.checks import CheckSettings
from kinform.model.function import Function, Law, SimulationRequest

if TYPE_CHECKING:
    pass

__all__ = ["assembly_for", "bare_mesh"]

_NOWHERE = Source("")


def assembly_for(stage: str, assembly: Assembly) -> Assembly:
    """The assembly as the stage contacts, joints, mass, simulation or findings sees it."""
    return _VIEWS[stage](assembly)


def bare_mesh(mesh: Mesh) -> Mesh:
    """The shape, without the file that it came from."""
    return mesh.bare


def _shapes(assembly: Assembly) -> Assembly:
    """Shapes and poses, groups, and pairs that are declared not to touch."""
    return replace(
        _bare(assembly),
        parts=_weightless(_bare(assembly).parts),
        assumptions=tuple(
            replace(a, type=None, axis=None, point=None, pitch=None, reason="", source=_NOWHERE)
            for a in assembly.assumptions
            if a.ignore
        ),
        ground=None,
        infer_fasteners=False,
        function=Function(),
        simulation=None,
    )


def _bodies_and_joints(assembly: Assembly) -> Assembly:
    """What decides bodies and joints: of the function, only the joints that it names, and where there are no meshes its
    couplings; densities, only where the heaviest body becomes the ground."""
    bare, function = _bare(assembly), _bare_function(assembly.function)
    joints = tuple(replace(joint, range=None) for joint in function.joints)
    parts = bare.parts if bare.ground is None else _weightless(bare.parts)
    couplings = () if any(part.mesh is not None for part in parts) else function.couplings
    return replace(bare, parts=parts, function=Function(joints=joints, couplings=couplings), simulation=None)


def _densities(assembly: Assembly) -> Assembly:
    """Shapes, poses, densities and stated masses."""
    return replace(
        _bare(assembly),
        groups=(),
        assumptions=(),
        ground=None,
        infer_fasteners=False,
        function=Function(),
        simulation=None,
    )


def _motion(assembly: Assembly) -> Assembly:
    """Everything but requirements and the intended mobility."""
    function = replace(_bare_function(assembly.function), mobility=None, requirements=())
    request = None if assembly.simulation is None else _bare_request(assembly.simulation)
    return replace(_bare(assembly), function=function, simulation=request)


def _everything(assembly: Assembly) -> Assembly:
    return assembly


_VIEWS: dict[str, Callable[[Assembly], Assembly]] = {
    "contacts": _shapes,
    "joints": _bodies_and_joints,
    "mass": _densities,
    "simulation": _motion,
    "findings": _everything,
}


def _bare(assembly: Assembly) -> Assembly:
    """Without names of files, lines and materials; meshes stay shared."""
    meshes = {id(part.mesh): bare_mesh(part.mesh) for part in assembly.parts if part.mesh is not None}
    return replace(
        assembly,
        name="",
        parts=tuple(_bare_part(part, meshes.get(id(part.mesh))) for part in assembly.parts),
        groups=tuple(replace(group, source=_NOWHERE) for group in assembly.groups),
        assumptions=tuple(replace(a, source=_NOWHERE) for a in assembly.assumptions),
        subassemblies=(),
        source=_NOWHERE,
        files=(),
        notes=(),
        check=CheckSettings(),
    )


def _weightless(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    return tuple(replace(part, density=None, override=None) for part in parts)


def _bare_part(part: Part, mesh: Mesh | None) -> Part:
    return replace(part, mesh=mesh, material=None, units="m", source=_NOWHERE)


def _bare_function(function: Function) -> Function:
    return Function(
        mobility=function.mobility,
        joints=tuple(replace(joint, file="", line=None) for joint in function.joints),
        couplings=tuple(replace(coupling, file="", line=None) for coupling in function.couplings),
        drives=tuple(replace(drive, file="", line=None, law=_bare_law(drive.law)) for drive in function.drives),
        loads=tuple(replace(load, file="", line=None) for load in function.loads),
        requirements=function.requirements,
    )


def _bare_law(law: Law | None) -> Law | None:
    return None if law is None else replace(law, file=None)


def _bare_request(request: SimulationRequest) -> SimulationRequest:
    initial = tuple(replace(value, file="", line=None) for value in request.initial)
    return replace(request, initial=initial, file=None, line=None)
