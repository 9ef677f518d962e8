"""What each stage sees of the assembly, which is also what its fingerprint covers.

A stage is given these reduced assemblies instead of the whole one, so it cannot come to depend on something that its
fingerprint leaves out: a moved line in the manifest or a requirement that was added reaches the findings and nothing
before them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.model.assembly import Assembly, Part, Source
from kinform.model.checks import CheckSettings
from kinform.model.function import Function, Law, SimulationRequest

NOWHERE = Source("")
UNSCALED = np.ones(3)
"""The scale of a mesh that is as its file has it."""


def for_contacts(assembly: Assembly) -> Assembly:
    """Shapes and poses, groups, and pairs that are declared not to touch."""
    return replace(
        _bare(assembly),
        parts=_weightless(_bare(assembly).parts),
        groups=tuple(replace(group, override=None) for group in _bare(assembly).groups),
        assumptions=tuple(
            replace(a, type=None, axis=None, point=None, pitch=None, reason="", source=NOWHERE)
            for a in assembly.assumptions
            if a.ignore
        ),
        ground=None,
        infer_fasteners=False,
        function=Function(),
        simulation=None,
    )


def for_joints(assembly: Assembly) -> Assembly:
    """What decides bodies and joints: of the function, only the joints that it names, and where there are no meshes its
    couplings; densities, only where the heaviest body becomes the ground."""
    bare, function = _bare(assembly), _bare_function(assembly.function)
    joints = tuple(replace(joint.as_named, range=None) for joint in function.joints)
    parts = bare.parts if bare.ground is None else _weightless(bare.parts)
    groups = bare.groups if bare.ground is None else tuple(replace(g, override=None) for g in bare.groups)
    couplings = () if any(part.mesh is not None for part in parts) else function.couplings
    stated = Function(joints=joints, couplings=couplings, complete=function.complete)
    return replace(bare, parts=parts, groups=groups, function=stated, simulation=None)


def for_mass(assembly: Assembly) -> Assembly:
    """Shapes, poses, densities and stated masses, of groups too."""
    bare = _bare(assembly)
    return replace(
        bare,
        groups=tuple(group for group in bare.groups if group.override is not None),
        assumptions=(),
        ground=None,
        infer_fasteners=False,
        function=Function(complete=assembly.function.complete),
        simulation=None,
    )


def for_motion(assembly: Assembly) -> Assembly:
    """Everything but requirements and the intended mobility."""
    function = replace(_bare_function(assembly.function), mobility=None, requirements=())
    request = None if assembly.simulation is None else _bare_request(assembly.simulation)
    out = replace(_bare(assembly), function=function, simulation=request)
    if any(drive.kind == "friction" for drive in function.drives):
        # Materials say how much there is.
        named = zip(out.parts, assembly.parts, strict=True)
        out = replace(out, parts=tuple(replace(part, material=own.material) for part, own in named))
    return out


def everything(assembly: Assembly) -> Assembly:
    """All of it: findings say where in the manifest things are."""
    return assembly


def _bare(assembly: Assembly) -> Assembly:
    """Without names of files, lines and materials; meshes stay shared."""
    return replace(
        assembly,
        name="",
        parts=tuple(map(_bare_part, assembly.parts)),
        groups=tuple(replace(group, source=NOWHERE) for group in assembly.groups),
        assumptions=tuple(replace(a, source=NOWHERE) for a in assembly.assumptions),
        subassemblies=(),
        source=NOWHERE,
        files=(),
        notes=(),
        check=CheckSettings(),
        descriptions=(),
    )


def _weightless(parts: tuple[Part, ...]) -> tuple[Part, ...]:
    return tuple(replace(part, density=None, override=None) for part in parts)


def _bare_part(part: Part) -> Part:
    mesh = part.mesh and part.mesh.bare
    return replace(part, mesh=mesh, material=None, units="m", scale=UNSCALED, source=NOWHERE, colour=None)


def _bare_function(function: Function) -> Function:
    return Function(
        mobility=function.mobility,
        joints=tuple(replace(joint, file="", line=None) for joint in function.joints),
        couplings=tuple(replace(coupling, file="", line=None) for coupling in function.couplings),
        drives=tuple(replace(drive, file="", line=None, law=_bare_law(drive.law)) for drive in function.drives),
        loads=tuple(replace(load, file="", line=None, law=_bare_law(load.law)) for load in function.loads),
        springs=tuple(replace(spring, file="", line=None) for spring in function.springs),
        requirements=function.requirements,
        frictions=tuple(replace(one, file="", line=None) for one in function.frictions),
        complete=function.complete,
    )


def _bare_law(law: Law | None) -> Law | None:
    return None if law is None else replace(law, file=None)


def _bare_request(request: SimulationRequest) -> SimulationRequest:
    initial = tuple(replace(value, file="", line=None) for value in request.initial)
    sensors = tuple(replace(sensor, file="", line=None) for sensor in request.sensors)
    return replace(request, initial=initial, sensors=sensors, file=None, line=None)
