"""`kinform import`: from a manifest, or from meshes, to a results file that needs no other file."""

from __future__ import annotations

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    Depfile,
    Deviation,
    Geometry,
    GeometryKind,
    Output,
    Packages,
    Sources,
    Units,
    examples,
    reading,
)
from kinform_cli.progress import Working

EXAMPLES = examples(
    "kinform import arm.toml -o a.h5",
    "kinform import robot.urdf -o a.h5 --package my_robot=../my_robot",
    "kinform import housing.stl shaft.stl --units mm -o a.h5",
    "kinform import arm.toml -o a.h5 --depfile a.d     # for Make: -include a.d",
)


def import_(
    sources: Sources,
    output: Output,
    units: Units = None,
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    deviation: Deviation = None,
    depfile: Depfile = None,
) -> None:
    """Read a manifest or a robot description into a results file, meshes included; other stages need nothing else."""
    sources = files.sources_of(sources)
    manifest = files.is_manifest(sources, units)
    files.check_outputs(sources, output, depfile)
    files.warn_if_not_whole(output)
    from kinform import results, stages

    with Working("import"):
        if manifest:
            how = reading(geometry, packages, deviation, allow_xacro=allow_xacro)
            design = stages.import_(sources[0], allow_outside=allow_outside, reading=how)
        else:
            assert units is not None
            design = stages.import_meshes(sources, units=units)
    results.write(design, output)
    if depfile is not None:
        files.write_rule(depfile, output, design, sources)
    assembly = design.assembly
    parts, groups = counted(len(assembly.parts), "part"), counted(len(assembly.groups), "group")
    console.say(f"{output}: {assembly.name}, {parts}, {groups}")
    for note in assembly.notes:
        console.say(f"note: {note}")
