"""Which level a simulation runs at, and what stands in the way of the higher ones."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from kinform.behaviour import Behaviour, EndStop, Friction, RigidBody, System
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.function import FREEDOMS, acted_freedom, acting_by_force, resolve_joint, stated_ranges
from kinform.model.assembly import Assembly
from kinform.model.function import Drive
from kinform.model.kinematics import Kinematics, Meshing
from kinform.model.quantities import Reason
from kinform.model.simulation import SimulationLevel
from kinform.simulation.mechanism.mechanism import Mechanism


@dataclass(frozen=True)
class Choice:
    """The level, or "" with failures when the level asked for cannot be had."""

    level: SimulationLevel
    failures: tuple[Reason, ...] = ()
    not_dynamic: tuple[Reason, ...] = ()
    """(subject, why) of what keeps it below the dynamic level, where no level is asked for."""


def choose(
    asked: SimulationLevel | None, behaviour: Behaviour, mechanism: Mechanism, adrift: tuple[str, ...], formless: bool
) -> Choice:
    """The level asked for, else the highest that is known. `formless`: no part has a mesh."""
    without_forces: SimulationLevel = "functional" if formless else "kinematic"
    obstacles = _obstacles(behaviour, mechanism, adrift)
    if asked == "dynamic":
        return Choice("", failures=obstacles) if obstacles else Choice("dynamic")
    if asked is not None:
        return Choice(asked)
    if not obstacles:
        return Choice("dynamic")
    return Choice(without_forces, not_dynamic=obstacles)


def _obstacles(behaviour: Behaviour, mechanism: Mechanism, adrift: tuple[str, ...]) -> tuple[Reason, ...]:
    """(subject, why) of all that keeps the model from being dynamic."""
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    out = [(name, "no joints connect this body with the ground") for name in adrift]
    for body in behaviour.system.bodies:
        if isinstance(body, RigidBody) and link_of[body.subject] > 0 and body.mass is None:
            out.append((body.subject, "its mass is not known"))
    out.extend(behaviour.forces_missing)
    return tuple(out)


def notes_of_joints(kinematics: Kinematics) -> Iterator[str]:
    """What is taken for granted of joints that geometry does not settle."""
    for joint in kinematics.joints:
        if joint.type == "general":
            continue
        if joint.status == "blocked":
            yield f"{joint.name} moves as {joint.type}, although contacts block it"
        elif joint.evidence == ("function",):
            yield f"{joint.name} is {joint.type} because [function] says so: no geometry shows it"
        elif joint.status == "inferred":
            yield f"{joint.name} is taken to be {joint.type}: {', '.join(joint.evidence)}"


_DEFAULTS = {
    "spring": {"rest": "rest 0"},
    "servo": {"ki": "ki 0", "kd": "kd 0", "limit": "no limit"},
    "dc_motor": {"inductance": "inductance 0", "gear": "gear 1"},
}
"""What drives are taken to have where the manifest does not say, by kind."""


def notes_of_drives(drives: Iterable[Drive]) -> Iterator[str]:
    """What is taken for granted of drives."""
    for drive in drives:
        taken = [said for key, said in _DEFAULTS.get(drive.kind, {}).items() if key not in drive.parameters]
        if taken:
            yield f"the {drive.kind.replace('_', ' ')} on {drive.joint} does not state: {', '.join(taken)}"


def notes_of_friction(system: System) -> Iterator[str]:
    """Which coefficients, arms and ends friction was taken to have."""
    for one in (c for c in system.components if isinstance(c, Friction)):
        words = [f"{one.kinetic:g} in motion, {one.static:g} at rest"] if one.static else []
        if one.static_effort:
            words.append(f"{one.effort:g} and {one.static_effort:g} N·m or N without load")
        if one.static and one.radial:
            arm = f"journal of radius {1e3 * one.radial:.4g} mm" if one.radial != 1.0 else "guide"
            span = one.upper - one.lower
            ends = (
                f"{1e3 * span:.4g} mm long" if span > 0.0 else "whose length is not known: moments across it do not rub"
            )
            words.append(f"{arm}, {ends}")
            if one.torsion:
                words.append(f"a torque about the slide on an arm of {1e3 / one.torsion:.4g} mm, added")
        elif one.static and one.torsion:
            words.append(f"thread of tan λ / cos α {-one.torsion:.4g}")
        if one.static and one.axial and not one.torsion:
            words.append(f"thrust ring of mean radius {1e3 * one.axial:.4g} mm")
        if one.static and one.least:
            words.append("where redundant constraints share loads, by the least reactions that balance")
        yield f"friction on {one.subject}: {'; '.join(words)}"


def notes_of_freedoms(assembly: Assembly, kinematics: Kinematics) -> Iterator[str]:
    """Which freedom of joints with several is acted on, where nothing that is stated says so."""
    request = assembly.simulation
    acting = [
        (f"the {drive.kind.replace('_', ' ')} on", drive.joint, drive.freedom) for drive in assembly.function.drives
    ]
    acting += [("the initial value of", value.joint, value.freedom) for value in (request.initial if request else ())]
    for what, name, freedom in acting:
        meant = acted_freedom(assembly, kinematics, name, freedom)
        if meant.joint is not None and meant.freedom is not None and meant.because:
            yield f"{what} {name} acts on its {FREEDOMS[meant.joint.type][meant.freedom]}: {meant.because}"


def notes_of_stops(assembly: Assembly, kinematics: Kinematics, system: System) -> Iterator[str]:
    """Where joints stop because meshes meet there, and which have no such end, or no end of a stated range."""
    asked = assembly.simulation.stops if assembly.simulation is not None else ""
    stops = {stop.subject: stop for stop in system.components if isinstance(stop, EndStop)}
    ranged = dict(stated_ranges(assembly, kinematics))
    for joint in system.joints if asked else ():
        if joint.kind.rates != 1:
            if asked == "range" and joint.subject in ranged:
                yield f"{joint.subject} has no stop, although a range is stated: it has {joint.kind.rates} freedoms"
            continue
        stop, turns = stops.get(joint.subject), joint.kind.coordinates[0][1]
        ends = [] if stop is None else [end for end in (stop.lower, stop.upper) if math.isfinite(end)]
        shown = [f"{math.degrees(end):.4g}°" if turns else f"{1e3 * end:.4g} mm" for end in ends]
        if shown and asked == "found":
            alone = "its parts meet there when it is moved from the pose of the meshes, alone or with its loops"
            yield f"{joint.subject} stops at {' and '.join(shown)}: {alone}"
        elif not shown:
            why = "no end of its range was found" if asked == "found" else "no range of it is stated"
            yield f"{joint.subject} has no stop: {why}"


def notes_of_teeth(kinematics: Kinematics) -> Iterator[str]:
    """Teeth that are replaced by the ratio that they keep, and by how much that may be wrong."""
    types = {str(joint.name): joint.type for joint in kinematics.joints}
    for coupling in kinematics.couplings:
        teeth = coupling.meshing
        if teeth is None or coupling.kind == "screw":
            continue
        slides = types[coupling.joints[0]] == "prismatic"

        def shown(value: float, slides: bool = slides) -> str:
            return f"{1e3 * value:.2g} mm" if slides else f"{math.degrees(value):.2g}°"

        yield (
            f"the teeth of {coupling.through} are taken for their ratio: {coupling.joints[0]} = {teeth.ratio:.6g} · "
            f"{coupling.joints[1]}, from {_teeth_counted(teeth, types, coupling.joints)} (at the pose of "
            f"the meshes their normals give {coupling.ratio:.6g} ± {coupling.uncertainty:.1g}); the meshes depart "
            f"from it by up to {shown(teeth.deviation)} of {coupling.joints[0]} within a tooth, and have play of "
            f"{shown(teeth.play)}, which is left out"
        )


def _teeth_counted(teeth: Meshing, types: Mapping[str, str], joints: tuple[str, str]) -> str:
    """How many teeth were counted on either side."""
    parts = []
    for count, name, pitch in zip(teeth.teeth, joints, teeth.pitches, strict=True):
        whole = types[name] != "prismatic" and abs(count * pitch - 2.0 * math.pi) < SINGLE
        parts.append(f"{count} teeth" if whole else f"{count} teeth in a row")
    return " and ".join(parts)


def _intended_ratios(assembly: Assembly, kinematics: Kinematics, behaviour: Behaviour) -> Iterator[str]:
    """What becomes of stated couplings where there are meshes: teeth keep their own ratio, what has none is imposed."""
    tied = {frozenset(c.joints): c for c in kinematics.couplings if c.meshing is not None or c.kind == "screw"}
    imposed = {subject.split(" ")[1]: why for subject, why in behaviour.imposed}
    free = []
    for number, coupling in enumerate(assembly.function.couplings, start=1):
        ends = [resolve_joint(assembly, kinematics, name).joint for name in coupling.every]
        named = " and ".join(coupling.every)
        if str(number) in imposed:
            why = imposed[str(number)]
            yield (
                f"the coupling of {named} is imposed as stated: no ratio of geometry ties these joints"
                + (f"; {why}" if why else "")
            )
        elif frozenset(end.name for end in ends if end is not None) not in tied:
            free.append(named)
    if free:
        yield f"couplings are intended, not derived from geometry, and are not imposed: {', '.join(free)}"


def notes_of_level(
    assembly: Assembly,
    kinematics: Kinematics,
    behaviour: Behaviour,
    level: SimulationLevel,
    adrift: tuple[str, ...],
    gears: bool,
) -> Iterator[str]:
    """What plays no part at this level."""
    if adrift:
        yield f"what no joints connect with the ground stays where it is: {', '.join(adrift)}"
    if not gears and assembly.function.couplings:
        yield from _intended_ratios(assembly, kinematics, behaviour)
    if level != "dynamic":
        if assembly.simulation is not None and assembly.simulation.stops:
            yield f"stops play no part at the {level} level: joints go where the motions lead them"
        forces = acting_by_force(assembly.function)
        if forces:
            yield f"forces play no part at the {level} level: {', '.join(forces)}"
