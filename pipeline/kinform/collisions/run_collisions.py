"""Collisions along a run that was computed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import combinations, product

import numpy as np

from kinform.collisions.between_outputs import nodes_of
from kinform.collisions.first_crossings import FirstCrossings
from kinform.collisions.joint_ranges import shapes_of
from kinform.collisions.pair.advancement import First
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.posed_pairs import Moving, Nodes, moving_pairs
from kinform.collisions.pair.prepared_pair import OVERLAP_SAME, PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.progress import Progress
from kinform.foundation.rounding import SINGLE
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.collisions import Collision
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Kinematics
from kinform.model.simulation import Simulation
from kinform.model.surfaces import MeshSurfaces

CONTACT_TIME = 1e-4
"""Share of the time between two outputs to which a first contact is found: a choice. Bodies are taken to move evenly in
between, which is no better."""
OUTPUT_TURN = 0.2
"""rad that a joint may turn between outputs: an arc is off its chord by r/8 times its square, 0.5 % of the radius."""
OUTPUT_SLIDE = 0.05
"""The same of a slide, as a share of the assembly's size: a choice."""
OUTPUT_PEAK = 0.005
"""Share of these that a joint may go further on between outputs than at them, where it turns back: a choice."""
OUTPUTS_MOST = 50_000
"""Outputs up to which a run is asked for again: a choice."""
OUTPUTS_FOR_PEAKS = 2_000
"""The same where that is for what happens where joints turn back: impacts would ask for any number."""
RUN_ASKED = 3
"""How often: with more outputs more of the motion is seen."""
COLLISIONS_MOST = 100
"""Collisions after which later ones are not looked for: a choice, more than anybody reads."""
DEPTH_TIMES = 12
"""Output times after the first contact at which the depth is measured: so many spread over the rest, and about the
worst. A choice."""


def along(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts | None,
    kinematics: Kinematics,
    simulation: Simulation,
    progress: Progress | None = None,
    *,
    finer: Callable[[int], Simulation] | None = None,
) -> tuple[tuple[Collision, ...], tuple[tuple[str, str, str], ...]]:
    """The first contact of each pair of parts of different bodies outside of their mates, sorted by time and names.

    Second: pairs of which that is not known, and why: they overlap from the start, stay too close, or roll or mesh and
    overlap where they do; or very many others had collided before; or the output times are too far apart to tell what
    happens between them. Between output times joints are taken to move evenly: where they move far, or turn back, the
    run is asked for again from `finer`, with so many times as many outputs; without it the outputs are trusted. Empty
    for runs without poses.
    """
    if len(simulation.time) < 2 or not len(simulation.body_names):
        return (), ()
    shapes = shapes_of(assembly, surfaces, contacts, kinematics)
    simulation, coarse = _followed(simulation, shapes.size, finer)
    names = list(simulation.body_names)
    nodes = nodes_of(simulation, kinematics.joints)
    pairs = moving_pairs(shapes, names, kinematics.joints, nodes)
    end, step = float(simulation.time[-1]), float(np.diff(simulation.time).min())
    met = FirstCrossings(pairs, end, CONTACT_TIME * step, progress)
    untested: list[tuple[str, str, str]] = []
    out: list[Collision] = []
    most = COLLISIONS_MOST
    while True:
        for k, crossing in met.up_to(most):
            found = _judged(assembly, simulation, nodes, pairs[k], crossing)
            if isinstance(found, Collision):
                out.append(found)
            else:
                untested += [(*pairs[k].test.part_names, reason) for reason in found]
        if met.end >= end or len(out) >= COLLISIONS_MOST:
            break
        most *= 2
    late = f"not followed after t = {met.end:.6g} s, by when {len(out)} other pairs had collided"
    untested += [(*pairs[k].test.part_names, late) for k in met.left_out]
    if coarse:
        untested += [(*pair, coarse) for pair in _apart(shapes, names, {c.parts for c in out})]
    if progress is not None:
        progress(len(pairs), len(pairs))
    return tuple(sorted(out, key=lambda c: (c.time, c.parts))), tuple(sorted(untested))


def _judged(
    assembly: Assembly, simulation: Simulation, nodes: Nodes, item: Moving, crossing: First
) -> Collision | list[str]:
    """The collision of a pair that crosses; else what is not known of it, and why."""
    test, why = item.test, list[str]()
    if crossing.overlaps:
        why.append("they overlap from the start")
    if crossing.exhausted is not None:
        why.append(f"they stay too close to be followed after t = {crossing.exhausted:.6g} s")
    if crossing.hit is None or crossing.place is None:
        return why
    if item.rolls:
        return [*why, f"they roll or mesh, and overlap by more than chord errors at t = {crossing.hit:.6g} s"]
    place = (nodes.between(crossing.hit)[item.first] @ np.append(crossing.place, 1.0))[:3]
    depth = _depth(test, item.course, simulation.time, crossing.hit)
    if crossing.before > 0.0 and depth <= OVERLAP_SAME * crossing.before + test.scrape:
        return [*why, "they overlap from the start, and again later"]
    if depth <= 0.0 and all(_closed(assembly.part(name)) for name in test.part_names):
        return [*why, f"facets cross at t = {crossing.hit:.6g} s, but no point of one is found in the other"]
    return Collision(test.part_names, crossing.hit, place, depth)


def _closed(part: Part) -> bool:
    """Whether it has an inside."""
    return part.mesh is not None and part.mesh.health.watertight


def _followed(simulation: Simulation, size: float, finer: Callable[[int], Simulation] | None) -> tuple[Simulation, str]:
    """The run with outputs so near each other that bodies move evenly between them; or why it has not ("" when it
    has)."""
    if finer is None:
        return simulation, ""
    times, (wanted, _) = 1, _parts_of_a_step(simulation, size)
    for _ in range(RUN_ASKED):
        if wanted == 1 or 2 * wanted * len(simulation.time) > OUTPUTS_MOST:
            break
        times *= 2 * wanted
        again = finer(times)
        if len(again.time) < 2:
            break
        simulation = again
        wanted, _ = _parts_of_a_step(simulation, size)
    if wanted == 1:
        _, wished = _parts_of_a_step(simulation, size)
        if 1 < wished and wished * len(simulation.time) <= OUTPUTS_FOR_PEAKS:
            again = finer(times * wished)
            simulation = again if len(again.time) > len(simulation.time) else simulation
        return simulation, ""
    return simulation, (
        "joints move far between output times, so that what parts meet between them is not known: "
        f"state a step of the simulation {wanted} times smaller"
    )


def _apart(shapes: Shapes, names: Sequence[str], met: Collection[tuple[str, str]]) -> list[tuple[str, str]]:
    """Pairs of parts of different bodies that are not known to meet."""
    pairs = (
        (min(one, other), max(one, other))
        for first, second in combinations(names, 2)
        for one, other in product(shapes.body_parts.get(first, ()), shapes.body_parts.get(second, ()))
    )
    return [pair for pair in pairs if pair not in met and pair[::-1] not in met]


def _parts_of_a_step(simulation: Simulation, size: float) -> tuple[int, int]:
    """Into how many parts to cut the time between outputs, for joints to move evenly and not far in it, and for them to
    turn back no further on than where outputs show them; `size` in m.

    Rates tell how far they go, and accelerations where they are at rest at the outputs only.
    """
    step = float(np.diff(simulation.time).max())
    turns = {joint: kind != "prismatic" for joint, kind in enumerate(simulation.joint_types)}
    owner = np.repeat(np.arange(len(simulation.joint_types)), np.diff(simulation.joint_offset))
    reach = np.array([OUTPUT_TURN if turns[int(joint)] else OUTPUT_SLIDE * size for joint in owner])
    if not len(reach):
        return 1, 1
    rate, acceleration = (
        float((np.abs(np.nan_to_num(values)).max(axis=0, initial=0.0) / reach).max(initial=0.0))
        for values in (simulation.joint_velocity, simulation.joint_acceleration)
    )
    parts = max(rate * step, float(np.sqrt(0.5 * acceleration)) * step)
    peaks = float(np.sqrt(0.125 * acceleration / OUTPUT_PEAK)) * step
    return max(1, int(np.ceil(parts - SINGLE))), max(1, int(np.ceil(peaks - SINGLE)))


def _depth(test: PairTest, course: Course, time: Array, hit: float) -> float:
    """m: how deep two parts are in each other at the worst of some times from the first contact on: soon after it,
    between outputs too, at outputs spread over the run, and about the worst of these."""
    # Times within an output step of the first contact, its ends and sixteenths, at which the depth is measured: a
    # choice.
    soon = np.linspace(hit, min(hit + float(np.diff(time).max()), float(time[-1])), 17)
    after = np.unique(np.concatenate([soon, time[time >= hit]]))
    last = len(after) - 1
    depths: dict[int, float] = {}

    def deep(n: int) -> float:
        if n not in depths:
            depths[n] = test.deepest(course.displacement(float(after[n])))
        return depths[n]

    tried = {int(n) for n in np.linspace(0, last, DEPTH_TIMES)} | {
        2**k - 1 for k in range(DEPTH_TIMES) if 2**k - 1 <= last
    }
    worst, step = max(sorted(tried), key=deep), max(last // DEPTH_TIMES, 1)
    while step:
        better = max((n for n in (worst, worst - step, worst + step) if 0 <= n <= last), key=deep)
        worst, step = better, step if better != worst else step // 2
    return deep(worst)
